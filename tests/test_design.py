"""Nets over surfaces: closed forms of the map, angles and distances by other means, bad input."""

import re
from functools import partial
from pathlib import Path
from unittest.mock import Mock

import igl
import numpy as np
import pytest
from test_repair import TAU, plate, polar, sheet
from test_ties import noisy

from inetlib import design, examples, measure, mesh, repair, solver
from inetlib.design import flatten, overlay, report
from inetlib.solver import run

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
PAIRS = [(60, 60), (90, 90), (70, 50)]
EXACT = 1e-6  # degrees


def cover(surface, pair, **options):
    return design.cover(*surface, *np.radians(pair), **options)


def flat_of(surface, boundary="even"):
    """(the clean surface, its `Flat`)."""
    found = repair.clean(*surface)
    return found, flatten.flatten(*found[:3], boundary)


def check_cover(net, surface, pair, far=1e-2):
    """Angles by arithmetic of complex planes, distances by libigl: nothing from the report."""
    V, Q = net.V, net.Q
    d1, d2 = V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]]
    for (a, b), wanted in zip(((d1, d2), (d1 + d2, d2 - d1)), np.radians(pair), strict=True):
        a, b = (x / np.linalg.norm(x, axis=1, keepdims=True) for x in (a, b))
        found = 2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))
        assert np.degrees(np.abs(found - wanted)).max() < EXACT
    W, F = mesh.triangles(*surface)
    squares, _, _ = igl.point_mesh_squared_distance(V, W, F)
    away = np.sqrt(squares) / np.linalg.norm(np.ptp(W, axis=0))
    assert away.mean() < 1e-3
    assert away.max() < far
    assert away.max() == pytest.approx(net.report.distance_max, abs=1e-9)
    assert measure.quality(V, Q).flips == net.report.flips == 0
    assert mesh.is_labelled(Q)
    assert net.report.converged


def courtyard():
    V, Q = sheet(24, 24, lambda u, v: (u, v, 0.2 * u * v))
    return V, Q[np.abs(V[Q].mean(axis=1)[:, :2] - 0.5).max(axis=1) > 0.2]


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
    words = report.text(net.report)
    assert words.startswith(f"{len(net.V)} vertices, {len(net.Q)} quads")
    assert f"{100 * net.report.covered:.0f} % of the surface is covered" in words


@pytest.mark.parametrize(
    ("name", "pair", "count"),
    [(name, pair, 1500) for name in ("lilium", "snail") for pair in PAIRS]
    + [("lilium", (60, 60), 5000)],
)
def test_surfaces_that_nobody_here_made(name, pair, count):
    if not (DATA / f"{name}.obj").exists():
        pytest.skip("the data folder is not here")
    V, _, _, F, _, _ = igl.readOBJ(str(DATA / f"{name}.obj"))
    surface = V, F.astype(np.int64)
    net = cover(surface, pair, count=count)
    check_cover(net, surface, pair)
    assert net.report.quads == pytest.approx(count, rel=0.02)


def test_the_plane_is_covered_by_the_sheared_grid_itself():
    surface = sheet(12, 4, lambda u, v: (3 * u, v, 0 * u))
    net = cover(surface, (70, 50), size=0.1, direction=0.3, optimise=False)
    along = net.V[net.Q[:, 2]] - net.V[net.Q[:, 1]]  # v3 - v2, the u-edges
    turned = np.arctan2(along[:, 1], along[:, 0]) % np.pi
    np.testing.assert_allclose(turned, 0.3, atol=1e-6)
    assert measure.deviations(net.V, net.Q, *np.radians([70, 50])).max() < 1e-6
    assert net.report.edge_mean == pytest.approx(0.1, rel=0.02)
    assert net.report.size_ratio == pytest.approx(1, abs=1e-6)
    assert net.report.distortion_max == pytest.approx(1, abs=1e-6)
    assert (net.report.converged, net.report.message) == (False, "not optimised")


