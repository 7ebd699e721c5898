"""`mesh` against dictionaries, hand-numbered grids and plane geometry."""

import re
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inetlib import measure, mesh

sizes, seeds = st.integers(1, 6), st.integers(0, 2**32 - 1)


def number(i, j, n):
    return i * (n + 1) + j


def slow_grid(m, n):
    """v1 top left, then counter-clockwise, one face at a time."""
    cells = [(i, j) for i in range(m) for j in range(n)]
    corners = [(0, 1), (0, 0), (1, 0), (1, 1)]
    return np.array([[number(i + a, j + b, n) for a, b in corners] for i, j in cells])


def positions(m, n):
    """Vertex (i, j) at the point (i, j, 0)."""
    return np.array([[i, j, 0.0] for i in range(m + 1) for j in range(n + 1)])


def bumpy(m, n):
    """Positions of a grid of random spatial quads."""
    return positions(m, n) + np.random.default_rng(5).uniform(-0.3, 0.3, ((m + 1) * (n + 1), 3))


def rolled(m, n, both=False):
    """A grid closed along u (an annulus), or along u and v too (a torus)."""
    i, j = np.divmod(slow_grid(m, n), n + 1)
    return i % m * (n if both else n + 1) + (j % n if both else j)


def annulus_positions(m, n):
    """Counter-clockwise faces need u clockwise when v points outwards."""
    i, j = np.divmod(np.arange(m * (n + 1)), n + 1)
    z = (1 + j) * np.exp(-2j * np.pi * i / m)
    return np.stack([z.real, z.imag, 0 * j], axis=1)


def star(valence):
    """Quads around the vertex 0, spokes 1 ... valence, then the outer corners."""
    spokes = 1 + np.arange(valence)
    return np.stack([0 * spokes, spokes, spokes + valence, np.roll(spokes, -1)], axis=1)


def star_positions(valence):
    turn = np.exp(2j * np.pi * np.arange(valence) / valence)
    z = np.concatenate([[0], turn, turn + np.roll(turn, -1)])
    return np.stack([z.real, z.imag, 0 * z.real], axis=1)


def moebius_strip(k):
    """k quads in a ring, the last glued to the first upside down."""
    faces = [[2 * i + 1, 2 * i, 2 * i + 2, 2 * i + 3] for i in range(k)]
    faces[-1][2:] = [1, 0]
    return np.array(faces)


def quarter_turn_handle():
    """A 4 x 4 grid with two crossing bands, each from the right side to the top side.

    All interior valences are 4 and the one boundary loop is even: only the bands, which
    glue v-edges to u-edges, forbid the labels."""
    faces = slow_grid(4, 4).tolist()
    ends = [((4, 0), (4, 1), (3, 4), (2, 4)), ((4, 2), (4, 3), (1, 4), (0, 4))]
    for k, corners in enumerate(ends):
        a, b, c, d = (number(i, j, 4) for i, j in corners)
        x, y = 25 + 2 * k, 26 + 2 * k
        faces += [[b, a, x, y], [y, x, d, c]]
    return np.array(faces)


def two_cubes():
    """Two closed cubes that share the vertex 0."""
    cube = np.array(
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    )
    return np.concatenate([cube, np.where(cube == 0, 0, cube + 7)])


MESHES = {
    "grid": slow_grid(3, 4),
    "one quad": slow_grid(1, 1),
    "annulus": rolled(5, 2),
    "torus": rolled(4, 3, both=True),
    "star": star(5),
    "cubes": two_cubes(),
    "handle": quarter_turn_handle(),
}


def half_edges(Q):
    """{(start, end): number} of all faces, by a plain loop."""
    return {
        (int(face[k]), int(face[(k + 1) % 4])): 4 * f + k
        for f, face in enumerate(Q)
        for k in range(4)
    }


def edges(Q, slots):
    """Undirected edges at the given slots of the faces."""
    return {frozenset(pair) for pair, h in half_edges(Q).items() if h % 4 in slots}


def diagonals(Q, k):
    return {frozenset(pair) for pair in Q[:, k::2].tolist()}


def boundary_edges(Q):
    table = half_edges(Q)
    return {(a, b) for a, b in table if (b, a) not in table}


