"""VTP, DXF and 3DM, by libraries made for them, which keep float64 and quads.

They are imported when a file asks for them; `io` has looked whether they are there."""

import re
import subprocess
import sys
from io import BytesIO
from pathlib import Path

import numpy as np

from ..repair import triangulate

UNITS = {  # the codes of DXF and Rhino
    None: (0, "None"), "mm": (4, "Millimeters"), "cm": (5, "Centimeters"), "m": (6, "Meters"),
    "in": (1, "Inches"), "ft": (2, "Feet"),
}  # fmt: skip
FAMILIES = "u", "v", "d1", "d2"
READ_VTP = """import sys, numpy, pyvista
found = pyvista.read(sys.argv[1])
assert not found.n_strips, "it holds strips of triangles, and plain polygons are wanted"
sizes = numpy.array([len(face) for face in found.irregular_faces], dtype=int)
numpy.savez(sys.stdout.buffer, points=found.points, padded=found.faces, sizes=sizes)"""
READ_3DM = """import sys, numpy, rhino3dm
model = rhino3dm.File3dm.Read(sys.argv[1])
assert model is not None, "it is no Rhino file"
meshes = [one.Geometry for one in model.Objects if isinstance(one.Geometry, rhino3dm.Mesh)]
assert meshes, "it holds no mesh, mesh its surfaces first"
points, padded, sizes = [], [], []
for mesh in meshes:
    faces = (dict.fromkeys(mesh.Faces[k]) for k in range(len(mesh.Faces)))
    faces = [[len(points) + corner for corner in face] for face in faces]
    sizes += [len(face) for face in faces]
    padded += [k for face in faces for k in (len(face), *face)]
    corners = (mesh.Vertices.Point3dAt(k) for k in range(len(mesh.Vertices)))
    points += [(p.X, p.Y, p.Z) for p in corners]
numpy.savez(sys.stdout.buffer, points=points, padded=padded, sizes=sizes)"""
PATIENCE = 20  # seconds, and as many for each megabyte of a file, for another process


def read_vtp(path: Path) -> tuple[np.ndarray, np.ndarray | list]:
    """Points (n, 3) and faces of a VTK XML PolyData file; lines and points are passed over."""
    start = path.read_bytes()[:2000]
    if b"<VTKFile" not in start or b"PolyData" not in start:
        raise ValueError("no VTP file: an XML file of the type PolyData is wanted")
    return _read(READ_VTP, path, "the VTP file is broken, says VTK")


def _read(code, path, broken):
    """Points and faces that another process finds: some broken files end the one that reads."""
    command = [sys.executable, "-P", "-W", "ignore", "-c", code, path]
    patience = PATIENCE * (1 + path.stat().st_size / 1e6)
    try:
        done = subprocess.run(command, capture_output=True, timeout=patience)
    except subprocess.TimeoutExpired:
        raise ValueError(f"{broken}: no end after {patience:.0f} seconds") from None
    errors = done.stderr.decode(errors="replace")
    said = re.search(r"(?:ERR\|.*?\)|AssertionError): ([^\r\n\x1b]*)", errors)
    if said or done.returncode:
        raise ValueError(f"{broken}: {said[1].strip()}" if said else broken)
    points, padded, sizes = np.load(BytesIO(done.stdout)).values()  # sizes before the faces, too
    if len(set(sizes.tolist())) == 1:
        return points, padded.reshape(len(sizes), -1)[:, 1:]
    return points, [face[1:] for face in np.split(padded, np.cumsum(1 + sizes))[:-1]]


def write_vtp(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write a VTP file.  Cell data `family`: 0 u, 1 v, 2 d1, 3 d2 for curves, -1 for panels."""
    import pyvista

    cells = pyvista.CellArray.from_irregular_cells
    lines = [curve for family in curves.values() for curve in family]
    made = pyvista.PolyData(V, faces=cells([*Q, *polygons]), lines=cells(lines) if lines else None)
    family = [FAMILIES.index(name) for name in curves for _ in curves[name]]
    panels = [-1] * (len(Q) + len(polygons))
    made.cell_data["family"] = np.array(family + panels, dtype=np.int8)
    made.save(path)
    if not path.read_bytes().endswith(b"</VTKFile>\n"):  # a full disk is not told
        raise OSError(f"VTK could not write {path}")


def _colours(curves):
    """{layer: (red, green, blue)} of the panels and of the families that are there."""
    from ..plot import COLOURS, GREY

    text = {"panels": GREY} | {name: COLOURS[name] for name in curves}
    return {name: tuple(bytes.fromhex(colour[1:])) for name, colour in text.items()}


def write_dxf(
    path: Path,
    V: np.ndarray,
    Q: np.ndarray,
    polygons: list,
    curves: dict,
    unit: str | None = None,
    faces: bool = False,
) -> None:
    """Write a DXF file (R2010): layer `panels` with one MESH, or faces of three and four corners,
    which more programs read, and 3D polylines in the layers `u`, `v`, `d1`, `d2`."""
    import ezdxf

    drawing = ezdxf.new("R2010", units=UNITS[unit][0])
    for name, colour in _colours(curves).items():
        drawing.layers.add(name, true_color=ezdxf.rgb2int(colour))
    space = drawing.modelspace()
    panels = {"layer": "panels"}
    if faces:
        for corners in [*Q, *triangulate(V, polygons)]:
            space.add_3dface(V[corners].tolist(), dxfattribs=panels)
    else:
        with space.add_mesh(dxfattribs=panels).edit_data() as data:
            data.vertices = V.tolist()
            data.faces = [face.tolist() for face in [*Q, *polygons]]
    for name, family in curves.items():
        for curve in family:
            closed = bool(curve[0] == curve[-1])
            points = V[curve[:-1] if closed else curve].tolist()
            space.add_polyline3d(points, close=closed, dxfattribs={"layer": name})
    drawing.saveas(path)


def read_3dm(path: Path) -> tuple[np.ndarray, list]:
    """Points (n, 3) and faces of all meshes of a Rhino file; other objects are passed over."""
    return _read(READ_3DM, path, "the Rhino file cannot be read")


def write_3dm(
    path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict, unit: str | None = None
) -> None:
    """Write a Rhino file (version 7): a mesh in the layer `panels`, polylines in others.

    Rhino's meshes have triangles and quads only: a polygon becomes a mesh of its own, of triangles.
    """
    import rhino3dm as rhino

    model, layers = rhino.File3dm(), {}
    model.Settings.ModelUnitSystem = getattr(rhino.UnitSystem, UNITS[unit][1])
    for name, colour in _colours(curves).items():
        layer, layers[name] = rhino.Layer(), rhino.ObjectAttributes()
        layer.Name, layer.Color = name, (*colour, 255)
        layers[name].LayerIndex = model.Layers.Add(layer)
    pieces = [(V[p], triangulate(V[p], np.arange(len(p))[None])) for p in polygons]
    for W, F in [(V, Q), *pieces]:
        mesh = rhino.Mesh()
        mesh.Vertices.UseDoublePrecisionVertices = True
        for point in W.tolist():
            mesh.Vertices.AddPoint3d(*point)
        for face in F.tolist():
            mesh.Faces.AddFace(*face)
        mesh.Normals.ComputeNormals()
        model.Objects.AddMesh(mesh, layers["panels"])  # type: ignore[call-arg]
    for name, family in curves.items():
        for curve in family:
            line = rhino.Polyline(len(curve))
            for point in V[curve].tolist():
                line.Add(*point)
            model.Objects.AddPolyline(line, layers[name])
    if not model.Write(str(path), 7):
        raise OSError(f"rhino3dm could not write {path}")
