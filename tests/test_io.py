"""`io` against other libraries that read the same files, and against bad files."""

import json
import os
import struct
import warnings
from pathlib import Path

import igl
import numpy as np
import pytest
from test_repair import CUBE, SIDES

from inetlib import io, mesh, repair

THIRD = 1 / 3  # needs all its digits
TEXT = {  # one quad and one triangle, by hand
    ".obj": "# x\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\nf 2/1 5/2/3 3//4\n",
    ".off": "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n4 0 1 2 3\n3 1 4 2 255 0 0\n",
    ".ply": (
        "ply\nformat ascii 1.0\ncomment x\nelement vertex 5\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nelement face 2\nproperty int id\n"
        "property list uchar int vertex_index\nelement edge 1\nproperty int vertex1\nend_header\n"
        "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n2 0 0 9\n7 4 0 1 2 3\n7 3 1 4 2\n5\n"
    ),
}
FACES = [[0, 1, 2, 3], [1, 4, 2]]


@pytest.fixture
def web():
    """Quads around a hexagon, coordinates with all their digits, large and tiny ones too."""
    V, Q, polygon = mesh.polygon_rings(6, 3)
    V[:, 2] = np.sin(V[:, 0]) * np.linspace(1e-12, 1e6, len(V)) * THIRD
    return V, Q, polygon


def package(name):
    with warnings.catch_warnings():  # pyvista in a notebook without ipywidgets
        warnings.filterwarnings("ignore", "IProgress not found")
        return pytest.importorskip(name, reason=f"the package {name} is not installed")


def need(suffix):
    """Skips where the package that the format needs is missing."""
    if suffix in io.PACKAGES:
        package(io.PACKAGES[suffix])


def put(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def stl(V, T):
    rows = np.zeros(len(T), dtype=[("f", "<f4", (4, 3)), ("other", "<u2")])
    rows["f"][:, 1:] = V[T]
    return b"binary".ljust(80) + struct.pack("<I", len(T)) + rows.tobytes()


def refused(path, words, read=io.read):
    with pytest.raises(ValueError, match=words) as caught:
        read(path)
    sentence = str(caught.value)
    assert str(path) in sentence and "\n" not in sentence and len(sentence) < 300


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".off", ".vtp"])
def test_nets_and_triangles_come_back_bit_by_bit(tmp_path, web, suffix):
    need(suffix)
    V, Q, polygon = web
    path = tmp_path / f"a net{suffix.upper()}"
    curves = "all" if suffix in io.WITH_CURVES else None
    io.write(path, V, Q, curves, polygons=[polygon])
    net, data = io.net(path), path.read_bytes()
    assert net.V.dtype == np.float64 and np.array_equal(net.V, V)
    assert net.Q.dtype == np.int64 and np.array_equal(net.Q, Q)
    assert [p.tolist() for p in net.polygons] == [polygon.tolist()]
    io.write(path, V, Q, curves, polygons=[polygon], force=True)
    assert path.read_bytes() == data and list(tmp_path.iterdir()) == [path]
    V, T = mesh.triangles(V, Q)
    io.write(path, V, T, force=True)
    W, F = io.read(path)
    assert np.array_equal(W, V) and np.array_equal(F, T)


def test_libigl_reads_the_same_obj_and_off(tmp_path, web):
    V, Q, _ = web
    for name, read, faces in (("n.obj", igl.readOBJ, 3), ("n.off", igl.readOFF, 1)):
        for cut in ([], [Q[-1]]):
            io.write(tmp_path / name, V, Q[: len(Q) - len(cut)], polygons=cut, force=True)
            found = read(str(tmp_path / name))
            assert np.array_equal(found[0], V) and np.array_equal(found[faces], Q)


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_meshio_reads_the_same_and_is_read(tmp_path, web, suffix):
    meshio = package("meshio")
    V, Q, _ = web
    io.write(tmp_path / f"n{suffix}", V, Q)
    found = meshio.read(tmp_path / f"n{suffix}")
    assert found.points.dtype == np.float64 and np.array_equal(found.points, V)
    assert [c.type for c in found.cells] == ["quad"] and np.array_equal(found.cells[0].data, Q)
    for binary in (True, False):
        found.write(tmp_path / "m.ply", binary=binary)
        W, F = io.read(tmp_path / "m.ply")
        assert np.allclose(W, V, rtol=1e-9, atol=0) and np.array_equal(F, Q)