def labels_agree(Q):
    """No edge is a v-edge (slots 0, 2) of one face and a u-edge (slots 1, 3) of another."""
    return not edges(Q, (0, 2)) & edges(Q, (1, 3))


def shuffled(Q, rng, flips=True):
    """The same faces with other first corners, some of them turned over."""
    turned = [np.roll(face, k) for face, k in zip(Q, rng.integers(0, 4, len(Q)), strict=True)]
    over = rng.integers(0, 2, len(Q)) * flips
    return np.array([face[::-1] if o else face for face, o in zip(turned, over, strict=True)])


def signed_area(points):
    x, y = np.asarray(points)[..., 0], np.asarray(points)[..., 1]
    after_x, after_y = np.roll(x, -1, axis=-1), np.roll(y, -1, axis=-1)
    return (x * after_y - y * after_x).sum(axis=-1) / 2


def as_curves(lines):
    """Open curves as a set of tuples, blind to their direction."""
    return {min(tuple(line), tuple(line[::-1])) for line in (list(map(int, x)) for x in lines)}


@given(sizes, sizes)
def test_grid_quads_are_those_of_a_plain_loop(m, n):
    Q = mesh.grid_quads(float(m), n)
    assert Q.dtype == np.int64
    np.testing.assert_array_equal(Q, slow_grid(m, n))
    np.testing.assert_array_equal(signed_area(positions(m, n)[Q]), 1)


@pytest.mark.parametrize("sides", [3, 4, 5, 6, 7])
def test_ring_k_around_the_polygon_has_two_sides_k_quads(sides):
    V, Q, polygon = mesh.polygon_rings(sides, 4)
    inside, rest = set(polygon.tolist()), Q
    for ring in range(1, 5):
        touching = np.array([bool(inside & set(face.tolist())) for face in rest])
        assert touching.sum() == 2 * sides * ring
        inside |= set(rest[touching].ravel().tolist())
        rest = rest[~touching]
    assert len(rest) == 0
    assert len(V) == len(inside)
    assert mesh.is_labelled(Q) == labels_agree(Q) == (sides % 2 == 0)


def test_the_hexagon_mesh_is_convex_with_inner_valences_four_and_four_sides_give_a_lattice():
    V, Q, polygon = mesh.polygon_rings(6, 8)
    assert (V.shape, Q.shape) == ((486, 3), (432, 4))
    assert len(set(polygon.tolist())) == 6 and set(Q.ravel()) == set(range(486))
    valence = np.bincount([k for pair in edges(Q, (0, 1, 2, 3)) for k in pair])
    inner = set(range(486)) - {a for a, _ in boundary_edges(Q)}
    assert {int(valence[k]) for k in [*inner, *polygon]} == {4}
    assert len(inner) == 486 - 6 - (12 * 8 + 6)
    for k in range(4):  # every corner turns left: convex too
        assert (signed_area(np.roll(V[Q], k, axis=1)[:, :3]) > 0).all()
    assert signed_area(V[polygon]) > 0
    np.testing.assert_allclose(np.ptp(np.linalg.norm(V[polygon], axis=1)), 0, atol=1e-15)
    assert (V[:, 2] == 0).all()
    V, Q, polygon = mesh.polygon_rings(4, 2)
    found = sorted(map(tuple, np.round(V[:, :2], 12).tolist()))
    lattice = np.arange(-2.5, 3)
    assert found == sorted((x, y) for x in lattice for y in lattice)
    np.testing.assert_allclose(signed_area(V[Q]), 1)
    np.testing.assert_allclose(signed_area(V[polygon]), 1)


@pytest.mark.parametrize(
    ("make", "size"),
    [(mesh.grid_quads, size) for size in ((0, 1), (1, 0), (-2, 3), (float("nan"), 1), (2.5, 1))]
    + [(mesh.polygon_rings, size) for size in ((2, 1), (6, 0), (-1, 3))],
)
def test_sizes_that_make_no_mesh_are_refused(make, size):
    with pytest.raises(ValueError, match=r"(m|n|sides|rings) = \S+: a whole number, [13] or"):
        make(*size)