def test_every_quad_is_inside_and_two_rooms_with_a_narrow_door_give_one_sound_piece():
    V = np.stack(polar(0.999, TAU * np.arange(60) / 60, np.zeros(60)), axis=1)
    F = np.stack([np.arange(60), np.roll(np.arange(60), -1), np.full(60, 60)], axis=1)
    net = cover((np.concatenate([V, np.zeros((1, 3))]), F), (60, 60), count=200)
    assert np.linalg.norm(net.V, axis=1).max() < 1
    assert net.report.covered > 0.8
    rooms = sheet(60, 10, lambda u, v: (4 * u - 2, (v - 0.5) * (0.06 + (4 * u - 2) ** 2), 0 * u))
    net = cover(rooms, (60, 60), count=150)
    assert len(np.unique(mesh.pairs(net.Q) // 4)) == len(net.Q)
    assert len(mesh.boundary_loops(net.Q)) == 1  # raises where two quads touch at a vertex


def test_no_two_quads_touch_at_a_vertex_only_where_a_surface_is_cracked():
    """Two cracks that end in the middles of two quads which touch at one vertex."""
    left = [(0, 4.83), (3.55, 4.5), (0, 4.79)]
    right = [(8, 3.17), (4.45, 3.5), (8, 3.21)]
    V = np.array([(0, 0), (8, 0), *right, (8, 8), (0, 8), *left]) @ np.eye(2, 3)
    surface = V, repair.triangulate(V, [list(range(len(V)))])
    for direction in np.linspace(0, 1.5, 6):
        Q = cover(surface, (90, 90), size=1.0, direction=direction, optimise=False).Q
        sides = np.sort(np.concatenate([Q[:, [k, k - 1]] for k in range(4)]), axis=1)
        sides, often = np.unique(sides, axis=0, return_counts=True)
        assert len(Q) > 20 and np.bincount(sides[often == 1].ravel()).max() == 2
        assert not repair.components(len(Q), *mesh.pairs(Q).T // 4).any()


def test_a_surface_so_rough_that_both_maps_flip_triangles_is_flattened_and_says_so():
    V, F = examples.wavy_roof(10)
    V = V + 0.1 * np.random.default_rng(0).normal(size=V.shape) * [1, 1, 10]
    flat = flatten.flatten(*repair.clean(V, F)[:3])
    a, b, c = flat.z[flat.F].T
    assert flat.flips == np.count_nonzero(np.imag(np.conj(b - a) * (c - a)) <= 0) > 0


def test_large_coordinates_one_quad_extreme_angles_and_a_steep_bump():
    V, Q = sheet(15, 15, lambda u, v: (u, v, 0.3 * u * v))
    V = 1e4 * V + 1e5
    check_cover(cover((V, Q), (60, 45), count=100), (V, Q), (60, 45))
    surface = examples.wavy_roof(20)
    assert cover(surface, (60, 60), count=1).report.quads == 1
    for pair in ((150, 120), (35, 100)):
        check_cover(cover(surface, pair, count=300), surface, pair)
    net = cover(BUMP, (60, 60), count=800)
    check_cover(net, BUMP, (60, 60), far=0.02)
    assert net.report.size_ratio > 5


BUMP = sheet(40, 40, lambda u, v: (u, v, 0.8 * np.exp(-30 * ((u - 0.5) ** 2 + (v - 0.5) ** 2))))


@pytest.mark.parametrize(
    ("module", "name", "value", "good", "words"),
    [
        (design, "ATTEMPTS", design.ATTEMPTS[-2:], True, "diagonal off the surface: ask for more"),
        (design, "GROWN", 1.0, False, "^the net has folded or collapsed; converged"),
        (solver, "optimize", partial(solver.optimize, iterations=0), False, "^not converged"),
    ],
)
def test_a_net_that_is_off_is_returned_and_says_so(monkeypatch, module, name, value, good, words):
    monkeypatch.setattr(module, name, value)
    found = cover(BUMP, (60, 60), count=150).report
    assert found.converged == good and re.search(words, found.message)
    assert name != "ATTEMPTS" or found.distance_max > 0.01
    assert name != "optimize" or found.max_deviation > 1e-4


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
    if direction == 0:
        closed = [line for line in mesh.polylines(net.Q).u if line[0] == line[-1]]
        assert {len(line) - 1 for line in closed} == {abs(net.report.winding[0])}


@pytest.mark.parametrize("boundary", ["even", "plain"])
def test_a_flat_ring_is_mapped_by_the_logarithm(boundary):
    V, F = examples.saddle_with_hole(20)
    V[:, 2] = 0
    surface, flat = flat_of((V, F), boundary)
    radius = np.linalg.norm(V[surface.F].mean(axis=1), axis=1)
    product = flat.scale * radius  # |d log z / dz| = 1 / r
    assert product.std() / product.mean() < 0.03
    assert abs(flat.period) == pytest.approx(TAU * product.mean(), rel=0.02)
    assert np.mean(flat.distortion) < 1.06
    for loop in surface.loops:
        heights = flat.z[np.isin(flat.origin, loop)].imag
        assert np.ptp(heights) < 1e-6 * abs(flat.period)


def test_the_plain_net_of_a_ring_follows_its_boundaries_and_a_square_hole_flips_nothing():
    surface = examples.saddle_with_hole(12)
    net = cover(surface, (60, 60), count=300, boundary="plain")
    check_cover(net, surface, (60, 60))
    loops = mesh.boundary_loops(net.Q)
    assert {len(loop) for loop in loops} == {abs(net.report.winding[0])}  # u-lines, no steps
    radii = [np.linalg.norm(net.V[loop, :2], axis=1) for loop in loops]
    assert min(np.abs(r - wanted).max() for r in radii for wanted in (0.35, 1)) < 0.01
    net = cover(courtyard(), (60, 60), count=600, direction=0.7)
    check_cover(net, courtyard(), (60, 60))
    assert net.report.surface_flips == 0


def test_a_tube_takes_three_quads_around_and_no_two():
    V, Q = sheet(12, 36, lambda u, v: polar(1, TAU * v, 12 * u))
    tube = V, repair.merge(V, Q, 1e-9)[0]
    net = cover(tube, (90, 90), size=TAU / 3, optimise=False)
    assert sum(map(abs, net.report.winding)) == 3
    mesh.check(net.V, net.Q)
    with pytest.raises(ValueError, match=r"size = 3\.1.*: not one whole quad"):
        cover(tube, (90, 90), size=TAU / 2, optimise=False)


def test_a_ring_is_cut_where_it_is_narrowest():
    V, Q = sheet(6, 36, lambda u, v: polar(0.3 + 0.7 * u, TAU * v, 0 * u))
    radius = np.linalg.norm(V, axis=1)
    V[:, 1] += 0.6 * (1 - radius) / 0.7  # the hole moves up, 0.1 from the rim
    surface, flat = flat_of((V, repair.merge(V, Q, 1e-9)[0]))
    cut = surface.V[np.flatnonzero(np.bincount(flat.origin) == 2)]
    assert len(cut) == 7 and np.ptp(cut[:, 1]) == pytest.approx(0.1)
    np.testing.assert_allclose(cut[:, 0], 0, atol=1e-12)


def test_a_bent_sheet_is_flattened_without_distortion():
    surface, flat = flat_of(sheet(30, 20, lambda u, v: polar(1, 2 * u, v)))
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

    surface, flat = flat_of(sheet(40, 40, point))
    x, y, z = surface.V.T
    columns = ((x + 1j * y) / (1 - z))[:, None] ** np.arange(8)
    # any other conformal map is a power series of the stereographic one
    fit = columns @ np.linalg.lstsq(columns, flat.z, rcond=None)[0]
    assert np.abs(fit - flat.z).max() < 2e-3 * np.abs(flat.z).max()
    assert flat.distortion.max() < 1.03
    assert flat.distortion.mean() < 1.02


def l_shape():
    V, Q = sheet(20, 20, lambda u, v: (u, v, 0.2 * u * v))
    return V, Q[(V[Q].mean(axis=1)[:, :2] < 0.5).any(axis=1)]


@pytest.mark.parametrize("make", [examples.wavy_roof, l_shape, courtyard])
def test_the_even_map_has_an_even_boundary_and_the_least_variation_of_scale(make):
    (surface, even), (_, plain) = flat_of(make()), flat_of(make(), "plain")
    for loop in surface.loops:
        z = np.full(len(surface.V), np.nan, dtype=complex)
        z[even.origin] = even.z
        step, period = z[loop] - z[np.roll(loop, 1)], even.period or 0
        flat = np.abs([step, step + period, step - period]).min(axis=0)  # the edge at the cut
        true = np.linalg.norm(surface.V[loop] - surface.V[np.roll(loop, 1)], axis=1)
        assert np.ptp(flat / true) < 0.02 * np.mean(flat / true)
    assert np.ptp(np.log(even.scale)) <= np.ptp(np.log(plain.scale)) + 1e-3
    assert even.flips == 0
    assert even.distortion.mean() < plain.distortion.mean() + 1e-3


def test_a_map_that_overlaps_itself_is_refused():
    ramp = sheet(150, 6, lambda u, v: polar(1 + v, 12 * u, 2 * u))  # two turns
    with pytest.raises(ValueError, match=r"overlaps itself, \d+ % of it"):
        cover(ramp, (60, 60))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"count": 0}, "count = 0: a whole number, 1 or more, is wanted"),
        ({"count": 2.5}, "count = 2.5: a whole number"),
        ({"size": 0}, "size = 0: a positive finite number"),
        ({"size": 50.0}, "size = 50: not one whole quad"),
        ({"size": 1e-9}, "grid points are too many"),
        ({"direction": np.inf}, "direction = inf"),
        ({"tolerance": 0}, "tolerance = 0"),
        ({"boundary": "round"}, 'boundary = "round": "even" or "plain" is wanted'),
        ({"theta": 0}, "theta"),
        ({"theta0": np.pi}, "theta0"),
    ],
)
def test_options_out_of_range(options, words):
    with pytest.raises(ValueError, match=words):
        design.cover(*plate(), **({"theta": 1.0, "theta0": 1.0} | options))