def test_pyvista_reads_the_same_vtp_with_its_curves(tmp_path, web):
    pyvista = package("pyvista")
    V, Q, _ = web
    io.write(tmp_path / "n.vtp", V, Q, "all")
    found = pyvista.read(tmp_path / "n.vtp")
    assert found.points.dtype == np.float64 and np.array_equal(found.points, V)
    assert np.array_equal(found.faces.reshape(-1, 5)[:, 1:], Q)
    families = mesh.polylines(Q)
    padded = [[len(curve), *curve] for family in families for curve in family]
    assert found.lines.tolist() == [number for row in padded for number in row]
    numbers = [k for k, family in enumerate(families) for _ in family] + [-1] * len(Q)
    assert found.cell_data["family"].tolist() == numbers


def test_pyvista_writes_and_we_read(tmp_path, web):
    pyvista = package("pyvista")
    V, Q, polygon = web
    cells = np.concatenate([np.insert(Q, 0, 4, axis=1).ravel(), [6], polygon])
    pyvista.PolyData(V, faces=cells).save(tmp_path / "n.vtp")
    W, F = io.read(tmp_path / "n.vtp")
    assert np.array_equal(W, V) and [*Q.tolist(), polygon.tolist()] == F
    small = V * [1, 1, 1e-6]
    solid = pyvista.PolyData(small, faces=cells).triangulate()
    for binary in (True, False):
        solid.save(tmp_path / "n.stl", binary=binary)
        W, F = io.read(tmp_path / "n.stl")
        assert len(W) == len(V) and len(F) == solid.n_cells
        assert np.allclose(np.sort(W, axis=0), np.sort(small, axis=0), atol=1e-5)


def test_obj_has_the_families_as_groups_of_lines(tmp_path):
    Q = mesh.grid_quads(2, 1)
    io.write(tmp_path / "n.obj", np.arange(18.0).reshape(6, 3), Q, "all")
    lines = (tmp_path / "n.obj").read_text().splitlines()
    at = [lines.index(f"g {name}") for name in ("panels", "u", "v", "d1", "d2")]
    assert at == sorted(at)
    along_u = {tuple(sorted(map(int, line.split()[1:]))) for line in lines[at[1] + 1 : at[2]]}
    assert along_u == {(1, 3, 5), (2, 4, 6)}


def test_glb_is_read_by_vtk_with_lines_and_y_up(tmp_path, web):
    reader = package("vtkmodules.vtkIOGeometry").vtkGLTFReader()
    package("vtkmodules.util.numpy_support")
    V, Q, polygon = web
    V = V * [1, 1, 1e-6]
    io.write(tmp_path / "n.glb", V, Q, "all", [polygon])
    reader.SetFileName(str(tmp_path / "n.glb"))
    reader.Update()
    walk = reader.GetOutput().NewIterator()
    parts = []
    while not walk.IsDoneWithTraversal():
        parts.append(walk.GetCurrentDataObject())
        walk.GoToNextItem()
    assert [part.GetNumberOfPolys() for part in parts] == [2 * len(Q), 4, 0, 0, 0, 0]
    edges = [sum(len(c) - 1 for c in family) for family in mesh.polylines(Q)]
    assert [part.GetNumberOfLines() for part in parts[2:]] == edges
    x, y, z = parts[0].GetPoint(5)
    assert np.allclose([x, -z, y], V[5], atol=1e-6)


def glb(scene, body, version=2):
    words = json.dumps(scene).encode() if isinstance(scene, dict) else scene
    words += b" " * (-len(words) % 4)
    head = struct.pack("<4sII", b"glTF", version, 28 + len(words) + len(body))
    chunk = struct.pack("<I4s", len(body), b"BIN\0") + body
    return head + struct.pack("<I4s", len(words), b"JSON") + words + chunk


def triangle_scene(**accessor):
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"} | accessor
    return {
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"children": [1], "scale": [2, 2, 2], "translation": [0, 0, 5]},
            {"mesh": 0, "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "bufferViews": [{"byteOffset": 0}],
        "accessors": [accessor],
    }


