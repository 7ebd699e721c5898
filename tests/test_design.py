"""Nets over surfaces: closed forms of the map, angles and distances by other means, bad input."""

from pathlib import Path

import igl
import numpy as np
import pytest

from inetlib import design, examples, measure, mesh, repair, solver
from inetlib.design import flatten, overlay, report

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
PAIRS = [(60, 60), (90, 90), (70, 50)]
EXACT = 1e-6  # degrees


def sheet(n, m, point):
    """A mesh of n by m quads of the points (x, y, z) = point(u, v), 0 <= u, v <= 1."""
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    V = np.stack(np.broadcast_arrays(*point(u, v)), axis=-1).reshape(-1, 3).astype(float)
    return V, mesh.grid_quads(n, m)


def plate(n=6):
    return mesh.triangles(*sheet(n, n, lambda u, v: (2 * u, v, 0 * u)))


def torus(n=8):
    i, j = np.divmod(mesh.grid_quads(n, n), n + 1)
    u, v = 2 * np.pi * np.divmod(np.arange(n * n), n)[0] / n, 2 * np.pi * (np.arange(n * n) % n) / n
    r = 3 + np.cos(v)
    V = np.stack([r * np.cos(u), r * np.sin(u), np.sin(v)], axis=1)
    return mesh.triangles(V, n * (i % n) + j % n)


def moebius(n=12):
    t = 2 * np.pi * np.arange(n) / n
    rows = []
    for w in (-0.3, 0.3):
        r = 1 + w * np.cos(t / 2)
        rows.append(np.stack([r * np.cos(t), r * np.sin(t), w * np.sin(t / 2)], axis=1))
    k = np.arange(n)
    Q = np.stack([k, k + n, (k + 1) % n + n, (k + 1) % n], axis=1)
    Q[-1] = [n - 1, 2 * n - 1, 0, n]  # the strip closes with a half turn
    return np.concatenate(rows), Q


def cover(surface, pair, **options):
    return design.cover(*surface, *np.radians(pair), **options)


def check_cover(net, surface, pair, tolerance=EXACT):
    """Angles by arithmetic of complex planes, distances by libigl: nothing from the report."""
    V, Q = net.V, net.Q
    d1, d2 = V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]]
    for (a, b), wanted in zip(((d1, d2), (d1 + d2, d2 - d1)), np.radians(pair), strict=True):
        a, b = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (a, b))
        found = 2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))
        assert np.degrees(np.abs(found - wanted)).max() < tolerance
    W, F = mesh.triangles(*surface)
    squares, _, _ = igl.point_mesh_squared_distance(V, W, F)
    away = np.sqrt(squares) / np.linalg.norm(np.ptp(W, axis=0))
    assert away.mean() < 1e-3
    assert away.max() < 1e-2
    assert away.max() == pytest.approx(net.report.distance_max, abs=1e-9)
    assert measure.quality(V, Q).flips == net.report.flips == 0
    assert mesh.is_labelled(Q)
    assert net.report.converged


# --- disks ----------------------------------------------------------------------------------


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("make", [examples.wavy_roof, examples.hanging_shell])
def test_own_surfaces_are_covered(make, pair):
    surface = make(20)
    net = cover(surface, pair, count=300)
    check_cover(net, surface, pair)
    assert len(net.Q) == net.report.quads == pytest.approx(300, rel=0.03)
    assert len(mesh.boundary_loops(net.Q)) == 1
    assert 0.7 < net.report.covered < 1
    assert net.report.back_max < 5e-3
    assert net.report.seconds.keys() == {"check", "flatten", "grid", "optimise", "report"}


@pytest.mark.parametrize("name", ["lilium", "snail"])
@pytest.mark.parametrize("pair", PAIRS)
def test_surfaces_that_nobody_here_made(name, pair):
    if not (DATA / f"{name}.obj").exists():
        pytest.skip("the data folder is not here")
    surface = igl.readOBJ(str(DATA / f"{name}.obj"))
    surface = surface[0], surface[3].astype(np.int64)
    net = cover(surface, pair)
    check_cover(net, surface, pair)
    assert net.report.quads == pytest.approx(1500, rel=0.02)


