"""VTP, DXF and 3DM, by libraries made for them, which keep float64 and quads.

They are imported when a file asks for them; `io` has looked whether they are there."""

import re
import subprocess
import sys
from io import BytesIO
from pathlib import Path

import numpy as np

from ..repair import triangulate
from .text import CUT

UNITS = {  # the codes of DXF and Rhino
    None: (0, "None"), "mm": (4, "Millimeters"), "cm": (5, "Centimeters"), "m": (6, "Meters"),
    "in": (1, "Inches"), "ft": (2, "Feet"),
}  # fmt: skip
FAMILIES = "u", "v", "d1", "d2"
READ_VTP = """import sys, numpy, pyvista
found = pyvista.read(sys.argv[1])
assert not found.n_strips, "it holds strips of triangles, and plain polygons are wanted"
sizes = numpy.array([len(face) for face in found.irregular_faces], dtype=int)
family = found.cell_data.get("family", [])
family = family[-len(sizes):] if len(family) == found.n_cells and len(sizes) else []
cut = numpy.flatnonzero(numpy.ravel(family) == -2)
numpy.savez(sys.stdout.buffer, points=found.points, padded=found.faces, sizes=sizes, cut=cut)"""
READ_3DM = """import sys, numpy, rhino3dm
model = rhino3dm.File3dm.Read(sys.argv[1])
assert model is not None, "it is no Rhino file"
layers = [layer.Name for layer in model.Layers]
meshes = [one for one in model.Objects if isinstance(one.Geometry, rhino3dm.Mesh)]
assert meshes, "it holds no mesh, mesh its surfaces first"
points, padded, sizes, cut, known = [], [], [], [], {}
for one in meshes:
    mesh, layer = one.Geometry, one.Attributes.LayerIndex
    faces = [[*dict.fromkeys(mesh.Faces[k])] for k in range(len(mesh.Faces))]
    corners = [mesh.Vertices.Point3dAt(k) for k in range(len(mesh.Vertices))]
    corners = [(p.X, p.Y, p.Z) for p in corners]
    number = range(len(points), len(points) + len(corners))
    if layers[layer : layer + 1] == ["panels_cut"]:
        sides = {side for face in faces for side in zip(face, face[1:] + face[:1])}
        around = {(k, (k + 1) % len(corners)) for k in range(len(corners))}
        if {side for side in sides if side[::-1] not in sides} == around:
            faces = [range(len(corners))]  # the triangles of one panel
        cut += range(len(sizes), len(sizes) + len(faces))
        new = [p for p in dict.fromkeys(corners) if p not in known]
        known.update(zip(new, range(len(points), len(points) + len(new))))
        number = [known[p] for p in corners]
        points += new
    else:
        points += corners
        for k, p in zip(number, corners):
            known.setdefault(p, k)
    sizes += [len(face) for face in faces]
    padded += [k for face in faces for k in (len(face), *(number[c] for c in face))]
numpy.savez(sys.stdout.buffer, points=points, padded=padded, sizes=sizes, cut=cut)"""
PATIENCE = 20  # seconds, and as many for each megabyte of a file, for another process


def read_vtp(path: Path) -> tuple[np.ndarray, np.ndarray | list, np.ndarray]:
    """Points (n, 3), faces and cut panels of a VTK XML PolyData file; no lines and no points."""
    start = path.read_bytes()[:2000]
    if b"<VTKFile" not in start or b"PolyData" not in start:
        raise ValueError("no VTP file: an XML file of the type PolyData is wanted")
    return _read(READ_VTP, path, "the VTP file is broken, says VTK")


def _read(code, path, broken):
    """What another process finds in a file: some broken ones end the process that reads."""
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
    points, padded, sizes, cut = np.load(BytesIO(done.stdout)).values()  # a size before each face
    cut = cut.astype(np.int64)
    if len(set(sizes.tolist())) == 1:
        return points, padded.reshape(len(sizes), -1)[:, 1:], cut
    return points, [face[1:] for face in np.split(padded, np.cumsum(1 + sizes))[:-1]], cut