@pytest.mark.parametrize("suffix", [".stl", ".glb", ".3dm"])
def test_coordinates_that_float32_cannot_hold_are_refused_by_the_writer(tmp_path, suffix):
    if io.missing(suffix):
        pytest.skip(f"no package for {suffix}")
    V = 1e39 * np.array([[0, 1, 0], [0, 0, 0], [1, 0, 0], [1, 1, 0]])
    with pytest.raises(ValueError, match="no place for coordinates beyond 1e38"):
        io.write(tmp_path / f"far{suffix}", V, mesh.grid_quads(1, 1))
    assert not any(tmp_path.iterdir())


def test_glb_comes_back_as_triangles_in_float32_and_nodes_move_their_meshes(tmp_path, web):
    V, Q, _ = web
    io.write(tmp_path / "n.glb", V, Q)
    W, F = io.read(tmp_path / "n.glb")
    T = mesh.triangles(V, Q)[1]
    assert np.abs(W[F] - V[T]).max() < 1e-7 * np.ptp(V)  # float32 about the middle of the net
    body = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()
    V, F = io.read(put(tmp_path, "t.glb", glb(triangle_scene(), body)))
    # a quarter turn about z, twice the size, five along z; then y up becomes z up
    assert np.allclose(V[F[0]], [[0, -5, 0], [0, -5, 2], [-2, -5, 0]])
    scene = triangle_scene()
    del scene["scenes"]  # then it begins with the nodes that are no children
    assert np.array_equal(io.read(put(tmp_path, "s.glb", glb(scene, body)))[0], V)


def test_broken_glb_files_are_refused(tmp_path):
    def bad(data, words):
        refused(put(tmp_path, "a.glb", data), words)

    body = bytes(36)
    bad(glb(b'{"a":', body), "broken")
    bad(glb(triangle_scene(count=3_000_000), body), "broken")
    bad(glb(triangle_scene(), body)[:-4], "broken")
    bad(glb({"extensionsRequired": ["draco"]}, body), "draco")
    bad(glb(triangle_scene() | {"nodes": [{"children": [0]}]}, body), "broken")
    bad(glb(triangle_scene(sparse={}), body), "broken")
    bad(glb(triangle_scene(), b"\xff" * 36), "usable number")


