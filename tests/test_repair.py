"""Surfaces that are checked and repaired, and what is said of it; polygons cut into triangles."""

import igl
import numpy as np
import pytest

from inetlib import examples, loxodrome, mesh, repair


def sheet(n, m, point):
    """A mesh of n by m quads of the points (x, y, z) = point(u, v), 0 <= u, v <= 1."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    V = np.stack(np.broadcast_arrays(*point(u, v)), axis=-1).reshape(-1, 3).astype(float)
    return V, mesh.grid_quads(n, m)


def plate(n=6):
    return mesh.triangles(*sheet(n, n, lambda u, v: (2 * u, v, 0 * u)))


def polar(radius, angle, z=0.0):
    return radius * np.cos(angle), radius * np.sin(angle), z


def soup(V, F, noise=0.0):
    """Every face with vertices of its own."""
    V = V[F].reshape(-1, 3)
    V = V + noise * np.random.default_rng(3).standard_normal(V.shape)
    return V, np.arange(F.size).reshape(F.shape)


def torus(n=8):
    V, Q = sheet(n, n, lambda u, v: polar(3 + np.cos(TAU * v), TAU * u, np.sin(TAU * v)))
    return mesh.triangles(V, repair.merge(V, Q, 1e-9)[0])


TAU = 2 * np.pi
ROOF = examples.wavy_roof(12)
CUBE = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def test_turned_faces_are_turned_back_and_vertices_of_no_face_and_double_triangles_go():
    V, F = ROOF
    G = F.copy()
    G[[3, 40, 41]] = G[[3, 40, 41]][:, ::-1]
    found = repair.clean(V, G)
    assert found.repairs == ["triangles turned round, so that all are oriented alike: 3"]
    assert np.array_equal(np.sort(found.F), np.sort(F)) and len(mesh.opposites(found.F)) == F.size
    V, F = plate()
    found = repair.clean(np.concatenate([V[:1] + 50, V]), np.concatenate([F, F[5:7]]) + 1)
    dropped, left_out = found.repairs
    assert dropped == "collapsed or double triangles dropped: 2"
    assert left_out == "vertices of no face left out: 1"
    assert np.array_equal(found.V, V) and np.array_equal(found.F, F)


@pytest.mark.parametrize("noise", [0, 1e-13])
def test_a_soup_of_triangles_is_sewn_together(noise):
    V, F = ROOF
    found = repair.clean(*soup(V, F, noise))
    assert found.repairs == [f"duplicate vertices merged: {F.size - len(V)}"]
    assert len(found.V) == len(V) and len(found.loops) == 1
    np.testing.assert_allclose(found.V[found.F], V[F], atol=1e-12)


def test_a_surface_that_was_cut_open_stays_open_and_a_pole_of_collapsed_quads_is_closed():
    V, Q = sheet(12, 3, lambda u, v: polar(1, TAU * u, v))
    opened, sewn = repair.clean(V, Q), repair.clean(*soup(V, Q))
    assert opened.repairs == [] and len(opened.loops) == 1
    assert len(sewn.loops) == 2
    V, Q = sheet(8, 24, lambda u, v: polar(u, TAU * v, u**2))
    V[:25], V[24::25] = V[0], V[::25]
    found = repair.clean(V, Q)
    assert found.repairs[1:] == ["collapsed or double triangles dropped: 24"]
    assert len(found.loops) == 1 and len(found.loops[0]) == 24


def test_a_square_with_a_square_hole_loses_no_triangle_and_fans_are_those_of_libigl():
    V, Q = sheet(24, 24, lambda u, v: (u, v, 0.1 * u * v))
    Q = Q[np.abs(V[Q].mean(axis=1)[:, :2] - 0.5).max(axis=1) > 0.2]
    found = repair.clean(V, Q)
    assert not any(np.isin(found.F, loop).all(axis=1).any() for loop in found.loops)
    area, whole = (igl.doublearea(*X).sum() for X in (found[:2], mesh.triangles(V, Q)))
    assert area == pytest.approx(whole, rel=1e-12)
    V, F = plate(4)
    for seed in range(40):
        kept = F[np.random.default_rng(seed).random(len(F)) < 0.6]
        pinched = np.intersect1d(np.flatnonzero(~igl.is_vertex_manifold(kept)), kept)
        try:
            repair.require_single_fans(V, kept, mesh.opposites(kept))
            assert not pinched.size
        except ValueError as error:
            assert f"vertex {pinched[0]} near" in str(error)


def test_of_two_pinched_vertices_the_first_is_named_with_its_place():
    T = np.array([[0, 1, 2], [0, 3, 4], [5, 6, 7], [5, 8, 9]])
    with pytest.raises(ValueError, match=r"vertex 0 near \(0, 1, 2\)"):
        repair.require_single_fans(np.arange(30).reshape(10, 3), T, mesh.opposites(T))


def holes(*places):
    V, F = plate(9)
    middle = V[F].mean(axis=1)[:, :2]
    return V, np.delete(F, [np.argmin(np.linalg.norm(middle - p, axis=1)) for p in places], axis=0)


def test_openings_are_no_fault_and_the_largest_piece_is_the_first():
    assert [len(loop) for loop in repair.clean(*holes([0.5, 0.3], [1.4, 0.7])).loops[1:]] == [3, 3]
    V, F, said = repair.piece(*[np.concatenate([*X]) for X in two_plates()], 1)
    assert V[:, 0].max() == 4 and "piece 1 of 2 is covered, 80 % of the area" in said
    V, F, said = repair.piece(V, F, 1)
    assert not said and len(F) == 72
    with pytest.raises(ValueError, match="piece 2: the surface has 1 separate pieces"):
        repair.piece(V, F, 2)


def two_plates():
    """A plate of 2 by 1, and another one twice as large beside it."""
    V, F = plate()
    return (V - 5, 2 * V), (F, F + len(V))


def pinched():
    """A bent strip of triangles with its last vertex on its first one."""
    V, Q = sheet(8, 1, lambda u, v: polar(1 + v, 5 * u))
    Q[Q == 16] = 0
    return mesh.triangles(V, Q)


def changed(index, value):
    V, F = plate()
    V[index] = value
    return V, F


def wings():
    V = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0.0]])
    return V, np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])


FLAT = changed(8, [1 / 6, 1 / 12, 0])
NEVER = {  # no manifold
    "one-sided: see the loop of triangles": lambda: examples.moebius_strip(12, 1),
    "edge 0-1 belongs to more than two faces: not a manifold": wings,
    r"vertex 0 near \(1, 0, 0\) form two fans: not a manifold": pinched,
    r"triangle 1-7-8 near \(0, 0\.166667, 0\) has no area": lambda: FLAT,
}
TWO = [np.concatenate([X, X + shift]) for X, shift in zip(plate(), (5, 49), strict=True)]
ELSE = {  # no disk with any number of holes
    "has 0 boundary loops and 1 handles": torus,
    "has 1 boundary loops and 1 handles": lambda: (torus()[0], torus()[1][1:]),
    r"has 2 separate pieces \(of 72, 72 faces\)": lambda: TWO,
}
BROKEN = {
    "vertex 5 has a coordinate that is not a finite number": lambda: changed(5, np.nan),
    "the mesh has no faces": lambda: (np.zeros((0, 3)), np.zeros((0, 3), int)),
    "there are only 49 vertices": lambda: (plate()[0], plate()[1] + 2),
}


@pytest.mark.parametrize("words", [*NEVER, *ELSE, *BROKEN])
def test_surfaces_that_cannot_be_covered_and_those_of_them_that_may_be_a_reference(words):
    V, F = (NEVER | ELSE | BROKEN)[words]()
    with pytest.raises(ValueError, match=words) as caught:
        repair.clean(V, F)
    assert "\n" not in str(caught.value)
    if words in ELSE:
        W, T, _ = repair.manifold(V, F)
        assert np.array_equal(W[T], V[F])
    else:
        with pytest.raises(ValueError, match=words):
            repair.manifold(V, F)


def test_a_broken_surface_is_mended_and_says_so():
    V, faces = soup(CUBE, SIDES)  # every side for itself
    V[5] += 1e-9
    faces[2] = faces[2, ::-1]
    rows = [*faces.tolist(), [0, 1, 1], faces[0].tolist(), [0, 1, 2, 2]]
    W, T, said = repair.manifold(np.concatenate([V, [[5.0, 5, 5]]]), rows)
    assert W.shape == (8, 3) and T.shape == (12, 3)
    assert np.isclose(abs(np.linalg.det(W[T]).sum()) / 6, 1)  # all alike: the volume
    assert [int(words.split(": ")[1]) for words in said] == [8, 1, 16, 3, 2, 1]
    with pytest.raises(ValueError, match="no face has three different corners"):
        repair.manifold(V, [[0, 1, 1]])
    assert repair.manifold(W, T)[2] == []  # closed, and nothing to mend


def test_merging_never_makes_a_surface_worse():
    V, F = wings()
    W, _, said = repair.manifold(*soup(V, F))  # three sheets that share an edge by its place
    assert len(W) == 9
    assert said[0].startswith("duplicate vertices were not merged: the edge near (0, 0, 0) belongs")
    seam = plate()[0][[0, 1, 8, 7, 0, 8]], np.array([[0, 1, 2], [4, 5, 3]])
    assert repair.manifold(*seam)[2] == ["duplicate vertices merged: 2"]
    assert repair.manifold(*seam, merge=False)[2] == []
    fine = np.array([[0.0, 0, 0], [1e-8, 0, 0], [0, 1e-8, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    assert len(repair.manifold(fine, np.arange(6).reshape(2, 3))[0]) == 6


def test_polygons_are_cut_inside_and_three_corners_on_a_line_are_no_ear():
    V = np.stack(polar(np.tile([1.0, 3], 5), np.arange(10) * np.pi / 5, np.zeros(10)), axis=1)
    T = repair.triangulate(V, [list(range(10))])
    a, b, c = np.moveaxis(V[T], 1, 0)
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert len(T) == 8 and (areas > 0).all()
    assert np.isclose(areas.sum(), 10 * 0.5 * 3 * np.sin(np.pi / 5))
    with pytest.raises(ValueError, match="sides that cross"):
        repair.triangulate(np.outer(range(5), [1.0, 1, 1]), [[0, 2, 4, 3, 1]])
    V = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 2, 0], [1, 2, 0], [0, 2, 0.0]])
    for turn in range(8):
        c, s = np.cos(turn), np.sin(turn)
        W = V @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        a, b, c = np.moveaxis(W[repair.triangulate(W, [[0, 1, 2, 3, 4, 5]])], 1, 0)
        assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 0.5


@pytest.mark.parametrize("sides", [5, 6, 8, 12])
def test_ears_of_equal_length_are_cut_in_order(sides):
    V = np.stack(polar(1, TAU * np.arange(sides) / sides, np.zeros(sides)), axis=1)
    cuts = [
        repair.triangulate(V * (1 + 1e-13 * noise), [list(range(sides))])
        for noise in np.random.default_rng(0).standard_normal((4, *V.shape))
    ]
    assert all(np.array_equal(T, cuts[0]) for T in cuts)


def test_a_net_that_was_cut_open_keeps_its_duplicates_and_says_so():
    V, Q = sheet(8, 6, lambda u, v: polar(3 + np.cos(TAU * v), TAU * u, np.sin(TAU * v)))
    W, R, _, said = repair.welded(V, Q)
    assert W is V and R is Q
    assert said == ["duplicate vertices were not merged: a cut would be closed"]
    V, Q = sheet(8, 6, lambda u, v: polar(1, TAU * u, v))  # a tube: one seam
    W, R, _, said = repair.welded(V, Q)
    assert len(W) < len(V) and len(mesh.boundary_loops(R)) == 2 and "merged: 7" in said[0]


def test_a_closed_net_without_duplicates_is_left_alone():
    net = loxodrome.torus_web(3, 1, 12, 6, 1)
    V, Q, polygons, said = repair.welded(net.V, net.Q)
    assert V is net.V and Q is net.Q and not polygons and said == []