def test_five_thousand_quads():
    if not (DATA / "lilium.obj").exists():
        pytest.skip("the data folder is not here")
    surface = igl.readOBJ(str(DATA / "lilium.obj"))
    net = cover((surface[0], surface[3].astype(np.int64)), (60, 60), count=5000)
    check_cover(net, (surface[0], surface[3].astype(np.int64)), (60, 60))
    assert net.report.quads == pytest.approx(5000, rel=0.02)


def test_the_plane_is_covered_by_the_sheared_grid_itself():
    surface = sheet(12, 4, lambda u, v: (3 * u, v, 0 * u))
    net = cover(surface, (70, 50), size=0.1, direction=0.3, optimise=False)
    along = net.V[net.Q[:, 2]] - net.V[net.Q[:, 1]]  # v3 - v2, the u-edges
    turned = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    np.testing.assert_allclose(turned, 0.3, atol=1e-6)
    found = measure.angles(net.V, net.Q)
    np.testing.assert_allclose(found, np.radians([[70], [50]]) + 0 * found[0], atol=1e-6)
    assert net.report.edge_mean == pytest.approx(0.1, rel=0.02)
    assert net.report.size_ratio == pytest.approx(1, abs=1e-6)
    assert net.report.distortion_max == pytest.approx(1, abs=1e-6)
    assert not net.report.converged
    assert net.report.message == "not optimised"


def test_every_quad_is_inside_the_outline():
    disk = 0.999 * np.exp(2j * np.pi * np.arange(60) / 60)
    V = np.stack([disk.real, disk.imag, 0 * disk.real], axis=1)
    V = np.concatenate([V, np.zeros((1, 3))])
    F = np.stack([np.arange(60), np.roll(np.arange(60), -1), np.full(60, 60)], axis=1)
    net = cover((V, F), (60, 60), count=200)
    assert np.linalg.norm(net.V, axis=1).max() < 1
    assert net.report.covered > 0.8


def test_two_rooms_with_a_narrow_door_give_one_sound_piece():
    def point(u, v):
        x = 4 * u - 2
        return x, (v - 0.5) * (0.06 + np.abs(x) ** 2), 0 * u

    net = cover(sheet(60, 10, point), (60, 60), count=150)
    one, two = mesh.pairs(net.Q).T // 4
    assert len(np.unique(np.concatenate([one, two]))) == len(net.Q)
    assert len(mesh.boundary_loops(net.Q)) == 1  # raises where two quads touch at a vertex


def test_quads_as_reference_and_large_coordinates():
    V, Q = sheet(15, 15, lambda u, v: (u, v, 0.3 * u * v))
    V = 1e4 * V + 1e5
    check_cover(cover((V, Q), (60, 45), count=100), (V, Q), (60, 45))


def test_one_quad_and_extreme_angles():
    surface = examples.wavy_roof(20)
    assert cover(surface, (60, 60), count=1).report.quads == 1
    for pair in ((150, 120), (35, 100)):
        check_cover(cover(surface, pair, count=300), surface, pair)


def steep_bump():
    def point(u, v):
        return u, v, 0.8 * np.exp(-30 * ((u - 0.5) ** 2 + (v - 0.5) ** 2))

    return sheet(40, 40, point)


def test_a_steep_bump_is_covered_after_steps_of_shape():
    net = cover(steep_bump(), (60, 60), count=800)
    check_cover(net, steep_bump(), (60, 60))
    assert net.report.size_ratio > 5


def test_a_net_off_the_surface_says_so(monkeypatch):
    monkeypatch.setattr(design, "ATTEMPTS", design.ATTEMPTS[-2:])
    report = cover(steep_bump(), (60, 60), count=150).report
    assert report.converged
    assert report.distance_max > 0.01
    assert "% of the diagonal off the surface: ask for more quads" in report.message


def test_a_folded_net_is_no_cover(monkeypatch):
    monkeypatch.setattr(design, "GROWN", 1.0)  # now every net is taken for a folded one
    report = cover(examples.wavy_roof(10), (60, 60), count=50).report
    assert not report.converged
    assert report.message.startswith("the net has folded or collapsed; converged")


def test_a_net_that_does_not_converge_is_returned_and_says_so(monkeypatch):
    real = solver.optimize

    def lazy(*arguments, **options):
        return real(*arguments, **(options | {"iterations": 0}))

    monkeypatch.setattr(solver, "optimize", lazy)
    report = cover(examples.wavy_roof(10), (60, 60), count=50).report
    assert not report.converged
    assert report.max_deviation > 1e-4
    assert report.message.startswith("not converged")