def test_broken_gltf_scenes_are_refused_and_matrices_and_files_beside_are_read(tmp_path):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()

    def scene(**part):
        changed = triangle_scene()
        changed["meshes"][0]["primitives"][0] |= part
        return changed

    far = scene(indices=1)
    far["accessors"].append({"bufferView": 1, "componentType": 5121, "count": 3})
    far["bufferViews"].append({"byteOffset": 36})
    for broken, words in (
        (scene(mode=1), "the file has no faces"),
        (far, "there is no vertex 7, only 3"),
        (triangle_scene(count=-1), "it promises -1 numbers"),
        (triangle_scene(count=10**12), "it promises 1000000000000 numbers"),
    ):
        refused(put(tmp_path, "a.glb", glb(broken, points + bytes([0, 1, 7, 0]))), words)
    moved = triangle_scene()  # twice the size, then two along x, three along y, four along z
    moved["nodes"] = [{"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 2, 3, 4, 1]}]
    moved["buffers"] = [{"uri": "the%20points.bin"}]
    put(tmp_path, "the points.bin", points)
    V, F = io.read(put(tmp_path, "b.gltf", json.dumps(moved)))
    assert V[F[0]].tolist() == [[2, -4, 3], [4, -4, 3], [2, -4, 5]]  # y up becomes z up


def test_dxf_passes_ezdxf_audit_and_keeps_all(tmp_path, web):
    ezdxf = package("ezdxf")
    V, Q, polygon = web
    families = mesh.polylines(Q)
    ring = mesh.Families([*families.u, polygon[[0, 1, 2, 3, 4, 5, 0]]], *families[1:])
    io.write(tmp_path / "a net.dxf", V, Q, ring, [polygon])
    drawing = ezdxf.readfile(tmp_path / "a net.dxf")
    audit = drawing.audit()
    assert not audit.errors and not audit.fixes
    space = drawing.modelspace()
    panels, hexagon = space.query("MESH")
    assert (panels.dxf.layer, hexagon.dxf.layer) == ("panels", "panels_cut")
    assert np.array_equal(np.array(panels.vertices), V)
    assert [list(face) for face in panels.faces] == Q.tolist()
    (corners,) = hexagon.faces
    assert np.array_equal(np.array(hexagon.vertices)[list(corners)], V[polygon])
    for name, family in ring._asdict().items():
        found = list(space.query(f'POLYLINE[layer=="{name}"]'))
        assert len(found) == len(family)
        for line, curve in zip(found, family, strict=True):
            assert line.is_closed == (curve[0] == curve[-1])
            points = np.array([tuple(vertex.dxf.location) for vertex in line.vertices])
            assert np.array_equal(points, V[curve[:-1] if line.is_closed else curve])


def test_3dm_keeps_quads_and_double_precision(tmp_path, web):
    rhino = package("rhino3dm")
    V, Q, polygon = web
    families = mesh.polylines(Q)
    io.write(tmp_path / "a net.3dm", V, Q, families, [polygon])
    model = rhino.File3dm.Read(str(tmp_path / "a net.3dm"))
    names = [layer.Name for layer in model.Layers]
    assert names == ["panels", "panels_cut", "u", "v", "d1", "d2"]
    found = {name: [] for name in names}
    for item in model.Objects:
        found[names[item.Attributes.LayerIndex]].append(item.Geometry)
    (panels,), (hexagon,) = found["panels"], found["panels_cut"]
    assert panels.IsValid and len(hexagon.Faces) == 4
    points = [panels.Vertices.Point3dAt(k) for k in range(len(panels.Vertices))]
    assert np.array_equal([[p.X, p.Y, p.Z] for p in points], V)
    assert np.array_equal([panels.Faces[k] for k in range(len(panels.Faces))], Q)
    for name, family in families._asdict().items():
        assert len(found[name]) == len(family)
        for line, curve in zip(found[name], family, strict=True):
            points = [line.Point(k) for k in range(line.PointCount)]
            assert np.array_equal([[p.X, p.Y, p.Z] for p in points], V[curve])


@pytest.fixture
def trimmed():
    """2 x 2 whole quads, and cut panels of 3, 4, 5 and 6 corners, the last with a hollow."""
    V = np.stack([*np.mgrid[:3, :3].reshape(2, -1), np.linspace(0, THIRD, 9) ** 2], axis=1)
    more = [2, 3, 1e-3], [1, 2.5, THIRD], [2, 2.6, 0.1], [0, 2.5, 0], [2.5, 0, 0], [2.9, 0.4, 0]
    more = [*more, [3, 1.5, 0.2], [2.4, 0.6, 0.1], [2.5, 2, 0.1]]
    polygons = [[8, 17, 11, 9], [8, 11, 5], [2, 5, 8, 10, 12], [7, 6, 13, 16, 14, 15]]
    return np.concatenate([V, more]), mesh.grid_quads(2, 2), [np.array(p) for p in polygons]


def shoelace(x, y):
    """Twice the areas of the polygons of corners x, y (..., k) in the plane."""
    return np.sum(x * np.roll(y, -1, axis=-1) - y * np.roll(x, -1, axis=-1), axis=-1)


def rebuilt(faces):
    """The faces, each as a tuple from its smallest corner on: order and orientation count."""
    lists = [[int(k) for k in face] for face in faces]
    return [tuple(f[f.index(min(f)) :] + f[: f.index(min(f))]) for f in lists]


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".off", ".vtp", ".3dm"])
def test_cut_panels_come_back_as_such_and_those_of_four_corners_are_no_quads(
    tmp_path, trimmed, suffix
):
    need(suffix)
    V, Q, polygons = trimmed
    path = tmp_path / f"trimmed{suffix}"
    io.write(path, V, Q, "all" if suffix in io.WITH_CURVES else None, polygons)
    net = io.net(path)
    assert np.array_equal(net.V, V) and np.array_equal(net.Q, Q)
    assert [p.tolist() for p in net.polygons] == [p.tolist() for p in polygons]
    io.write(path, V, Q, None, polygons[:1], force=True)  # all faces have four corners
    net = io.net(path)
    assert np.array_equal(net.Q, Q) and rebuilt(net.polygons) == rebuilt(polygons[:1])
    assert len(io.read(path)[1]) == len(Q) + 1


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
def test_meshio_reads_quads_and_then_cut_panels(tmp_path, trimmed, suffix):
    meshio = package("meshio")
    V, Q, polygons = trimmed
    io.write(tmp_path / f"n{suffix}", V, Q, None, polygons)
    found = meshio.read(tmp_path / f"n{suffix}")
    assert np.array_equal(found.points, V)
    faces = [face.tolist() for block in found.cells for face in block.data]
    assert faces == [*Q.tolist(), *(p.tolist() for p in polygons)]