@pytest.mark.parametrize("name", examples.SURFACES)
def test_examples_are_sound_and_check_their_size(name):
    make = examples.SURFACES[name]
    area = igl.doublearea(*make(6))
    assert area.min() > 0.05 * area.mean()
    holes = {"saddle": 1, "skylight": 1, "two_skylights": 2, "five_skylights": 5}
    assert len(repair.clean(*make(6)).loops) == 1 + holes.get(name, 0)
    for n in (1, 2.5):
        with pytest.raises(ValueError, match=f"n = {n}"):
            make(n)


def polygon(sides):
    """A flat disk with rotational symmetry."""
    V, Q, inner = mesh.polygon_rings(sides, 5)
    V = np.concatenate([V, [[0, 0, 0]]])
    fan = np.stack([inner, np.roll(inner, -1), np.full(sides, len(V) - 1)], axis=1)
    return V, np.concatenate([mesh.triangles(V, Q)[1], fan])


def annulus():
    V, Q = sheet(6, 36, lambda u, v: polar(0.4 + 0.6 * u, TAU * v))
    return V, repair.merge(V, Q, 1e-9)[0]


SYMMETRIC = {
    "shell": lambda: examples.hanging_shell(16),
    "square": lambda: sheet(12, 12, lambda u, v: (2 * u - 1, 2 * v - 1, 0 * u)),
    "triangle": lambda: polygon(3),
    "pentagon": lambda: polygon(5),
    "hexagon": lambda: polygon(6),
    "annulus": annulus,
    "saddle with a hole": lambda: examples.saddle_with_hole(8),
}