PLANE, GRID = positions(2, 2), slow_grid(2, 2)
HOLE = np.where(np.arange(9) == 5, np.nan, 0)[:, None]
FLAPS = [[0, 1, 2, 3], [1, 0, 4, 5], [0, 1, 6, 7]]
OVER = np.concatenate([GRID[:2], GRID[2:3, ::-1], GRID[3:]])
BAD = {
    "an empty list": (PLANE, [], "the mesh has no faces"),
    "triangles": (PLANE, GRID[:, :3], "the faces are triangles: quads are wanted"),
    "pentagons": (PLANE, [[0, 1, 2, 3, 4]], r"faces of shape \(1, 5\)"),
    "one flat list": (PLANE, GRID.ravel(), r"faces of shape \(16,\)"),
    "floats": (PLANE, GRID.astype(float), "of type float64: integers are wanted"),
    "booleans": (PLANE, GRID > 3, "of type bool: integers are wanted"),
    "a negative index": (PLANE, GRID - 1, "face 0 names vertex -1: counting starts at 0"),
    "counting from one": (PLANE, GRID + 1, "face 3 names vertex 9: .* only 9 vertices"),
    "a vertex twice": (PLANE, [[0, 1, 2, 3], [4, 5, 6, 5]], "face 4-5-6-5 uses a vertex twice"),
    "NaN": (PLANE + HOLE, GRID, "vertex 5 has a coordinate that is not a finite number"),
    "plane vertices": (PLANE[:, :2], GRID, r"V has the shape \(9, 2\)"),
    "complex vertices": (PLANE * 1j, GRID, "type complex128: .* three real coordinates"),
    "words": (PLANE.astype(str), GRID, "three real coordinates"),
    "three faces at an edge": (PLANE, FLAPS, "edge 0-1 belongs to more than two faces"),
    "a face upside down": (
        PLANE,
        OVER,
        "the edge (3-4|4-3|4-7|7-4) are oriented against each other",
    ),
    "a face twice": (PLANE, np.concatenate([GRID, GRID[:1]]), "more than two|against"),
}


@pytest.mark.parametrize("what", BAD)
def test_check_says_what_is_wrong_with(what):
    V, Q, words = BAD[what]
    with pytest.raises(ValueError, match=words):
        mesh.check(V, Q)


def test_check_returns_float64_and_int64_and_takes_lists():
    V, Q = mesh.check(PLANE.astype(int).tolist(), GRID.astype(np.uint8).tolist())
    assert (V.dtype, Q.dtype) == (np.float64, np.int64)
    np.testing.assert_array_equal(V, PLANE)
    np.testing.assert_array_equal(Q, GRID)
    turned = np.concatenate([GRID[:1, ::-1], GRID[1:]]).astype(np.uint8)
    found = mesh.check_arrays(PLANE, turned)[1]  # does not mind the orientation
    assert found.dtype == np.int64 and (found == turned).all()


def slow_twins(Q):
    table = half_edges(Q)
    return [table.get((b, a), -1) for a, b in table]