def test_off_and_vtp_have_quads_and_then_cut_panels(tmp_path, trimmed):
    V, Q, polygons = trimmed
    expected = [*Q.tolist(), *(p.tolist() for p in polygons)]
    io.write(tmp_path / "n.off", V, Q, None, polygons)
    lines = (tmp_path / "n.off").read_text().splitlines()
    lines = [line for line in lines if not line.startswith("#")]
    assert lines[1] == f"{len(V)} {len(expected)} 0"
    assert [[*map(int, line.split()[1:])] for line in lines[2 + len(V) :]] == expected
    pyvista = package("pyvista")
    io.write(tmp_path / "n.vtp", V, Q, "all", polygons)
    found = pyvista.read(tmp_path / "n.vtp")
    assert [face.tolist() for face in found.irregular_faces] == expected
    assert found.cell_data["family"][-len(expected) :].tolist() == [-1] * 4 + [-2] * 4


@pytest.mark.parametrize("faces", [False, True])
def test_dxf_has_cut_panels_in_a_layer_of_their_own(tmp_path, trimmed, faces):
    ezdxf = package("ezdxf")
    V, Q, polygons = trimmed
    io.write(tmp_path / "n.dxf", V, Q, "all", polygons, faces=faces)
    drawing = ezdxf.readfile(tmp_path / "n.dxf")
    assert not drawing.audit().errors
    space = drawing.modelspace()
    if faces:
        found = {name: space.query(f'3DFACE[layer=="{name}"]') for name in ("panels", "panels_cut")}
        assert [len(some) for some in found.values()] == [4, 1 + 2 + 3 + 4]
        corners = np.array([[*map(tuple, f.wcs_vertices()[:3])] for f in found["panels_cut"]])
    else:
        panels, cut = space.query("MESH")
        assert (panels.dxf.layer, cut.dxf.layer) == ("panels", "panels_cut")
        points = np.array(cut.vertices)
        got = [points[list(face)].tolist() for face in cut.faces]
        assert got == [V[p].tolist() for p in polygons]
        corners = np.array(panels.vertices)[np.array([list(face) for face in panels.faces])]
        assert np.array_equal(corners, V[Q])
        return
    twice = shoelace(corners[..., 0], corners[..., 1])
    whole = sum(shoelace(*V[p, :2].T) for p in polygons)
    assert (twice > -1e-6).all() and twice.sum() == pytest.approx(whole, rel=1e-12)


def test_3dm_has_each_cut_panel_as_a_mesh_in_their_layer(tmp_path, trimmed):
    rhino = package("rhino3dm")
    V, Q, polygons = trimmed
    io.write(tmp_path / "n.3dm", V, Q, "all", polygons)
    model = rhino.File3dm.Read(str(tmp_path / "n.3dm"))
    layer = [layer.Name for layer in model.Layers].index("panels_cut")
    found = [m.Geometry for m in model.Objects if m.Attributes.LayerIndex == layer]
    for one, polygon in zip(found, polygons, strict=True):
        corners = [one.Vertices.Point3dAt(k) for k in range(len(one.Vertices))]
        assert np.array_equal([[p.X, p.Y, p.Z] for p in corners], V[polygon])
        assert len(one.Faces) == len(polygon) - 2 and one.IsValid