# --- rings ----------------------------------------------------------------------------------


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("direction", [0.0, 0.5])
def test_a_saddle_with_a_hole_is_covered_by_a_closed_net(pair, direction):
    surface = examples.saddle_with_hole(12)
    net = cover(surface, pair, count=300, direction=direction)
    check_cover(net, surface, pair)
    edges = len(mesh.pairs(net.Q)) + np.sum(mesh.twins(net.Q) < 0)
    assert len(mesh.boundary_loops(net.Q)) == 2
    assert len(net.V) - edges + len(net.Q) == 0
    assert (net.report.winding[1] == 0) == (direction == 0)


def test_the_u_lines_close_after_the_winding():
    net = cover(examples.saddle_with_hole(12), (90, 90), count=300)
    closed = [line for line in mesh.polylines(net.Q).u if line[0] == line[-1]]
    assert {len(line) - 1 for line in closed} == {abs(net.report.winding[0])}


@pytest.mark.parametrize("boundary", ["even", "plain"])
def test_a_flat_ring_is_mapped_by_the_logarithm(boundary):
    V, F = examples.saddle_with_hole(20)
    V[:, 2] = 0
    surface = repair.clean(V, F)
    flat = flatten.flatten(surface.V, surface.F, surface.loops, boundary)
    radius = np.linalg.norm(V[surface.F].mean(axis=1), axis=1)
    product = flat.scale * radius  # |d log z / dz| = 1 / r
    assert product.std() / product.mean() < 0.03
    assert abs(flat.period) == pytest.approx(2 * np.pi * product.mean(), rel=0.02)
    assert np.mean(flat.distortion) < 1.06
    for loop in surface.loops:
        heights = flat.z[np.isin(flat.origin, loop)].imag
        assert np.ptp(heights) < 1e-6 * abs(flat.period)


def test_the_plain_net_of_a_ring_follows_its_boundaries():
    surface = examples.saddle_with_hole(12)
    net = cover(surface, (60, 60), count=300, boundary="plain")
    check_cover(net, surface, (60, 60))
    loops = mesh.boundary_loops(net.Q)
    assert {len(loop) for loop in loops} == {abs(net.report.winding[0])}  # u-lines, no steps
    outer = max(loops, key=lambda loop: np.ptp(net.V[loop, 0]))
    radius = np.linalg.norm(net.V[outer][:, :2], axis=1)
    inner = np.linalg.norm(net.V[min(loops, key=lambda q: np.ptp(net.V[q, 0]))][:, :2], axis=1)
    assert min(np.abs(radius - 1).max(), np.abs(inner - 0.35).max()) < 0.01


def test_a_square_with_a_square_hole_loses_no_triangle():
    V, Q = sheet(24, 24, lambda u, v: (u, v, 0.1 * u * v))
    hole = np.abs(V[Q].mean(axis=1)[:, :2] - 0.5).max(axis=1) < 0.2
    surface = repair.clean(V, Q[~hole])
    assert np.isin(surface.F, surface.loops[0]).all(axis=1).sum() == 0
    halved = igl.doublearea(surface.V, surface.F).sum()
    whole = igl.doublearea(*mesh.triangles(V, Q[~hole])).sum()
    assert halved == pytest.approx(whole, rel=1e-12)
    net = cover((V, Q[~hole]), (60, 60), count=600, direction=0.7)
    check_cover(net, (V, Q[~hole]), (60, 60))
    assert net.report.surface_flips == 0


# --- the map --------------------------------------------------------------------------------


