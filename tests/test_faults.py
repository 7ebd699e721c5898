"""What once went wrong with surfaces and files that people have: one test a kind of fault."""

import base64
import json

import numpy as np
import pytest
from test_cli import inet, numbers  # noqa: F401  a fixture
from test_io import glb, put, refused, triangle_scene

from inetlib import design, examples, io, loxodrome, measure, mesh, planar, repair, solver, surfaces

ANGLES = np.radians([60, 60])


def judged(V, Q, pair):
    """Faces that are off their angles, turned over, or not convex, by plane geometry."""
    v1, v2, v3, v4 = V[Q].transpose(1, 0, 2)
    normal = np.cross(v3 - v1, v4 - v2)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    right = v3 - v1
    up = np.cross(normal, right)
    a, b, c, d = (np.sum(v * right, 1) + 1j * np.sum(v * up, 1) for v in (v1, v2, v3, v4))
    off = [abs(np.angle((d - b) / (c - a)) - pair[0])]
    off += [abs(np.angle((d - c + a - b) / (d - a + c - b)) - pair[1])]
    bad = np.max(off, axis=0) > 1e-10
    for one, two, three in ((a, b, c), (b, c, d), (c, d, a), (d, a, b)):
        bad |= np.imag(np.conj(two - one) * (three - two)) < 0
    sides = [np.sort(Q[:, [k, k - 1]], axis=1) for k in range(4)]
    around = {}
    for face in range(len(Q)):
        for side in sides:
            around.setdefault(tuple(side[face]), []).append(face)
    turned = [np.dot(*normal[two]) < 0 for two in around.values() if len(two) == 2]
    return int(np.count_nonzero(bad) + np.count_nonzero(turned))


def polar(rings, sides, height):
    """A disk of triangles around a middle vertex, z = height(complex numbers)."""
    r, turn = np.arange(1, rings + 1) / rings, np.exp(2j * np.pi * np.arange(sides) / sides)
    z = np.concatenate([[0], np.outer(r, turn).ravel()])
    k = np.arange(sides)
    F = [np.stack([0 * k, 1 + k, 1 + np.roll(k, -1)], axis=1)]
    for ring in range(rings - 1):
        a, b = (1 + (ring + i) * sides + np.array([k, np.roll(k, -1)]) for i in (0, 1))
        F += [np.stack([a[0], b[0], b[1]], axis=1), np.stack([a[0], b[1], a[1]], axis=1)]
    return np.stack([z.real, z.imag, height(z)], axis=1), np.concatenate(F)