@pytest.mark.parametrize("name", MESHES)
def test_twins_and_neighbours_are_those_of_a_dictionary(name):
    Q = MESHES[name]
    wanted = np.array(slow_twins(Q))
    np.testing.assert_array_equal(mesh.twins(Q), wanted)
    faces = [[h // 4 if h >= 0 else -1 for h in row] for row in wanted.reshape(-1, 4).tolist()]
    np.testing.assert_array_equal(mesh.face_neighbours(Q), faces)


@given(st.sets(st.integers(0, 35), min_size=1), seeds)
def test_twins_of_any_shuffled_part_of_a_grid_are_those_of_a_dictionary(part, seed):
    rng = np.random.default_rng(seed)
    Q = shuffled(slow_grid(6, 6)[rng.permutation(sorted(part))], rng, flips=False)
    np.testing.assert_array_equal(mesh.twins(Q), slow_twins(Q))


def test_boundary_loops_run_once_through_the_boundary_the_mesh_on_their_left_and_never_touch():
    for name, count in (("grid", 1), ("annulus", 2), ("star", 1), ("torus", 0)):
        loops = [loop.tolist() for loop in mesh.boundary_loops(MESHES[name])]
        pairs = [pair for loop in loops for pair in pairwise([*loop, loop[0]])]
        assert len(loops) == count and len(pairs) == len(set(pairs))
        assert set(pairs) == boundary_edges(MESHES[name])
    (loop,) = mesh.boundary_loops(slow_grid(3, 4))
    assert signed_area(positions(3, 4)[loop]) == 12
    V = annulus_positions(9, 2)
    assert (signed_area(V[rolled(9, 2)]) > 0).all()
    inner, outer = sorted(mesh.boundary_loops(rolled(9, 2)), key=lambda loop: V[loop].max())
    assert signed_area(V[inner]) < 0 < signed_area(V[outer])
    loops = mesh.boundary_loops(np.delete(slow_grid(3, 3), 4, axis=0))
    assert sorted(signed_area(positions(3, 3)[loop]) for loop in loops) == [-1, 9]
    with pytest.raises(ValueError, match="two boundary loops touch at vertex 4"):
        mesh.boundary_loops(slow_grid(2, 2)[[0, 3]])


def test_is_labelled_sees_one_quarter_turn_and_ignores_half_turns():
    Q = slow_grid(3, 3)
    for quarters, wanted in ((0, True), (2, True), (1, False)):
        Q[4] = np.roll(Q[4], quarters)
        assert mesh.is_labelled(Q) == wanted
    assert mesh.is_labelled([[0, 1, 2, 3], [5, 4, 7, 6]])
    with pytest.raises(ValueError, match="oriented against each other"):
        mesh.is_labelled([[1, 0, 2, 3], [2, 3, 5, 4]])


@given(seeds, sizes, sizes)
def test_label_puts_a_shuffled_grid_in_order(seed, m, n):
    rng = np.random.default_rng(seed)
    turned = shuffled(slow_grid(m, n), rng, flips=False)
    assert mesh.is_labelled(turned) == labels_agree(turned)
    Q = shuffled(slow_grid(m, n), rng)[rng.permutation(m * n)]
    before = Q.copy()
    done = mesh.label(Q)
    np.testing.assert_array_equal(Q, before)
    np.testing.assert_array_equal(done[0], Q[0])
    np.testing.assert_array_equal(np.sort(done, axis=1), np.sort(Q, axis=1))
    assert labels_agree(done)
    assert len(half_edges(done)) == 4 * m * n  # no directed edge twice: oriented alike
    areas = signed_area(positions(m, n)[done])
    assert (areas == areas[0]).all()


TWO_PARTS = np.concatenate([slow_grid(2, 2), np.roll(slow_grid(2, 2), 1, axis=1) + 9])


@pytest.mark.parametrize(
    ("Q", "parts"),
    [(TWO_PARTS, [0, 4]), (MESHES["annulus"], [0]), (MESHES["torus"], [0]), (star(6), [0])]
    + [(mesh.polygon_rings(sides, 3)[1], [0]) for sides in (4, 8)],
)
def test_label_puts_other_meshes_in_order_and_keeps_the_first_face_of_each_part(Q, parts):
    Q = shuffled(Q, np.random.default_rng(3))
    done = mesh.label(Q)
    np.testing.assert_array_equal(done[parts], Q[parts])
    assert labels_agree(done)
    assert len(half_edges(done)) == done.size


@pytest.mark.parametrize("k", [3, 5, 7])
def test_label_refuses_and_names_odd_polygons_odd_inner_vertices_and_moebius_strips(k):
    _, Q, polygon = mesh.polygon_rings(k, 2)
    words = r"boundary loop through the vertices ([\d-]+\d)(-\.\.\.)? has an odd sum"
    with pytest.raises(ValueError, match=words) as caught:
        mesh.label(Q)
    assert set(caught.value.vertices) == set(polygon)
    assert re.search(words, str(caught.value))[1].count("-") == min(k, 6) - 1
    centre = 11 % (2 * k + 1)  # another number than 0
    with pytest.raises(ValueError, match=f"interior vertex {centre} has the odd valence {k}"):
        mesh.label((star(k) + 11) % (2 * k + 1))
    for faces in (k, k + 1):
        Q = moebius_strip(faces)
        with pytest.raises(ValueError, match="not orientable: see the loop of faces") as caught:
            mesh.label(Q)
        assert sorted(caught.value.vertices) == sorted(Q[:, 0])


def test_label_refuses_a_handle_that_glues_u_to_v_and_names_a_loop_of_faces():
    Q = quarter_turn_handle()
    assert len(mesh.boundary_loops(Q)) == 1
    with pytest.raises(ValueError, match="u and v change places along the closed loop") as caught:
        mesh.label(Q)
    loop = [Q[:, 0].tolist().index(k) for k in caught.value.vertices]
    assert len(np.unique(Q[loop, 0])) == len(loop) and (np.bincount(Q[:, 0])[Q[loop, 0]] == 1).all()
    twin = np.array(slow_twins(Q)).reshape(-1, 4)
    turns = 0
    for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
        ((slot,),) = np.nonzero(twin[a] // 4 == b)
        turns += slot + twin[a, slot]
    assert turns % 2 == 1  # an odd number of quarter turns: the named loop is to blame


@given(sizes, sizes)
def test_polylines_of_a_grid_are_its_rows_columns_and_diagonals(m, n):
    found = mesh.polylines(slow_grid(m, n))
    rows = [[number(i, j, n) for i in range(m + 1)] for j in range(n + 1)]
    columns = [[number(i, j, n) for j in range(n + 1)] for i in range(m + 1)]
    inside = [(i, j) for i in range(m + 1) for j in range(n + 1)]
    rising = [[number(i, j, n) for i, j in inside if i - j == c] for c in range(-n + 1, m)]
    falling = [[number(i, j, n) for i, j in inside if i + j == c] for c in range(1, m + n)]
    for lines, wanted in zip(found, (rows, columns, falling, rising), strict=True):
        assert len(lines) == len(wanted)
        assert as_curves(lines) == as_curves(wanted)


def test_curves_run_once_through_every_edge_close_on_a_torus_and_end_at_singular_vertices():
    for name in ("grid", "annulus", "torus"):
        Q = MESHES[name]
        wanted = edges(Q, (1, 3)), edges(Q, (0, 2)), diagonals(Q, 0), diagonals(Q, 1)
        for lines, pairs in zip(mesh.polylines(Q), wanted, strict=True):
            steps = [frozenset(map(int, step)) for line in lines for step in pairwise(line)]
            assert len(steps) == len(pairs) and set(steps) == pairs
    for m, n in ((3, 3), (4, 6), (5, 3)):
        found = mesh.polylines(rolled(m, n, both=True))
        assert [len(lines) for lines in found] == [n, m, np.gcd(m, n), np.gcd(m, n)]
        for lines, length in zip(found, (m, n, np.lcm(m, n), np.lcm(m, n)), strict=True):
            assert {(len(line) - 1, line[0] == line[-1]) for line in lines} == {(length, True)}
    for centre in (0, 5, 12):
        found = mesh.polylines(mesh.label((star(6) + centre) % 13))
        for lines in (found.u, found.v):
            ends = [line for line in lines if centre in line]
            assert len(ends) == 3
            assert all(centre in (line[0], line[-1]) for line in ends)


def test_black_faces_of_spatial_quads_are_parallelograms_along_the_diagonals():
    V, Q = bumpy(4, 3), slow_grid(4, 3)
    board = mesh.checkerboard(V, Q)
    middles = (V[Q] + V[np.roll(Q, -1, axis=1)]) / 2
    np.testing.assert_allclose(board.V[board.black], middles, atol=1e-15)
    p1, p2, p3, p4 = np.moveaxis(middles, 1, 0)
    np.testing.assert_allclose(p2 - p1, p3 - p4, atol=1e-15)
    np.testing.assert_allclose(p2 - p1, (V[Q[:, 2]] - V[Q[:, 0]]) / 2, atol=1e-15)


def test_white_faces_surround_the_inner_vertices_and_no_two_black_ones_share_an_edge():
    m, n = 4, 3
    board = mesh.checkerboard(positions(m, n), slow_grid(m, n))
    corners = board.V[board.white]
    assert board.white.shape == ((m - 1) * (n - 1), 4)
    np.testing.assert_allclose(signed_area(corners), 0.5)
    centres = sorted(map(tuple, corners.mean(axis=1)[:, :2].tolist()))
    assert centres == [(i, j) for i in range(1, m) for j in range(1, n)]
    assert board.others == []
    midpoints = {tuple(p) for p in board.V.tolist()}
    assert len(board.V) == len(midpoints) == m * (n + 1) + n * (m + 1)
    assert set(board.black.ravel()) == set(range(len(board.V)))
    assert len(boundary_edges(board.black)) == 4 * m * n
    assert {(b, a) for a, b in half_edges(board.white)} <= set(half_edges(board.black))


def test_singular_vertices_get_polygons_and_closed_surfaces_one_white_face_a_vertex():
    for valence in (3, 5, 6):
        V, Q = star_positions(valence), star(valence)
        board = mesh.checkerboard(V, shuffled(Q, np.random.default_rng(1), flips=False))
        (polygon,) = board.others
        assert board.white.shape == (0, 4)
        found, wanted = board.V[polygon] @ [1, 1j, 0], V[1 : valence + 1] @ [0.5, 0.5j, 0]
        assert len(found) == valence
        np.testing.assert_allclose(np.abs(found[:, None] - wanted).min(axis=0), 0, atol=1e-12)
        assert signed_area(board.V[polygon]) > 0
    V = np.random.default_rng(7).normal(size=(15, 3))
    board = mesh.checkerboard(V, rolled(4, 3, both=True))
    assert (len(board.black), len(board.white), len(board.V)) == (12, 12, 24)
    with pytest.raises(ValueError, match="faces at vertex 0 form two fans"):
        mesh.checkerboard(V, two_cubes())


@pytest.mark.parametrize("both", [False, True])
def test_triples_are_the_neighbours_along_the_lines_of_a_closed_grid(both):
    m, n = 5, 4
    wide = n if both else n + 1
    wanted = set()
    for i, j in np.ndindex(m, wide):
        lines = [((i - 1) % m, j, (i + 1) % m, j)]  # along u, and along v where it goes on
        lines += [(i, (j - 1) % wide, i, (j + 1) % wide)] if both or 0 < j < n else []
        wanted |= {(frozenset([a * wide + b, c * wide + d]), i * wide + j) for a, b, c, d in lines}
    found = mesh.triples(rolled(m, n, both))
    assert len(found) == len(wanted)
    assert {(frozenset([a, c]), b) for a, b, c in found.tolist()} == wanted


def test_edges_of_diagonal_meshes_are_face_diagonals_and_need_labels_and_a_colouring():
    for Q in (slow_grid(5, 4), rolled(6, 3), rolled(4, 6, both=True)):
        for found in mesh.diagonal_meshes(Q):
            assert len(found) > 2
            assert edges(found, (1, 3)) <= diagonals(Q, 0)
            assert edges(found, (0, 2)) <= diagonals(Q, 1)
            assert mesh.is_labelled(found)
    assert [D.shape for D in mesh.diagonal_meshes(slow_grid(1, 1))] == [(0, 4), (0, 4)]
    for function in (mesh.polylines, mesh.diagonal_meshes):
        with pytest.raises(ValueError, match=r"do not agree on u and v: call mesh\.label"):
            function(mesh.polygon_rings(5, 1)[1])
    with pytest.raises(ValueError, match=r"no chessboard colouring: see the odd loop \[\d"):
        mesh.diagonal_meshes(rolled(3, 4, both=True))


@given(st.integers(2, 6), st.integers(2, 6))
def test_diagonal_meshes_of_a_grid_split_it_like_a_chessboard(m, n):
    Qa, Qb = mesh.diagonal_meshes(slow_grid(m, n))
    V = positions(m, n)
    colour = V[:, :2].sum(axis=1) % 2
    inner = [(i + j) % 2 for i in range(1, m) for j in range(1, n)]
    first = colour[slow_grid(m, n)[0, 0]]
    assert len(Qa) == sum(c != first for c in inner)
    assert len(Qb) == sum(c == first for c in inner)
    assert (colour[Qa] == first).all()
    assert (colour[Qb] != first).all()
    for D in (Qa, Qb):
        np.testing.assert_allclose(signed_area(V[D]), 2)
        along_u = V[D[:, 2]] - V[D[:, 1]]
        np.testing.assert_allclose(np.abs(along_u @ [1, -1, 0]), 2)  # parallel to d1 = (1, -1)


def test_diagonal_meshes_of_a_sheared_grid_have_the_swapped_shape():
    """Y_u = X_u - X_v, Y_v = X_u + X_v: its medial lines meet at theta, and its diagonals
    Y_u - Y_v = -2 X_v and Y_u + Y_v = 2 X_u at pi - theta0, in the ratio |X_u| / |X_v|."""
    u, v = np.array([1.3, 0.2, 0]), np.array([0.4, 0.7, 0])
    V = positions(6, 5)[:, :1] * u + positions(6, 5)[:, 1:2] * v
    theta = np.arccos((u - v) @ (u + v) / np.linalg.norm(u - v) / np.linalg.norm(u + v))
    theta0 = np.arccos(u @ v / np.linalg.norm(u) / np.linalg.norm(v))
    lam, mu = np.linalg.norm(u + v) / np.linalg.norm(u - v), np.linalg.norm(u) / np.linalg.norm(v)
    for D in mesh.diagonal_meshes(slow_grid(6, 5)):
        for found, wanted in zip(measure.angles(V, D), (np.pi - theta0, theta), strict=True):
            np.testing.assert_allclose(found, wanted, rtol=1e-13)
        for found, wanted in zip(measure.ratios(V, D), (mu, 1 / lam), strict=True):
            np.testing.assert_allclose(found, wanted, rtol=1e-13)


def test_quads_are_cut_along_the_shorter_diagonal_triangles_kept_and_other_faces_refused():
    V, Q = bumpy(5, 4) * [1, 1, 0], slow_grid(5, 4)
    for shift in range(4):
        Q = np.roll(Q, shift, axis=1)
        W, T = mesh.triangles(V, Q)
        np.testing.assert_array_equal(W, V)
        assert T.shape == (40, 3)
        np.testing.assert_allclose(signed_area(V[T]).reshape(-1, 2).sum(axis=1), signed_area(V[Q]))
        for quad, pair in zip(Q, T.reshape(-1, 2, 3).tolist(), strict=True):
            ends = sorted((quad[::2], quad[1::2]), key=lambda k: np.linalg.norm(V[k[1]] - V[k[0]]))
            assert set(pair[0]) & set(pair[1]) == set(ends[0].tolist())
    np.testing.assert_array_equal(mesh.triangles(positions(1, 1), [[0, 2, 1]])[1], [[0, 2, 1]])
    for faces, words in [
        ([[0, 1, 2, 3, 4]], r"shape \(1, 5\): rows of three or four vertices"),
        ([[0, 1, 4]], "face 0 names vertex 4: there are only 4 vertices"),
        ([[0, 1, 1]], "face 0-1-1 uses a vertex twice"),
    ]:
        with pytest.raises(ValueError, match=words):
            mesh.triangles(positions(1, 1), faces)


RING = annulus_positions(36, 1), rolled(36, 1)


@pytest.mark.parametrize(("net", "count"), [(mesh.polygon_rings(6, 8)[:2], 48), (RING, 36)])
def test_equal_diagonals_are_cut_along_v1_v3_whatever_their_last_digits_are(net, count):
    V, Q = net
    d1, d2 = (np.linalg.norm(V[Q[:, k + 2]] - V[Q[:, k]], axis=1) for k in (0, 1))
    ties = np.isclose(d1, d2, rtol=1e-12)
    assert ties.sum() == count  # for the hexagon the quads on its axes
    wanted = mesh.triangles(V, Q)[1]
    np.testing.assert_array_equal(wanted[::2][ties], Q[ties][:, :3])
    for seed in range(5):
        noise = 1 + 1e-13 * np.random.default_rng(seed).standard_normal(V.shape)
        np.testing.assert_array_equal(mesh.triangles(V * noise, Q)[1], wanted)