def write_vtp(path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict) -> None:
    """Write a VTP file.

    Cell data `family`: 0 u, 1 v, 2 d1, 3 d2 for curves, -1 for quads, -2 for other panels."""
    import pyvista

    cells = pyvista.CellArray.from_irregular_cells
    lines = [curve for family in curves.values() for curve in family]
    made = pyvista.PolyData(V, faces=cells([*Q, *polygons]), lines=cells(lines) if lines else None)
    family = [FAMILIES.index(name) for name in curves for _ in curves[name]]
    panels = [-1] * len(Q) + [-2] * len(polygons)
    made.cell_data["family"] = np.array(family + panels, dtype=np.int8)
    made.save(path)
    if not path.read_bytes().endswith(b"</VTKFile>\n"):  # a full disk is not told
        raise OSError(f"VTK could not write {path}")


def _colours(polygons, curves):
    """{layer: (red, green, blue)} of the panels and of the families that are there."""
    from ..plot import COLOURS, GREY

    panels = ["panels", CUT] if polygons else ["panels"]
    text = dict.fromkeys(panels, GREY) | {name: COLOURS[name] for name in curves}
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
    """Write a DXF file (R2010): layers `panels` and, of polygons, `panels_cut`, each with one MESH,
    or with faces of three and four corners (polygons as triangles), which more programs read, and
    3D polylines in the layers `u`, `v`, `d1`, `d2`."""
    import ezdxf

    drawing = ezdxf.new("R2010", units=UNITS[unit][0])
    for name, colour in _colours(polygons, curves).items():
        drawing.layers.add(name, true_color=ezdxf.rgb2int(colour))
    space = drawing.modelspace()
    for layer, panels in (("panels", Q), (CUT, polygons)):
        if faces:
            for corners in panels if layer == "panels" else triangulate(V, panels):
                space.add_3dface(V[corners].tolist(), dxfattribs={"layer": layer})
        elif len(panels):
            used, corner = np.unique(np.concatenate(panels), return_inverse=True)
            ends = np.cumsum([len(panel) for panel in panels])[:-1]
            with space.add_mesh(dxfattribs={"layer": layer}).edit_data() as data:
                data.vertices = V[used].tolist()
                data.faces = [face.tolist() for face in np.split(corner, ends)]
    for name, family in curves.items():
        for curve in family:
            closed = bool(curve[0] == curve[-1])
            points = V[curve[:-1] if closed else curve].tolist()
            space.add_polyline3d(points, close=closed, dxfattribs={"layer": name})
    drawing.saveas(path)


def read_3dm(path: Path) -> tuple[np.ndarray, list, np.ndarray]:
    """Points (n, 3), faces and cut panels of all meshes of a Rhino file, and nothing else of it.

    A mesh in the layer `panels_cut` is one panel when its corners go round it, and shares
    vertices with those before it."""
    return _read(READ_3DM, path, "the Rhino file cannot be read")


def write_3dm(
    path: Path, V: np.ndarray, Q: np.ndarray, polygons: list, curves: dict, unit: str | None = None
) -> None:
    """Write a Rhino file (version 7): a mesh in the layer `panels`, polylines in others.

    Rhino's meshes have triangles and quads only: a polygon becomes a mesh of its own, of triangles,
    in the layer `panels_cut`."""
    import rhino3dm as rhino

    model, layers = rhino.File3dm(), {}
    model.Settings.ModelUnitSystem = getattr(rhino.UnitSystem, UNITS[unit][1])
    for name, colour in _colours(polygons, curves).items():
        layer, layers[name] = rhino.Layer(), rhino.ObjectAttributes()
        layer.Name, layer.Color = name, (*colour, 255)
        layers[name].LayerIndex = model.Layers.Add(layer)
    pieces = [(V[p], triangulate(V[p], np.arange(len(p))[None])) for p in polygons]
    for number, (W, F) in enumerate([(V, Q), *pieces]):
        mesh = rhino.Mesh()
        mesh.Vertices.UseDoublePrecisionVertices = True
        for point in W.tolist():
            mesh.Vertices.AddPoint3d(*point)
        for face in F.tolist():
            mesh.Faces.AddFace(*face)
        mesh.Normals.ComputeNormals()
        model.Objects.AddMesh(mesh, layers[CUT if number else "panels"])  # type: ignore[call-arg]
    for name, family in curves.items():
        for curve in family:
            line = rhino.Polyline(len(curve))
            for point in V[curve].tolist():
                line.Add(*point)
            model.Objects.AddPolyline(line, layers[name])
    if not model.Write(str(path), 7):
        raise OSError(f"rhino3dm could not write {path}")