def sheet(n=10):
    """A curved sheet of n by n quads."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1), indexing="ij")
    points = np.stack([u, v, 0.3 * u * v + 0.1 * np.sin(3 * u)], axis=-1)
    return points.reshape(-1, 3), mesh.grid_quads(n, n)


def obj(V, F):
    rows = ["v {!r} {!r} {!r}".format(*point) for point in V.tolist()]
    return "\n".join(rows + ["f " + " ".join(str(k + 1) for k in face) for face in F]) + "\n"


@pytest.mark.parametrize(
    ("rings", "sides", "height"),
    [
        (4, 12, lambda z: np.real(z**2)),
        (3, 18, lambda z: 0.8 * np.real(z**3)),
        (8, 24, lambda z: 0.3 - 0.5 * abs(z) ** 2 * np.cos(6 * np.angle(z))),
    ],
)
def test_saddles_and_canopies_are_flattened_without_a_branch_point(rings, sides, height):
    net = design.cover(*polar(rings, sides, height), *ANGLES, count=400)
    assert net.report.converged and judged(net.V, net.Q, ANGLES) == 0
    assert net.report.covered > 0.6 and net.report.surface_flips == 0


@pytest.mark.parametrize(
    ("rings", "sides", "height", "pair", "count"),
    [(2, 8, 0.7, (50, 110), 40), (3, 10, 0.9, (60, 60), 100), (4, 12, 0.9, (75, 50), 100)],
)
def test_on_coarse_facets_the_last_digits_are_found_in_space(rings, sides, height, pair, count):
    pair = np.radians(pair)
    net = design.cover(*polar(rings, sides, lambda z: height * np.real(z**4)), *pair, count=count)
    assert net.report.converged and judged(net.V, net.Q, pair) == 0
    assert 0 < net.report.distance_max < 1e-3


def egg(z):
    """An egg on its side, open at the far end: its map to the plane has very different scales."""
    polar = 2.6 * np.abs(z)
    x, y = np.sin(polar) * np.cos(np.angle(z)), np.sin(polar) * np.sin(np.angle(z))
    return np.stack([x, y, -1.6 * np.cos(polar)], axis=1)


@pytest.mark.parametrize("pair", [(75, 50), (60, 60), (100, 60)])
def test_covers_of_high_distortion_have_no_darts(pair):
    V, F = polar(12, 24, np.abs)
    net = design.cover(egg(V[:, 0] + 1j * V[:, 1]), F, *np.radians(pair), count=1000)
    assert net.report.converged and judged(net.V, net.Q, np.radians(pair)) == 0


def test_darts_are_counted_although_no_angle_sees_them():
    V, Q = sheet()
    V[:, 2] = 0
    i, j = np.divmod(np.arange(len(V)), 11)
    shifted = V + np.where((i + j) % 2, 0.06, 0)[:, None] * [1, 1, 0]  # 0.05 is half a diagonal
    assert np.allclose(measure.angles(V, Q), measure.angles(shifted, Q))
    assert measure.quality(V, Q).darts == 0 and measure.quality(shifted, Q).darts > 20
    found = solver.optimize(shifted, Q, *np.radians([90, 90]))
    assert found.converged == (judged(found.V, Q, np.radians([90, 90])) == 0)


def test_what_is_left_out_is_said_with_its_place():
    V, Q = sheet(20)
    V[:, 1] *= 1 - 0.97 * V[:, 0]  # a fin
    report = design.cover(V, Q, *ANGLES, count=60).report
    assert report.covered < 0.8 and len(report.notes) == 1
    assert "left out" in report.notes[0] and "near (" in report.notes[0]
    assert design.cover(*sheet(20), *ANGLES, count=400).report.notes == ()


def test_a_cut_made_on_purpose_stays_open(tmp_path):
    u, v = np.meshgrid(*[np.linspace(0, 2 * np.pi, n + 1) for n in (24, 12)], indexing="ij")
    points = [(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)]
    points = np.stack(points, axis=-1).reshape(-1, 3)
    path = put(tmp_path, "torus.obj", obj(points, mesh.grid_quads(24, 12)))
    for merge in (True, False):
        V, F, said = io.surface(path, merge)
        assert len(V) == 25 * 13 and len(mesh.boundary_loops(F)) == 1
        assert any("a cut would be closed" in words for words in said) is merge


def test_t_junctions_are_mended_and_said():
    V, Q = sheet(4)
    T = mesh.triangles(V, Q)[1]
    V = np.vstack([V, (V[11] + V[12]) / 2])  # the middle of an inner edge, on one side only
    at = next(k for k, face in enumerate(T.tolist()) if {11, 12} <= set(face))
    turn = next(k for k in range(3) if {T[at][k], T[at][k - 2]} == {11, 12})
    a, b, c = np.roll(T[at], -turn)
    T = np.vstack([np.delete(T, at, axis=0), [a, 25, c], [25, b, c]])
    W, G, said = repair.manifold(V, T)
    assert len(mesh.boundary_loops(G)) == 1 and len(W) == 26
    assert any("T-junctions" in words for words in said)
    assert len(mesh.boundary_loops(repair.manifold(V, T, merge=False)[1])) == 2


def test_slivers_are_named_bent_quads_cut_inside_and_bridged_holes_cut():
    V = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 1], [0, 10, 0], [5, -1e-9, 0]], dtype=float)
    with pytest.raises(ValueError, match=r"triangle 0-4-1 near \(0, 0, 0\) has no area"):
        design.cover(V, np.array([[0, 1, 2], [0, 2, 3], [0, 4, 1]]), *ANGLES)
    V = np.array([[0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 4, 0.2]], dtype=float)
    assert mesh.triangles(V, [[0, 1, 2, 3]])[1].tolist() == [[0, 1, 3], [1, 2, 3]]
    dart = np.array([[0, 0, 0], [4, 1, 0], [0, 2, 0], [1, 1, 0]], dtype=float)
    assert {1, 3} <= set(mesh.triangles(dart, [[0, 1, 2, 3]])[1][0].tolist())
    V = np.array([[0, 0], [10, 0], [10, 10], [0, 10], [4, 4], [4, 6], [6, 6], [6, 4]], dtype=float)
    V = np.column_stack([V, np.zeros(8)])
    T = repair.triangulate(V, [[0, 1, 2, 3, 0, 4, 5, 6, 7, 4]])
    area = np.cross(V[T[:, 1]] - V[T[:, 0]], V[T[:, 2]] - V[T[:, 0]])[:, 2] / 2
    assert (area > 0).all() and area.sum() == pytest.approx(96)


def test_nets_are_welded_and_repeated_corners_are_none(inet, tmp_path):  # noqa: F811
    V, Q = sheet()
    W, R = V[Q].reshape(-1, 3), np.arange(Q.size).reshape(-1, 4)
    put(tmp_path, "soup.obj", obj(W, R))
    said = numbers(inet("measure", "soup.obj", "--json"))
    assert said["vertices"] == 121 and "duplicate vertices merged: 279" in said["notes"]
    welded, again, _, _ = repair.welded(W, R)
    assert np.array_equal(welded[again], V[Q])
    net = loxodrome.web(surfaces.torus_profile(), 1.2, 0.9, 12)  # a closed one stays as it is
    assert repair.welded(net.V, net.Q)[1] is net.Q
    faces = [*Q[1:].tolist(), [*Q[0][:3].tolist(), Q[0][2]]]
    found = io.net(put(tmp_path, "abcc.obj", obj(V, faces)))
    assert len(found.Q) == 99 and [len(polygon) for polygon in found.polygons] == [3]


@pytest.mark.parametrize("scale", [1, 1000])
def test_a_glb_far_from_the_origin_keeps_the_angles(tmp_path, scale):
    net = loxodrome.web(surfaces.vase_profile(), *ANGLES, 24, 12)
    V = scale * (net.V + np.array([453210.5, 5412345.25, 312.0]))
    io.write(tmp_path / "n.glb", V, net.Q)
    W, F = io.read(tmp_path / "n.glb")
    back = np.empty_like(V)
    back[mesh.triangles(V, net.Q)[1]] = W[F]
    assert np.degrees(measure.deviations(back, net.Q, *ANGLES).max()) < 0.01
    with pytest.raises(ValueError, match="too far from the origin for the float32 of STL"):
        io.write(tmp_path / "n.stl", V, net.Q)


def test_off_files_are_tokens_and_stl_triangles_may_carry_data(tmp_path):
    words = "OFF 4 2 0 0 0 0 1 0 0\n1 1\n0 0 1 0 3 0 1\n2 3 0 2 3"
    V, F = io.read(put(tmp_path, "t.off", words))
    assert V[2].tolist() == [1, 1, 0] and F.tolist() == [[0, 1, 2], [0, 2, 3]]
    refused(put(tmp_path, "u.off", words + " 7"), "vertices and faces are promised")
    rows = np.array([[0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0]], dtype="<f4").tobytes()
    data = bytes(80) + np.uint32(2).tobytes() + 2 * (rows + np.uint16(3).tobytes() + b"abc")
    assert io.read(put(tmp_path, "p.stl", data))[1].tolist() == [[0, 1, 2], [0, 1, 2]]


def test_strips_fans_and_sparse_accessors_of_glb_are_read(tmp_path):
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype="<f4")
    for mode, wanted in ((5, [[0, 1, 2], [2, 1, 3]]), (6, [[0, 1, 2], [0, 2, 3]])):
        scene = triangle_scene(count=4)
        scene["meshes"][0]["primitives"][0]["mode"] = mode
        V, F = io.read(put(tmp_path, "s.glb", glb(scene, square.tobytes())))
        W, _ = io.read(put(tmp_path, "t.glb", glb(triangle_scene(count=3), square.tobytes())))
        place = np.vstack([W, W[1] + W[2] - W[0]])  # of the corners, turned by the nodes
        assert np.allclose(V[F], place[wanted])
    sparse = {"count": 1, "indices": {"bufferView": 1, "componentType": 5121}}
    scene = triangle_scene(sparse=sparse | {"values": {"bufferView": 2}})
    scene["bufferViews"] += [{"byteOffset": 36}, {"byteOffset": 40}]
    body = square[:3].tobytes() + bytes([2, 0, 0, 0]) + np.array([0, 7, 0], "<f4").tobytes()
    V, _ = io.read(put(tmp_path, "z.glb", glb(scene, body)))
    assert np.ptp(V, axis=0).max() == pytest.approx(14)  # 7, twice the size


def test_gltf_3dm_and_stl_come_back_and_units_stand_in_the_file(tmp_path):
    net = loxodrome.web(surfaces.vase_profile(), *ANGLES, 12, 5)
    io.write(tmp_path / "n.glb", net.V, net.Q)
    data = (tmp_path / "n.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    scene = json.loads(data[20 : 20 + length])
    scene["buffers"][0]["uri"] = "data:;base64," + base64.b64encode(data[28 + length :]).decode()
    V, F = io.read(put(tmp_path, "n.gltf", json.dumps(scene)))
    assert all(map(np.array_equal, io.read(tmp_path / "n.glb"), (V, F)))
    io.write(tmp_path / "n.stl", net.V, net.Q)
    assert len(io.read(tmp_path / "n.stl")[1]) == 2 * len(net.Q)
    io.write(tmp_path / "y.obj", net.V, net.Q, up="y")
    assert np.array_equal(io.read(tmp_path / "y.obj")[0], net.V[:, [0, 2, 1]] * [1, 1, -1])
    rhino = pytest.importorskip("rhino3dm", reason="the package rhino3dm is not installed")
    io.write(tmp_path / "n.3dm", net.V, net.Q, unit="mm")
    assert all(map(np.array_equal, io.read(tmp_path / "n.3dm"), (net.V, net.Q)))
    model = rhino.File3dm.Read(str(tmp_path / "n.3dm"))
    assert model.Settings.ModelUnitSystem == rhino.UnitSystem.Millimeters
    ezdxf = pytest.importorskip("ezdxf", reason="the package ezdxf is not installed")
    io.write(tmp_path / "n.dxf", net.V, net.Q, unit="ft", faces=True)
    drawing = ezdxf.readfile(tmp_path / "n.dxf")
    assert drawing.units == 2 and len(drawing.query("3DFACE")) == len(net.Q)
    for bad in ({"unit": "mm"}, {"faces": True}, {"up": "x"}, {"unit": "km"}):
        with pytest.raises(ValueError):
            io.write(tmp_path / "bad.obj", net.V, net.Q, **bad)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.obj", "v 0 0 0\n".encode("utf-16"), "UTF-16: save it as UTF-8"),
        ("b.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"),
        ("c.obj", "v 0 0 0\ncstype bspline\nsurf 0 1 0 1 1 1 1\nend\n", "free-form surface"),
        ("d.gltf", '{"buffers": [{"uri": "there.bin"}]}', "there.bin is not beside it"),
        ("e.gltf", '{"extensionsRequired": ["KHR_draco_mesh_compression"]}', "KHR_draco"),
        ("f.3dm", "no rhino", "no Rhino file"),
    ],
)
def test_files_of_other_kinds_are_named_as_what_they_are(tmp_path, name, content, words):
    refused(put(tmp_path, name, content), words)


def test_angles_and_webs_beyond_the_digits_are_refused_in_a_sentence():
    Q = mesh.grid_quads(3, 3)
    for bad in ((1.0, 1e-7), (1.0, np.pi - 1e-7)):
        with pytest.raises(ValueError, match="can be told from zero"):
            planar.planar_net(Q, *bad, handles=([0, 15], [0, 1]))
    with pytest.raises(ValueError, match="rows of 3000 quads fit: choose a smaller"):
        loxodrome.web(surfaces.cone_profile(0.1, 1e-3), 1.0, 0.05, 3000)
    net = loxodrome.web(surfaces.sphere_profile(), *np.radians([20, 20]), 3)
    assert "faces are flipped or darts" in net.message


@pytest.mark.parametrize("suffix, first", [(".obj", 1), (".ply", 0), (".off", 0)])
def test_numbers_of_vertices_are_those_of_the_file(inet, tmp_path, suffix, first):  # noqa: F811
    V, Q = surfaces.freeform_patch(3, 3)
    V[Q[4, 2]] = V[Q[4, 0]]  # a diagonal of length zero
    io.write(tmp_path / f"net{suffix}", V, Q)
    corners = "-".join(str(k + first) for k in Q[4])
    code, _, err = inet("optimize", f"net{suffix}", "--theta", "80", "-o", "new.obj")
    assert code == 2
    assert f"net{suffix}: the face {corners} near {mesh.place(V[Q[4, 0]])} has a diagonal" in err
    V, F = surfaces.freeform_patch(3, 3)[0], mesh.triangles(*surfaces.freeform_patch(3, 3))[1]
    F = np.concatenate([F, [[*F[5, :2], 15], [*F[5, :2], 12]]])  # four triangles at an edge
    io.write(tmp_path / f"sheet{suffix}", V, F)
    with pytest.raises(ValueError, match="more than two faces") as caught:
        io.surface(tmp_path / f"sheet{suffix}")
    edge = "-".join(str(k + first) for k in F[5, :2])
    back = "-".join(str(k + first) for k in F[5, 1::-1])
    words = str(caught.value)
    assert f"{edge} near" in words or f"{back} near" in words
    assert any(mesh.place(V[k]) in words for k in F[5, :2])


def test_the_bar_names_every_stage_of_a_cover(capfd):
    design.cover(*examples.wavy_roof(10), *ANGLES, count=50, progress=True)
    shown = capfd.readouterr().err
    for stage in ("checking", "flattening", "laying", "angle step", "measuring"):
        assert stage in shown


def test_what_a_format_has_no_place_for_is_said_before_the_work(inet):  # noqa: F811
    words = "cover", "roof", "--theta", "60", "--theta0", "60", "--quads", "1000000000"  # no end
    for more in (("x.obj", "--unit", "mm"), ("x.3dm", "--dxf", "3dface"), ("x.glb", "--up", "y")):
        code, out, err = inet(*words, "-o", *more)
        assert (code, out) == (2, "") and err.startswith(f"inet: {more[0]}: ")