def test_a_bent_sheet_is_flattened_without_distortion():
    V, Q = sheet(30, 20, lambda u, v: (np.cos(2 * u), np.sin(2 * u), v))
    surface = repair.clean(V, Q)
    flat = flatten.flatten(surface.V, surface.F, surface.loops)
    assert flat.flips == 0
    assert flat.distortion.max() < 1.001
    np.testing.assert_allclose(flat.scale, 1, atol=1e-3)
    ends = surface.loops[0][[0, len(surface.loops[0]) // 3]]
    u, v = np.divmod(ends, 21)[0] / 15, np.divmod(ends, 21)[1] / 20
    wanted = np.hypot(np.diff(u), np.diff(v))[0]
    assert abs(np.diff(flat.z[ends])[0]) == pytest.approx(wanted, rel=2e-3)


def test_the_map_of_a_spherical_cap_follows_the_stereographic_one():
    def point(u, v):
        x, y = 1.2 * (u - 0.5), 1.2 * (v - 0.5)
        s = 1 + x**2 + y**2
        return 2 * x / s, 2 * y / s, (s - 2) / s

    V, Q = sheet(40, 40, point)
    surface = repair.clean(V, Q)
    flat = flatten.flatten(surface.V, surface.F, surface.loops)
    w = V[:, 0] / (1 - V[:, 2]) + 1j * V[:, 1] / (1 - V[:, 2])
    columns = w[:, None] ** np.arange(8)  # any other conformal map is a power series of it
    fit = columns @ np.linalg.lstsq(columns, flat.z, rcond=None)[0]
    assert np.abs(fit - flat.z).max() < 2e-3 * np.abs(flat.z).max()
    assert flat.distortion.max() < 1.03
    assert flat.distortion.mean() < 1.02


def l_shape():
    V, Q = sheet(20, 20, lambda u, v: (u, v, 0.2 * u * v))
    return V, Q[(V[Q].mean(axis=1)[:, :2] < 0.5).any(axis=1)]


def courtyard():
    V, Q = sheet(20, 20, lambda u, v: (u, v, 0.2 * u * v))
    return V, Q[np.abs(V[Q].mean(axis=1)[:, :2] - 0.5).max(axis=1) > 0.2]


@pytest.mark.parametrize("make", [examples.wavy_roof, l_shape, courtyard])
def test_the_even_map_has_an_even_boundary_and_the_least_variation_of_scale(make):
    surface = repair.clean(*make())
    even, plain = (
        flatten.flatten(surface.V, surface.F, surface.loops, words) for words in ("even", "plain")
    )
    for loop in surface.loops:
        z = np.full(len(surface.V), np.nan, dtype=complex)
        z[even.origin] = even.z
        flat = np.abs(z[loop] - z[np.roll(loop, 1)])
        if even.period is not None:  # the edge at the cut
            flat = np.minimum(flat, np.abs(z[loop] - z[np.roll(loop, 1)] + even.period))
            flat = np.minimum(flat, np.abs(z[loop] - z[np.roll(loop, 1)] - even.period))
        true = np.linalg.norm(surface.V[loop] - surface.V[np.roll(loop, 1)], axis=1)
        assert np.ptp(flat / true) < 0.02 * np.mean(flat / true)
    assert np.ptp(np.log(even.scale)) <= np.ptp(np.log(plain.scale)) + 1e-3
    assert even.flips == 0
    assert even.distortion.mean() < plain.distortion.mean() + 1e-3


def test_a_helical_ramp_of_two_turns_overlaps_when_flattened():
    V, Q = sheet(150, 6, lambda u, v: ((1 + v) * np.cos(12 * u), (1 + v) * np.sin(12 * u), 2 * u))
    with pytest.raises(ValueError, match=r"overlaps itself, \d+ % of it"):
        cover((V, Q), (60, 60))


def test_points_of_the_plane_are_lifted_linearly():
    V, F = plate()
    surface = repair.clean(V, F)
    flat = flatten.flatten(surface.V, surface.F, surface.loops)
    domain = overlay.Domain(flat, surface.V)
    inside, lifted = domain.lift(np.append(flat.z, 100 + 0j))
    assert inside.tolist() == [True] * len(V) + [False]
    np.testing.assert_allclose(lifted[:-1], V, atol=1e-9)


def square(n=12):
    return mesh.triangles(*sheet(n, n, lambda u, v: (2 * u, 2 * v, 0 * u)))


def hexagon(rings=6):
    V, Q, polygon = mesh.polygon_rings(6, rings)
    V = np.concatenate([V, [[0, 0, 0]]])
    fan = np.stack([polygon, np.roll(polygon, -1), np.full(6, len(V) - 1)], axis=1)
    return V, np.concatenate([mesh.triangles(V, Q)[1], fan])


COVERED = {
    "square": square,
    "hexagon": hexagon,
    "shell": lambda: examples.hanging_shell(16),
    "ring": lambda: examples.saddle_with_hole(8),
}


@pytest.mark.parametrize("pair", [(60, 60), (90, 90), (75, 50)])
@pytest.mark.parametrize("name", COVERED)
def test_the_last_digits_of_a_symmetric_surface_do_not_turn_its_net(name, pair):
    V, F = COVERED[name]()
    net = cover((V, F), pair, count=200)
    for seed in range(2):
        noise = 1 + 1e-13 * np.random.default_rng(seed).uniform(-1, 1, V.shape)
        other = cover((V * noise, F), pair, count=200)
        np.testing.assert_array_equal(other.Q, net.Q)
        np.testing.assert_allclose(other.V, net.V, atol=1e-6 * np.ptp(V))


def test_a_square_has_no_longest_direction_and_takes_that_of_two_corners():
    V, F = square()
    flat = flatten.flatten(*repair.clean(V, F)[:3], "plain")
    corners = flat.z[[0, 168]]  # the first corner, and the one that is farthest from it
    assert np.angle(corners[1] - corners[0]) == pytest.approx(0, abs=1e-9)
    V, F = mesh.triangles(*sheet(12, 12, lambda u, v: (2 * u, 2.05 * v, 0 * u)))
    flat = flatten.flatten(*repair.clean(V, F)[:3], "plain")
    assert flat.z[12] - flat.z[0] == pytest.approx(2.05, abs=1e-9)  # along the longer side


# --- repairs --------------------------------------------------------------------------------


def test_turned_triangles_are_turned_back():
    V, F = examples.wavy_roof(12)
    G = F.copy()
    G[[3, 40, 41]] = G[[3, 40, 41]][:, ::-1]
    net, same = cover((V, G), (60, 60), count=80), cover((V, F), (60, 60), count=80)
    assert net.report.repairs == ("turned 3 faces that were oriented against the others",)
    np.testing.assert_allclose(net.V, same.V, atol=1e-9)


def test_a_soup_of_triangles_is_sewn_together():
    V, F = examples.wavy_roof(12)
    soup = V[F].reshape(-1, 3), np.arange(F.size).reshape(-1, 3)
    net = cover(soup, (60, 60), count=80)
    assert net.report.repairs == (f"merged {F.size - len(V)} duplicate vertices",)
    check_cover(net, (V, F), (60, 60))


def test_a_surface_that_was_cut_open_stays_open():
    V, Q = sheet(40, 8, lambda u, v: (np.cos(2 * np.pi * u), np.sin(2 * np.pi * u), v))
    net = cover((V, Q), (60, 60), count=80)
    assert net.report.repairs == ()
    assert net.report.winding == (0, 0)
    sewn = cover((V[Q].reshape(-1, 3), np.arange(Q.size).reshape(-1, 4)), (60, 60), count=80)
    assert sewn.report.winding != (0, 0)
    assert "merged" in sewn.report.repairs[0]


def test_a_pole_of_collapsed_quads_is_closed():
    V, Q = sheet(8, 24, lambda u, v: (u * np.cos(2 * np.pi * v), u * np.sin(2 * np.pi * v), u**2))
    V[:25] = V[0]
    V[24::25] = V[::25]
    net = cover((V, Q), (60, 60), count=80)
    assert net.report.repairs == ("merged vertices and dropped 24 triangles that were lines",)
    assert net.report.winding == (0, 0)
    check_cover(net, (V, Q), (60, 60))


def test_vertices_of_no_face_are_left_out():
    V, F = plate()
    net = cover((np.concatenate([V[:1] + 50, V]), F + 1), (60, 60), count=20)
    assert net.report.repairs == ("left out 1 vertices of no face",)


# --- bad input ------------------------------------------------------------------------------


def holes(count):
    V, F = plate(9)
    middle = V[F].mean(axis=1)
    places = np.array([[0.5, 0.3], [1.4, 0.7], [0.6, 0.75]])[:count]
    gone = [np.argmin(np.linalg.norm(middle[:, :2] - place, axis=1)) for place in places]
    return V, np.delete(F, gone, axis=0)


def open_torus():
    V, F = torus()
    return V, F[1:]


def two_plates():
    V, F = plate()
    return np.concatenate([V, V + 5]), np.concatenate([F, F + len(V)])


def three_wings():
    V = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0.0]])
    return V, np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])