@pytest.mark.elsewhere
@pytest.mark.parametrize("name", SYMMETRIC)
@pytest.mark.parametrize(
    ("pair", "direction"), [((60, 60), 0), ((90, 90), 45), ((90, 60), 90), ((75, 50), 0)]
)
def test_covers_of_symmetric_surfaces_do_not_hang_on_rounding(name, pair, direction):
    V, F = SYMMETRIC[name]()
    options = {"count": 128, "direction": np.radians(direction)}
    net = cover((V, F), pair, **options)
    for seed in range(2):
        other = cover((noisy(seed, V), F), pair, **options)
        np.testing.assert_array_equal(other.Q, net.Q)
        size = np.linalg.norm(np.ptp(V, axis=0))
        np.testing.assert_allclose(other.V, net.V, rtol=0, atol=1e-9 * size)
        assert other.report.winding == net.report.winding


@pytest.mark.parametrize("name", SYMMETRIC)
@pytest.mark.parametrize("boundary", ["even", "plain"])
def test_maps_of_symmetric_surfaces_do_not_hang_on_rounding(name, boundary):
    V, F = SYMMETRIC[name]()
    first, *others = (flat_of((noisy(seed, V), F), boundary)[1] for seed in range(4))
    for flat in others:
        np.testing.assert_array_equal(flat.F, first.F)
        np.testing.assert_array_equal(flat.origin, first.origin)
        np.testing.assert_allclose(flat.z, first.z, rtol=0, atol=1e-10 * np.abs(first.z).max())