def test_glb_has_cut_panels_as_a_mesh_of_triangles(tmp_path, trimmed):
    V, Q, polygons = trimmed
    io.write(tmp_path / "n.glb", V, Q, "all", polygons)
    data = (tmp_path / "n.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    scene, body = json.loads(data[20 : 20 + length]), data[28 + length :]
    parts = {one["name"]: one["primitives"][0] for one in scene["meshes"]}
    assert [*parts] == ["panels", "panels_cut", "u", "v", "d1", "d2"]
    assert [part["mode"] for part in parts.values()] == [4, 4, 1, 1, 1, 1]

    def numbers(accessor, kind):
        view = scene["bufferViews"][scene["accessors"][accessor]["bufferView"]]
        return np.frombuffer(body, kind, view["byteLength"] // 4, view["byteOffset"])

    part = parts["panels_cut"]
    corners = numbers(part["indices"], "<u4").reshape(-1, 3)
    assert len(corners) == 1 + 2 + 3 + 4
    points = numbers(part["attributes"]["POSITION"], "<f4").reshape(-1, 3)[corners]
    twice = shoelace(points[..., 0], -points[..., 2])  # what was y is -z
    whole = sum(shoelace(*V[p, :2].T) for p in polygons)
    assert (twice > -1e-6).all() and twice.sum() == pytest.approx(whole, rel=1e-5)


def test_a_rhino_file_without_a_mesh_says_what_to_do(tmp_path):
    rhino = package("rhino3dm")
    model = rhino.File3dm()
    model.Objects.AddPoint(1, 2, 3)
    assert model.Write(str(tmp_path / "p.3dm"), 7)
    refused(tmp_path / "p.3dm", "holds no mesh, mesh its surfaces first")


@pytest.mark.parametrize("suffix", list(TEXT))
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_text_by_hand(tmp_path, suffix, ends):
    path = put(tmp_path, f"t{suffix}", TEXT[suffix].replace("\n", ends))
    V, F = io.read(path)
    assert V.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]] and F == FACES
    net = io.net(path)
    assert net.Q.tolist() == FACES[:1] and [p.tolist() for p in net.polygons] == FACES[1:]
    assert io.surface(path).F.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]


def test_obj_counts_from_the_end_and_continues_lines_and_off_has_colours(tmp_path):
    words = (
        "o caf\xe9\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 \\\n 0\nf -3 -2 -1 # x\nv 0 1 0\nf 1 3 \\\n4\n"
    )
    V, F = io.read(put(tmp_path, "t.obj", words.encode("latin-1")))
    assert F.tolist() == [[0, 1, 2], [0, 2, 3]] and V[2].tolist() == [1, 1, 0]
    refused(put(tmp_path, "r.obj", CORNERS + "f 1 2 3 1\n"), "quads are wanted", io.net)
    words = "COFF 3 1 0\n# x\n0 0 0 1 0 0 1\n\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2\n"
    assert io.read(put(tmp_path, "c.off", words))[1].tolist() == [[0, 1, 2]]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("uniform", [True, False])
def test_binary_ply_of_both_byte_orders(tmp_path, order, uniform):
    kind = {"<": "little", ">": "big"}[order]
    faces = [[0, 1, 2, 3], [4, 0, 1, 2]] if uniform else FACES
    head = (
        f"ply\r\nformat binary_{kind}_endian 1.0\r\nelement vertex 5\r\nproperty uchar red\r\n"
        "property double x\r\nproperty float y\r\nproperty short z\r\nelement face 2\r\n"
        "property list uchar uint vertex_indices\r\nproperty double area\r\nend_header\r\n"
    )
    body = b"".join(struct.pack(f"{order}Bdfh", 9, k * THIRD, 0.5 * k, -k) for k in range(5))
    for face in faces:
        body += struct.pack(f"{order}B{len(face)}Id", len(face), *face, 1.0)
    V, F = io.read(put(tmp_path, "t.ply", head.encode() + body))
    assert V.tolist() == [[k * THIRD, 0.5 * k, -k] for k in range(5)]
    assert (F.tolist() if uniform else F) == faces
    refused(put(tmp_path, "u.ply", head.encode() + body[:-3]), "ends early")