def pinched():
    """A bent strip of triangles with its last vertex on its first one."""
    V, Q = sheet(8, 1, lambda u, v: ((1 + v) * np.cos(5 * u), (1 + v) * np.sin(5 * u), 0 * u))
    Q[Q == 16] = 0
    return mesh.triangles(V, Q)


def changed(index, value):
    V, F = plate()
    V[index] = value
    return V, F


BAD = [
    (torus, r"is closed: it has 0 boundary loops and 1 handles"),
    (open_torus, r"has 1 boundary loops and 1 handles"),
    (lambda: holes(2), r"has 3 boundary loops and 0 handles"),
    (lambda: holes(3), r"has 4 boundary loops and 0 handles"),
    (moebius, "one-sided"),
    (two_plates, r"has 2 separate pieces \(of 72, 72 faces\)"),
    (three_wings, "belongs to more than two faces: not a manifold"),
    (pinched, "touch at vertex 0 only: not a manifold"),
    (lambda: changed(5, np.nan), "vertex 5 has a coordinate that is not a finite number"),
    (
        lambda: changed(8, plate()[0][[1, 7]].mean(axis=0)),
        r"face \d+ has no area: its corners \[.*\] are on a line",
    ),
    (lambda: (np.zeros((0, 3)), np.zeros((0, 3), int)), "the mesh has no faces"),
    (lambda: (plate()[0], plate()[1] + 2), "there are only 49 vertices"),
    (lambda: (plate()[0], plate()[1].astype(float)), "integers are wanted"),
    (lambda: (plate()[0][:, :2], plate()[1]), "three real coordinates"),
]