@pytest.mark.parametrize("boundary", ["even", "plain"])
def test_a_square_has_no_longest_direction_and_lies_on_its_first_diagonal(boundary):
    surface, flat = flat_of(SYMMETRIC["square"](), boundary)
    V = surface.V
    corners = [k for k in surface.loops[0] if np.abs(V[k, :2]).min() == 1]
    along = V[:, :2] @ -V[corners[0], :2] / np.sqrt(2)
    np.testing.assert_allclose(flat.z.real, along, atol=1e-9)
    _, flat = flat_of(sheet(12, 12, lambda u, v: (2 * u, 2.05 * v, 0 * u)), boundary)
    assert flat.z[12] - flat.z[0] == pytest.approx(2.05, abs=1e-9)  # along the longer side


def test_points_on_the_rim_up_to_rounding_are_inside():
    V, Q = SYMMETRIC["square"]()
    for seed in range(4):
        net = cover((noisy(seed, V), Q), (90, 90), size=0.2, direction=np.pi / 4, optimise=False)
        assert len(net.Q) == 100  # ten by ten, the outer lines lie on the sides


CASES = {
    "disk": (examples.wavy_roof(12), (70, 50), 60),
    "ring": (examples.saddle_with_hole(6), (60, 60), 40),
    "several attempts": (examples.skylight(12), (40, 140), 40),  # all fail, the first is the best
}
each_case = pytest.mark.parametrize("name", CASES)


def covered(name, **options):
    surface, pair, count = CASES[name]
    return cover(surface, pair, count=count, **options)


def merit(name, V, Q):
    """(flipped faces, the largest deviation of an angle): small is good."""
    most = measure.deviations(V, Q, *np.radians(CASES[name][1])).max()
    return measure.quality(V, Q).flips, most


def stopped(name, last):
    """The cover that is stopped after so many steps, and all that was told."""
    told = []

    def callback(step, V, Q):
        told.append((step, V.copy(), Q))
        return len(told) <= last

    return covered(name, callback=callback), told