def test_a_seam_is_closed_or_kept_and_all_else_stays(tmp_path, web):
    V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0], [1, 1, 0]])
    path = tmp_path / "s.obj"
    io.write(path, V, np.array([[0, 1, 2], [4, 5, 3]]))
    joined, open_one = io.surface(path), io.surface(path, merge=False)
    assert len(joined.V) == 4 and joined.repaired == ["duplicate vertices merged: 2"]
    assert len(open_one.V) == 6 and open_one.repaired == []
    V, T = mesh.triangles(*web[:2])
    io.write(path, V, T, force=True)
    W, F, repaired = io.surface(path)
    assert np.array_equal(W, V) and np.array_equal(F, T) and repaired == []


def test_stl_corners_are_merged(tmp_path):
    T = repair.triangulate(CUBE, SIDES)
    V, F, repaired = io.surface(put(tmp_path, "c.stl", stl(CUBE, T)))
    assert len(V) == 8 and len(F) == 12 and np.array_equal(V[F], CUBE[T])
    assert repaired == ["corners of triangles at equal points were read as one vertex"]
    refused(tmp_path / "c.stl", "holds triangles: quads are wanted", io.net)
    words = "SOLID\nFACET\n" + "".join(f"VERTEX {x} {y} {z}\n" for x, y, z in CUBE[:3])
    assert np.array_equal(io.read(put(tmp_path, "t.stl", words + "END SOLID"))[0], CUBE[:3])