@pytest.mark.parametrize(("make", "words"), BAD)
def test_surfaces_that_cannot_be_covered(make, words):
    with pytest.raises(ValueError, match=words) as caught:
        cover(make(), (60, 60))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"count": 0}, "count = 0: a whole number of quads"),
        ({"count": 2.5}, "count = 2.5: a whole number"),
        ({"count": np.nan}, "count = nan"),
        ({"size": 0}, "size = 0: a positive length"),
        ({"size": -1.0}, "size = -1.0"),
        ({"size": 50.0}, "size = 50: not one whole quad"),
        ({"size": 1e-9}, "grid points are too many"),
        ({"direction": np.inf}, "direction = inf"),
        ({"tolerance": 0}, "tolerance = 0"),
        ({"boundary": "round"}, 'boundary = "round": "even" or "plain" is wanted'),
    ],
)
def test_options_out_of_range(options, words):
    with pytest.raises(ValueError, match=words):
        cover(plate(), (60, 60), **options)


@pytest.mark.parametrize("pair", [(0, 60), (60, 180), (-5, 60), (60, np.nan)])
def test_angles_out_of_range(pair):
    with pytest.raises(ValueError, match="theta"):
        cover(plate(), pair)


@pytest.mark.parametrize(
    "make", [examples.wavy_roof, examples.saddle_with_hole, examples.hanging_shell]
)
def test_examples_are_sound_and_check_their_size(make):
    V, F = make(6)
    area = igl.doublearea(V, F)
    assert area.min() > 0.05 * area.mean()
    assert len(repair.clean(V, F).loops) == (2 if make is examples.saddle_with_hole else 1)
    for n in (1, 2.5):
        with pytest.raises(ValueError, match=f"n = {n}"):
            make(n)


def test_the_report_in_words():
    net = cover(examples.saddle_with_hole(8), (70, 50), count=100)
    words = report.text(net.report)
    assert words.startswith(f"{net.report.vertices} vertices, {net.report.quads} quads")
    assert f"{100 * net.report.covered:.0f} % of the surface is covered" in words


# --- the same on every machine ----------------------------------------------------------------


def polygon(sides, rings=6):
    """A flat disk of triangles with so many straight sides."""
    corner = np.exp(2j * np.pi * np.arange(sides) / sides)
    z, F, start = [0j], [], [0, 1]
    for r in range(1, rings + 1):
        t = np.arange(r) / r
        z.extend(r * (corner[:, None] * (1 - t) + np.roll(corner, -1)[:, None] * t).ravel())
        start.append(len(z))
        for k in range(sides * r):
            side, step = divmod(k, r)
            a, b = start[r] + k, start[r] + (k + 1) % (sides * r)
            inner = [
                start[r - 1] + (side * (r - 1) + s) % max(1, sides * (r - 1))
                for s in (step, step + 1)
            ]
            F.append([inner[0], a, b])
            F.extend([[inner[0], b, inner[1]]] if step < r - 1 else [])
    return np.stack([np.real(z), np.imag(z), 0 * np.real(z)], axis=1), np.array(F)