@pytest.fixture(scope="module")
def ways():
    """{case: (its cover, [(step, V, Q), ...] on the way)}."""
    return {name: stopped(name, np.inf) for name in CASES}


@each_case
def test_the_start_is_told_first_and_then_every_step_with_the_net_it_speaks_of(ways, name):
    net, ((step, start, _), *way) = ways[name]
    assert step is None and np.array_equal(start, covered(name, optimise=False).V)
    assert len(way) > 1 and any(np.array_equal(V, net.V) for _, V, _ in ways[name][1])
    for step, V, Q in way:
        flips, most = merit(name, V, Q)
        assert isinstance(step, run.Step) and np.array_equal(Q, net.Q)
        assert step.flips == flips and step.deviation == pytest.approx(most, abs=1e-12)
    alone = covered(name)  # being told changes nothing
    assert np.array_equal(alone.V, net.V) and alone.report.message == net.report.message
    exact = next((k for k, step in enumerate(way, 1) if step[0].deviation < 1e-11), None)
    if name != "several attempts":  # stopped there, the report does not contradict itself
        net, told = stopped(name, exact)
        assert np.array_equal(net.V, told[-1][1])
        assert net.report.converged is net.report.message.startswith("converged")


@pytest.mark.parametrize("answer", [None, 0, "", np.bool_(True)])
def test_only_false_stops(ways, answer):
    callback = Mock(return_value=answer)
    net = covered("disk", callback=callback)
    assert callback.call_count == len(ways["disk"][1])
    assert np.array_equal(net.V, ways["disk"][0].V)


@pytest.mark.parametrize("last", range(4))
@each_case
def test_stopped_no_further_step_is_made_and_the_best_net_is_kept(ways, name, last):
    net, told = stopped(name, last)
    assert len(told) == last + 1
    for (_, V, _), (_, known, _) in zip(told, ways[name][1], strict=False):
        assert np.array_equal(V, known)
    assert "stopped" in net.report.message and not net.report.converged
    if name != "several attempts":
        assert merit(name, net.V, net.Q) == min(merit(name, V, Q) for _, V, Q in told)


@pytest.mark.parametrize("part", [0.0, 0.3, 0.7, 1.0])
def test_stopped_in_a_later_attempt_what_an_earlier_one_has_found_is_kept(ways, part):
    name = "several attempts"
    whole, way = ways[name]
    found = next(k for k, (_, V, _) in enumerate(way) if np.array_equal(V, whole.V))
    assert found < len(way) - 10  # later attempts gained nothing
    last = found + 1 + int(part * (len(way) - 2 - found))
    net, told = stopped(name, last)
    assert len(told) == last + 1
    assert merit(name, net.V, net.Q) <= merit(name, whole.V, whole.Q)


def test_nothing_is_told_where_nothing_is_optimised_and_errors_of_the_caller_reach_the_caller():
    covered("disk", optimise=False, callback=lambda *_: pytest.fail("told"))
    for when in (0, 2):
        callback = Mock(side_effect=[None] * when + [RuntimeError("of the caller")])
        with pytest.raises(RuntimeError, match="of the caller"):
            covered("disk", callback=callback)
        assert callback.call_count == when + 1


STAGES = tuple(design.STAGES)


def test_a_surface_made_ready_once_gives_the_same_nets_and_is_not_flattened_again(monkeypatch):
    surface = examples.SURFACES["skylight"]()
    for openings in (None, "fill"):
        first = [design.cover(*surface, *np.radians(x), 80, openings=openings) for x in SIXTY]
        with monkeypatch.context() as patch:
            known = design.ready(*surface, openings)
            patch.setattr(flatten, "flatten", Mock(side_effect=AssertionError))
            for pair, net in zip(SIXTY, first, strict=True):
                again = design.cover(None, None, *np.radians(pair), 80, known=known)
                assert np.array_equal(again.V, net.V) and np.array_equal(again.Q, net.Q)
                assert set(again.report.seconds) == set(STAGES[2:])
                assert set(net.report.seconds) == set(STAGES)