@pytest.mark.parametrize("suffix", io.READERS)
def test_files_that_are_none_or_of_another_kind(tmp_path, suffix, web):
    need(suffix)
    need(".vtp")
    refused(tmp_path / f"missing{suffix}", "no such file")
    refused(put(tmp_path, f"e{suffix}", b""), "empty")
    (tmp_path / f"d{suffix}").mkdir()
    refused(tmp_path / f"d{suffix}", "directory")
    junk = [b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" * 9, b"hello\nworld\n", b" \n"]
    for other in {*io.READERS} & {*io.WRITERS} - {suffix}:
        io.write(tmp_path / f"a{other}", *web[:2])
        junk.append((tmp_path / f"a{other}").read_bytes())
    for data in junk:
        refused(put(tmp_path, f"j{suffix}", data), ".")


CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
OFF, PLY = "OFF\n3 1 0\n0 0 0\n1 0 0\n", TEXT[".ply"]
BAD = [
    (".obj", "v 0 0 0\nv 1 0\n", "line 2: .* coordinates"),
    (".obj", "v 0 0 0\nv 1 0 x\n", "line 2"),
    (".obj", CORNERS + "f 1 2 4\n", "line 4: there is no vertex 4, only 1 to 3"),
    (".obj", "v 0 0 0\nf 0 1 2\n", "line 2: there is no vertex 0, only 1 to 1"),
    (".obj", "v 0 0 0\nf -1 -2 -3\n", "line 2"),
    (".obj", "v 0 0 0\nf 1 1\n", "line 2: a face needs three corners"),
    (".obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "vertex 3 .*no usable number"),
    (".obj", "v 0 0 0\nv 1 0 0\n", "no faces"),
    (".obj", "v 0 0 0\nf a b c\n", "line 2: 'a b c' is no face"),
    (".off", OFF, "ends early"),
    (".off", OFF + "0 1 0\n3 0 1 3\n", "line 6: there is no vertex 3"),
    (".off", OFF + "0 1 0\n4 0 1 2\n", "line 6: .* is no face of 4 corners"),
    (".off", "OFF\nx\n", "line 2: 'x' is no pair of numbers"),
    (".off", "OFF BINARY\n", "text OFF"),
    (".off", "4OFF\n3 1 0\n", "starts with OFF"),
    (".ply", PLY[:-22], "ends early"),
    (".ply", PLY.replace("3 1 4 2", "3 1 4 5"), "names vertex 5"),
    (".ply", PLY.replace("property float y", "property half y"), "line 6"),
    (".ply", PLY.replace("float y", "float w"), "x, y and z"),
    (".ply", PLY.replace("element face 2", "element face 0"), "no faces"),
    (".ply", PLY.replace("7 4 0", "7 4 zero"), "could not convert .*zero"),
    (".ply", PLY.replace("3 1 4 2", "3 1 4 2.5"), "names vertex 2.5"),
    (".ply", PLY.replace("edge 1", "edge 1" + 20 * "0"), "ends early"),
    (".stl", stl(CUBE, np.array([[0, 1, 2]]))[:-1], "133 bytes"),
    (".stl", "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\n", "ends early"),
    (".xyz", "0 0 0\n", "the suffix '.xyz': files to read end with .obj"),
    ("", "0 0 0\n", "no suffix"),
]


@pytest.mark.parametrize("suffix, content, words", BAD)
def test_bad_files_are_one_sentence(tmp_path, suffix, content, words):
    path = put(tmp_path, f"a{suffix}", content)
    for read in (io.read, io.surface, io.net):
        refused(path, words, read)


def test_bad_vtp_files_are_refused_in_silence(tmp_path, web, capfd):
    need(".vtp")
    io.write(tmp_path / "n.vtp", *web[:2])
    data = (tmp_path / "n.vtp").read_bytes()
    for cut in (0.1, 0.9):
        refused(put(tmp_path, "c.vtp", data[: int(cut * len(data))]), "broken, says VTK: ")
    count = f'NumberOfPoints="{len(web[0])}"'.encode()
    assert count in data  # more points than there is memory: VTK ends the process
    huge = data.replace(count, b'NumberOfPoints="300000000000"')
    refused(put(tmp_path, "h.vtp", huge), "broken, says VTK")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("suffix", "library", "writer", "answer"),
    [(".vtp", "pyvista", "PolyData.save", None), (".3dm", "rhino3dm", "File3dm.Write", False)],
)
def test_what_a_library_could_not_write_is_told(
    tmp_path, web, monkeypatch, suffix, library, writer, answer
):
    """VTK and Rhino raise no error on a full disk."""

    def half(self, path, *version):
        Path(path).write_bytes(b"<VTKFile")
        return answer

    package(library)
    monkeypatch.setattr(f"{library}.{writer}", half)
    with pytest.raises(OSError, match=f"could not write .*{suffix}$"):
        io.write(tmp_path / f"n{suffix}", *web[:2])
    assert not any(tmp_path.iterdir())


def test_a_place_without_permission_is_told_before_the_work(tmp_path, web, monkeypatch):
    (tmp_path / "old.obj").touch()
    asked = []
    monkeypatch.setattr(os, "access", lambda path, mode: asked.append(path))
    for name, place in (("old.obj", tmp_path / "old.obj"), ("new.obj", tmp_path)):
        with pytest.raises(PermissionError, match=f"{name}: no permission to write there"):
            io.check_output(tmp_path / name, force=True)
        assert asked.pop() == place


def test_nothing_is_overwritten_without_force(tmp_path, web):
    path = put(tmp_path, "n.obj", "precious")
    with pytest.raises(FileExistsError, match="exists already"):
        io.write(path, *web[:2])
    assert path.read_text() == "precious" and list(tmp_path.iterdir()) == [path]
    io.write(path, *web[:2], force=True)
    assert np.array_equal(io.net(path).Q, web[1])


@pytest.mark.parametrize(
    "name, more, words",
    [
        ("nowhere/n.obj", {}, "no folder"),
        ("n.xyz", {}, "files to write end with"),
        ("n.step", {}, "files to write end with"),
        ("n.off", {"curves": "all"}, "no place for curves"),
        ("n.ply", {"curves": "all"}, "no place for curves"),
        ("n.obj", {"curves": "some"}, "Families"),
        ("n.obj", {"curves": mesh.Families([[0, 999]], [], [], [])}, "names vertex 999"),
        ("n.obj", {"curves": mesh.Families([np.zeros((3, 3))], [], [], [])}, "indices are wanted"),
        ("n.obj", {"polygons": [[0, 1, -1]]}, "names vertex -1"),
        ("n.glb", {"up": "y"}, "y is upwards in GLB files anyway, leave `up` as it is"),
    ],
)
def test_what_cannot_be_written_is_refused(tmp_path, web, name, more, words):
    with pytest.raises(ValueError, match=words):
        io.write(tmp_path / name, *web[:2], **more)
    (tmp_path / "d.obj").mkdir()
    with pytest.raises(ValueError, match="directory"):
        io.write(tmp_path / "d.obj", *web[:2], force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["d.obj"]
