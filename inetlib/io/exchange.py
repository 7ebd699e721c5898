"""VTP, DXF and 3DM, by the libraries of their makers or keepers: VTK, ezdxf, rhino3dm.

They are imported when a file asks for them; a missing one is an ImportError of one sentence.
Each writer keeps float64 coordinates and quads.
"""

import importlib
from contextlib import contextmanager
from pathlib import Path

import numpy as np

MISSING = {
    "vtkmodules": "VTP files need the package vtk: pip install inetlib[view]",
    "ezdxf": "DXF files need the package ezdxf: pip install inetlib[cad]",
    "rhino3dm": "3DM files need the package rhino3dm: pip install inetlib[cad]",
}
NAMES = "u", "v", "d1", "d2"


def _need(name):
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        package = name.partition(".")[0]
        if error.name != package:
            raise
        raise ImportError(MISSING[package], name=package) from error


# --- VTP ----------------------------------------------------------------------------------


def read_vtp(path):
    """Points (n, 3) and faces of a VTK XML PolyData file; lines and points are passed over."""
    xml, arrays = _need("vtkmodules.vtkIOXML"), _need("vtkmodules.util.numpy_support")
    start = Path(path).read_bytes()[:2000]
    if b"<VTKFile" not in start or b"PolyData" not in start:
        raise ValueError("no VTP file: an XML file of the type PolyData is wanted")
    with _vtk_messages() as messages:
        reader = xml.vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        data = reader.GetOutput()
    if words := messages.GetOutput().strip():
        first = words.splitlines()[1 if "\n" in words else 0]
        raise ValueError(f"the VTP file is broken, says VTK: {first.partition('): ')[2] or first}")
    if data.GetNumberOfStrips():
        raise ValueError("it holds strips of triangles: plain polygons are wanted")
    if not data.GetNumberOfPolys():
        return np.empty((0, 3)), []
    points = arrays.vtk_to_numpy(data.GetPoints().GetData()).astype(np.float64)
    corners = arrays.vtk_to_numpy(data.GetPolys().GetConnectivityArray()).astype(np.int64)
    offsets = arrays.vtk_to_numpy(data.GetPolys().GetOffsetsArray()).astype(np.int64)
    sizes = np.diff(offsets)
    if offsets[0] != 0 or (sizes < 0).any() or offsets[-1] > len(corners):
        raise ValueError("the VTP file is broken: its offsets of polygons make no sense")
    if (sizes == sizes[0]).all():
        return points, corners[: offsets[-1]].reshape(len(sizes), -1)
    return points, np.split(corners[: offsets[-1]], offsets[1:-1])


def write_vtp(path, V, Q, polygons, curves):
    """Write a VTP file.  Cell data `family`: 0 u, 1 v, 2 d1, 3 d2 for curves, -1 for panels."""
    xml, arrays = _need("vtkmodules.vtkIOXML"), _need("vtkmodules.util.numpy_support")
    core, model = _need("vtkmodules.vtkCommonCore"), _need("vtkmodules.vtkCommonDataModel")

    def cells(lists):
        offsets = np.cumsum([0] + [len(indices) for indices in lists])
        made = model.vtkCellArray()
        joined = np.concatenate([np.empty(0, dtype=np.int64), *lists])
        made.SetData(*(arrays.numpy_to_vtkIdTypeArray(a, deep=True) for a in (offsets, joined)))
        return made

    points, data = core.vtkPoints(), model.vtkPolyData()
    points.SetData(arrays.numpy_to_vtk(np.ascontiguousarray(V), deep=True))
    data.SetPoints(points)
    data.SetLines(cells([curve for family in curves.values() for curve in family]))
    data.SetPolys(cells([*Q, *polygons]))
    family = [NAMES.index(name) for name in curves for _ in curves[name]]
    numbers = np.array(family + [-1] * (len(Q) + len(polygons)), dtype=np.int8)
    column = arrays.numpy_to_vtk(numbers, deep=True)
    column.SetName("family")
    data.GetCellData().AddArray(column)
    writer = xml.vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    if not writer.Write():
        raise OSError(f"VTK could not write {path}")