def annulus():
    V, Q = sheet(6, 36, lambda u, v: np.stack(_polar(0.4 + 0.6 * u, 2 * np.pi * v)))
    i, j = np.divmod(Q, 37)
    return V.reshape(7, 37, 3)[:, :-1].reshape(-1, 3), 36 * i + j % 36


def _polar(radius, angle):
    return radius * np.cos(angle), radius * np.sin(angle), 0 * radius


SYMMETRIC = {
    "shell": lambda: examples.hanging_shell(16),
    "square": lambda: sheet(12, 12, lambda u, v: (2 * u - 1, 2 * v - 1, 0 * u)),
    "triangle": lambda: polygon(3),
    "pentagon": lambda: polygon(5),
    "hexagon": lambda: polygon(6),
    "annulus": annulus,
    "saddle with a hole": lambda: examples.saddle_with_hole(8),
}


def noisy(V, seed):
    return V * (1 + 1e-13 * np.random.default_rng(seed).standard_normal(V.shape))


@pytest.mark.parametrize("name", SYMMETRIC)
@pytest.mark.parametrize(("pair", "direction"), [((60, 60), 0), ((90, 90), 45), ((90, 60), 90)])
def test_covers_of_symmetric_surfaces_do_not_hang_on_rounding(name, pair, direction):
    V, F = SYMMETRIC[name]()
    options = {"count": 128, "direction": np.radians(direction)}
    net = cover((V, F), pair, **options)
    for seed in range(2):
        other = cover((noisy(V, seed), F), pair, **options)
        np.testing.assert_array_equal(other.Q, net.Q)
        size = np.linalg.norm(np.ptp(V, axis=0))
        np.testing.assert_allclose(other.V, net.V, rtol=0, atol=1e-9 * size)
        assert other.report.winding == net.report.winding


@pytest.mark.parametrize("name", SYMMETRIC)
@pytest.mark.parametrize("boundary", ["even", "plain"])
def test_maps_of_symmetric_surfaces_do_not_hang_on_rounding(name, boundary):
    V, F = SYMMETRIC[name]()
    known = None
    for seed in range(4):
        surface = repair.clean(noisy(V, seed), F)
        flat = flatten.flatten(surface.V, surface.F, surface.loops, boundary)
        known = known or flat
        np.testing.assert_array_equal(flat.F, known.F)
        np.testing.assert_array_equal(flat.origin, known.origin)
        np.testing.assert_allclose(flat.z, known.z, rtol=0, atol=1e-10 * np.abs(known.z).max())


@pytest.mark.parametrize("boundary", ["even", "plain"])
def test_a_square_has_no_longest_direction_and_lies_on_its_first_diagonal(boundary):
    V, Q = SYMMETRIC["square"]()
    surface = repair.clean(V, Q)
    flat = flatten.flatten(surface.V, surface.F, surface.loops, boundary)
    corners = [k for k in surface.loops[0] if np.abs(V[k, :2]).min() == 1]
    along = V[:, :2] @ -V[corners[0], :2] / np.sqrt(2)
    np.testing.assert_allclose(flat.z.real, along, atol=1e-9)


def test_points_on_the_rim_up_to_rounding_are_inside():
    V, Q = SYMMETRIC["square"]()
    for seed in range(4):
        net = cover((noisy(V, seed), Q), (90, 90), size=0.2, direction=np.pi / 4, optimise=False)
        assert len(net.Q) == 100  # ten by ten, the outer lines lie on the sides


def test_duplicate_vertices_are_merged_wherever_they_lie():
    V, F = examples.wavy_roof(12)
    soup = V[F].reshape(-1, 3)
    soup = soup + 1e-13 * np.random.default_rng(3).standard_normal(soup.shape)
    found = repair.clean(soup, np.arange(F.size).reshape(-1, 3))
    assert len(found.V) == len(V)
    assert len(found.loops) == 1