@pytest.mark.parametrize("last", STAGES)
def test_a_stage_that_is_refused_is_the_last_one(last):
    told = []

    def stage(name):
        told.append(name)
        return name != last

    def covered():
        return design.cover(*examples.wavy_roof(8), *np.radians([60, 60]), 30, stage=stage)

    if last == "report":  # by then there is a net
        assert covered().report.converged
    else:
        with pytest.raises(design.Stopped, match=design.STAGES[last]):
            covered()
    assert list(dict.fromkeys(told)) == list(STAGES[: STAGES.index(last) + 1])
    assert told.count(last) == 1


@pytest.mark.parametrize("last", [1, 2, 3])
def test_the_cutting_of_panels_can_be_stopped_between_its_parts(last):
    known, told = design.ready(*examples.wavy_roof(8)), []

    def covered(most, trim=True):
        told.clear()

        def stage(name):
            told.append(name)
            return told.count("grid") < most

        ways = {"trim": trim, "known": known, "optimise": False, "stage": stage}
        design.cover(None, None, *np.radians([60, 60]), 30, **ways)
        return told.count("grid")

    before, after = covered(np.inf, trim=False), covered(np.inf)
    assert after == before + 3
    with pytest.raises(design.Stopped, match=design.STAGES["grid"]):
        covered(before + last)
    assert told == ["grid"] * (before + last)


SIXTY = (60, 60), (75, 50)
STEEP = (1, 1), (179, 179), (1, 179), (90, 1), (90, 179)


@pytest.mark.parametrize("name", ["roof", "saddle", "skylight"])
def test_quads_that_are_too_slender_for_a_surface_are_refused_before_any_step(name, monkeypatch):
    monkeypatch.setattr(solver, "optimize", Mock(side_effect=AssertionError))
    known = design.ready(*examples.SURFACES[name]())
    for pair in STEEP:
        with pytest.raises(ValueError, match=r"\d+ of \d+ are not convex.*more quads"):
            design.cover(None, None, *np.radians(pair), 300, known=known)


def test_no_report_says_that_more_than_the_surface_is_covered():
    net = design.cover(*examples.saddle_with_hole(), *np.radians([1, 1]), 300, optimise=False)
    assert net.report.covered > 3
    said = report.text(net.report)
    assert "in folds" in said and "% of the surface" not in said
    flat = design.cover(*examples.wavy_roof(8), *np.radians([60, 60]), 30)
    share = re.search(r"(\d+) % of the surface is covered", report.text(flat.report))
    assert 50 < int(share[1]) < 100


def test_all_grid_points_near_a_domain_are_found_however_slender_the_cells():
    surface = examples.SURFACES["skylight"]()
    ground = design.ready(*surface, "fill")
    flat, domain = ground.flat, overlay.Domain(ground.flat, ground.V)
    for u, v in ((0.3, 0.2j), (0.5, 0.5 + 0.02j), (-0.1 + 0.4j, 0.41j), (0.3j, 0.5), (0.2, 0.9j)):
        i, j = overlay.points(domain, u, v)
        assert len(set(zip(i.tolist(), j.tolist(), strict=True))) == len(i)
        area = np.imag(np.conj(u) * v)
        a = np.floor(np.imag(flat.z * np.conj(v)) / -area).astype(int)
        b = np.floor(np.imag(np.conj(u) * flat.z) / area).astype(int)
        corners = {
            (p + k, q + m) for p, q in zip(a, b, strict=True) for k in (0, 1) for m in (0, 1)
        }
        assert corners <= set(zip(i.tolist(), j.tolist(), strict=True))
        assert np.abs(i * u + j * v - flat.z.mean()).max() < 2 * domain.size + abs(u) + abs(v)