@contextmanager
def _vtk_messages():
    """VTK's complaints as text instead of on the screen."""
    core = _need("vtkmodules.vtkCommonCore")
    messages, before = core.vtkStringOutputWindow(), core.vtkOutputWindow.GetInstance()
    log = core.vtkLogger
    level = log.GetCurrentVerbosityCutoff()
    core.vtkOutputWindow.SetInstance(messages)
    log.SetStderrVerbosity(log.VERBOSITY_OFF)
    try:
        yield messages
    finally:
        log.SetStderrVerbosity(level)
        core.vtkOutputWindow.SetInstance(before)


# --- CAD ----------------------------------------------------------------------------------


def _colours(curves):
    """{layer: (red, green, blue)} of the panels and of the families that are there."""
    from ..plot import COLOURS, GREY

    text = {"panels": GREY} | {name: COLOURS[name] for name in curves}
    return {k: tuple(int(c[i : i + 2], 16) for i in (1, 3, 5)) for k, c in text.items()}


def write_dxf(path, V, Q, polygons, curves):
    """Write a DXF file (R2010, no unit): layer `panels` with one MESH, and 3D polylines in
    the layers `u`, `v`, `d1`, `d2`.
    """
    ezdxf = _need("ezdxf")
    drawing = ezdxf.new("R2010", units=0)
    for name, colour in _colours(curves).items():
        drawing.layers.add(name, true_color=ezdxf.rgb2int(colour))
    space = drawing.modelspace()
    with space.add_mesh(dxfattribs={"layer": "panels"}).edit_data() as data:
        data.vertices = V.tolist()
        data.faces = [*Q.tolist(), *(polygon.tolist() for polygon in polygons)]
    for name, family in curves.items():
        for curve in family:
            closed = bool(curve[0] == curve[-1])
            points = V[curve[:-1] if closed else curve].tolist()
            space.add_polyline3d(points, close=closed, dxfattribs={"layer": name})
    drawing.saveas(path)


def write_3dm(path, V, Q, polygons, curves):
    """Write a Rhino file (version 7, no unit): layer `panels` with one mesh, its vertices in
    double precision, and polylines in the layers `u`, `v`, `d1`, `d2`.

    Rhino's meshes have triangles and quads only: a polygon becomes a mesh of its own, cut
    into triangles.
    """
    from ..repair import triangulate

    rhino = _need("rhino3dm")
    model = rhino.File3dm()
    model.Settings.ModelUnitSystem = getattr(rhino.UnitSystem, "None")
    attributes = {name: _layer(rhino, model, name, c) for name, c in _colours(curves).items()}
    model.Objects.AddMesh(_rhino_mesh(rhino, V, Q), attributes["panels"])
    for polygon in polygons:
        corners = np.arange(len(polygon))[None]
        piece = _rhino_mesh(rhino, V[polygon], triangulate(V[polygon], corners))
        model.Objects.AddMesh(piece, attributes["panels"])
    for name, family in curves.items():
        for curve in family:
            line = rhino.Polyline(len(curve))
            for x, y, z in V[curve].tolist():
                line.Add(x, y, z)
            model.Objects.AddPolyline(line, attributes[name])
    if not model.Write(str(path), 7):
        raise OSError(f"rhino3dm could not write {path}")


def _layer(rhino, model, name, colour):
    layer = rhino.Layer()
    layer.Name, layer.Color = name, (*colour, 255)
    attributes = rhino.ObjectAttributes()
    attributes.LayerIndex = model.Layers.Add(layer)
    return attributes


def _rhino_mesh(rhino, V, F):
    made = rhino.Mesh()
    made.Vertices.UseDoublePrecisionVertices = True
    for x, y, z in V.tolist():
        made.Vertices.AddPoint3d(x, y, z)
    for face in F.tolist():
        made.Faces.AddFace(*face)
    made.Normals.ComputeNormals()
    return made
