"""`developable` against closed forms, fundamental forms by differences, and integrals."""

from itertools import pairwise

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from inetlib import conformal, developable, measure

T, T0 = np.radians(60), np.radians(45)
GRID = conformal.sheared_grid(T, T0, 5, 4, edge=0.4, direction=np.exp(0.3j))
CONTROL = np.array([[0, 0, 0], [3, 0, 0], [6, 3, 1], [6, 6, 3.0]])
PLANE_CONTROL = np.array([[0, 0], [1, 2], [3, -1], [5, 1.0]])
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(12)
GAUSS, WEIGHTS = (GAUSS + 1) / 2, WEIGHTS / 2
# Coefficients of central differences of order 10, unlike the library's order 8:
STENCIL = np.array([5 / 6, -5 / 21, 5 / 84, -5 / 504, 1 / 1260])


def helix(radius=1.0, pitch=0.5):
    """A helix with its derivatives, not by arc length."""

    def position(t, k=0):
        t = np.asarray(t)
        turn = t + k * np.pi / 2
        line = pitch * (t if k == 0 else np.full(t.shape, float(k == 1)))
        return np.stack([radius * np.cos(turn), radius * np.sin(turn), line], axis=-1)

    return developable.arc_length(position, 0.0, 6.0)


SPACE = developable.arc_length(developable.bezier(CONTROL))
DIRECTRIX = developable.arc_length(developable.bezier(PLANE_CONTROL))
FAMILY = {
    **{f"roll {k}": lambda z, k=k: developable.roll(z, k, 1 + 2j) for k in (0, 1e-9, 1e-3, 0.7)},
    "roll -2": lambda z: developable.roll(z, -2),
    **{f"cone {g}": lambda z, g=g: developable.cone(z, g, -1 - 1j) for g in (0.4, 1.2, 2.5)},
    "flat cone": lambda z: developable.cone(z, np.pi / 2, -1 - 1j),
    "cylinder": lambda z: developable.cylinder(z + 2, DIRECTRIX),
    "turned cylinder": lambda z: developable.cylinder(z + 1.5 + 0.5j, DIRECTRIX, 1 + 1j),
    "rectifying": lambda z: developable.rectifying(z + 3, SPACE),
    "other side": lambda z: developable.rectifying(z + 3 - 4j, SPACE),
    "helical": lambda z: developable.rectifying(z + 2 + 0.1j, helix()),
}
each_map = pytest.mark.parametrize("bend", FAMILY.values(), ids=FAMILY)


def partials(bend, z, step=0.02):
    """X_x and X_y of a map of the plane, (..., 3) each."""
    found = []
    for way in (step, step * 1j):
        pairs = [bend(z + k * way) - bend(z - k * way) for k in range(1, 6)]
        found.append(np.tensordot(STENCIL, pairs, axes=1) / step)
    return found


def dot(a, b):
    return np.sum(a * b, axis=-1)


# --- every map is an isometry -------------------------------------------------------------


@each_map
def test_the_first_fundamental_form_is_that_of_the_plane(bend):
    x, y = partials(bend, GRID)
    form = np.stack([dot(x, x) - 1, dot(x, y), dot(y, y) - 1])
    assert np.abs(form).max() < 1e-9


@given(st.floats(-3, 3), st.floats(0.35, 2.8), st.floats(-4, 4))
def test_the_form_is_constant_through_the_families_of_cylinders_and_cones(curvature, gamma, turn):
    direction = np.exp(1j * turn)
    for bend in (
        lambda z: developable.roll(z, curvature, direction),
        lambda z: developable.cone(z, gamma, -3 * np.exp(0.7j), np.exp(0.7j)),
    ):
        x, y = partials(bend, GRID)
        form = np.stack([dot(x, x) - 1, dot(x, y), dot(y, y) - 1])
        assert np.abs(form).max() < 1e-9


@pytest.mark.parametrize("part", np.linspace(0, 1, 9))
def test_the_form_is_constant_while_control_points_move(part):
    moved = (1 - part) * CONTROL + part * np.array([[0, 0, 0], [2, 1, 0], [5, 4, -1], [5, 7, 4]])
    curve = developable.arc_length(developable.bezier(moved))
    x, y = partials(lambda z: developable.rectifying(z, curve), GRID[:3, :2] + 3.5 - 0.3j)
    form = np.stack([dot(x, x) - 1, dot(x, y), dot(y, y) - 1])
    assert np.abs(form).max() < 1e-9


@each_map
def test_edges_measured_along_the_surface_keep_their_lengths(bend):
    for start, end in ((GRID[:-1], GRID[1:]), (GRID[:, :-1], GRID[:, 1:])):
        edge = end - start
        t = start + edge * GAUSS[:, None, None]
        x, y = partials(bend, t)
        speed = np.linalg.norm(edge.real[..., None] * x + edge.imag[..., None] * y, axis=-1)
        assert np.abs(np.tensordot(WEIGHTS, speed, axes=1) - np.abs(edge)).max() < 1e-9


@each_map
def test_a_polyline_of_ever_shorter_chords_tends_to_the_length_of_the_edge(bend):
    lengths = []
    for count in (64, 128, 256):
        points = bend(np.linspace(GRID[0, 0], GRID[1, 0], count + 1))
        lengths.append(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    one, two = (4 * b - a for a, b in pairwise(lengths))
    assert (16 * two - one) / 45 == pytest.approx(abs(GRID[1, 0] - GRID[0, 0]), abs=1e-10)


@each_map
def test_cells_keep_their_areas(bend):
    u, v = GRID[1, 0] - GRID[0, 0], GRID[0, 1] - GRID[0, 0]
    s, t = GAUSS[:, None], GAUSS[None, :]
    corners = GRID[:-1, :-1, None, None]
    x, y = partials(bend, corners + s * u + t * v)
    area = np.linalg.norm(np.cross(x, y), axis=-1) * abs((np.conj(u) * v).imag)
    total = np.einsum("ijkl,k,l->ij", area, WEIGHTS, WEIGHTS)
    assert np.abs(total - abs((np.conj(u) * v).imag)).max() < 1e-9


@each_map
def test_angles_of_curves_on_the_surface_are_those_asked_for(bend):
    u, v = GRID[1, 0] - GRID[0, 0], GRID[0, 1] - GRID[0, 0]
    x, y = partials(bend, GRID)
    curve = {k: d.real * x + d.imag * y for k, d in {"u": u, "v": v, 1: u - v, 2: u + v}.items()}
    for (a, b), asked in ((("u", "v"), T0), ((1, 2), T)):
        cross, inner = np.cross(curve[a], curve[b]), dot(curve[a], curve[b])
        angle = np.arctan2(np.linalg.norm(cross, axis=-1), inner)
        assert np.degrees(np.abs(angle - asked).max()) < 1e-9


@each_map
def test_the_gauss_curvature_vanishes(bend):
    h = 0.01
    x, y = partials(bend, GRID)
    normal = np.cross(x, y)

    def second(a, b):
        corner = [bend(GRID + i * a * h + j * b * h) * i * j for i in (1, -1) for j in (1, -1)]
        return dot(sum(corner), normal) / (4 * h * h)

    def third(a):
        weights = {0: -5 / 2, 1: 4 / 3, 2: -1 / 12}
        parts = [w * (bend(GRID + k * a * h) + bend(GRID - k * a * h)) for k, w in weights.items()]
        return dot(parts[1] + parts[2] + parts[0] / 2, normal) / h**2

    assert np.abs(third(1) * third(1j) - second(1, 1j) ** 2).max() < 2e-4


@each_map
def test_the_orientation_of_the_plane_survives(bend):
    V = bend(GRID).reshape(-1, 3)
    assert measure.quality(V, conformal.quads(GRID)[1]).flips == 0


@each_map
def test_points_of_the_plane_may_be_complex_or_real_and_of_any_shape(bend):
    z = GRID[:2, :3]
    whole = bend(z)
    assert whole.shape == (2, 3, 3)
    for i, j in ((0, 0), (1, 2)):
        assert np.allclose(bend(z[i, j]), whole[i, j], atol=1e-12)


def test_real_points_give_what_complex_ones_give():
    points = np.stack([GRID.real, GRID.imag], axis=-1)
    for bend in (
        lambda z: developable.roll(z, 0.5),
        lambda z: developable.cone(z, 1.0, -2),
        lambda z: developable.cylinder(z, DIRECTRIX, 1 + 0.2j),
    ):
        np.testing.assert_array_equal(bend(points + 0.5), bend(GRID + 0.5 + 0.5j))


# --- roll ---------------------------------------------------------------------------------


def test_curvature_0_is_exactly_flat():
    np.testing.assert_array_equal(
        developable.roll(GRID, 0), np.stack([GRID.real, GRID.imag, 0 * GRID.real], axis=-1)
    )


@given(st.floats(-1e-3, 1e-3))
def test_near_curvature_0_the_height_is_half_k_x_squared(curvature):
    x, y, height = np.moveaxis(developable.roll(GRID, curvature), -1, 0)
    turn = curvature * GRID.real
    np.testing.assert_allclose(x, GRID.real * (1 - turn**2 / 6), atol=1e-11)
    np.testing.assert_array_equal(y, GRID.imag)
    wanted = curvature * GRID.real**2 / 2 * (1 - turn**2 / 12 + turn**4 / 360)
    np.testing.assert_allclose(height, wanted, rtol=1e-12, atol=1e-300)


@pytest.mark.parametrize("curvature", [0.3, -2.0])
def test_rolled_points_lie_on_a_cylinder_of_that_radius(curvature):
    unit = np.exp(0.4j)
    x, y, height = np.moveaxis(developable.roll(3 * GRID, curvature, 5 * unit), -1, 0)
    across = ((x + 1j * y) * np.conj(unit)).real
    np.testing.assert_allclose(
        np.hypot(across, height - 1 / curvature), abs(1 / curvature), rtol=1e-12
    )


def test_the_cylinder_closes_at_a_full_turn():
    for direction in (1, np.exp(0.7j), -1j):
        width = direction * 2 * np.pi / 0.8
        ends = (
            developable.roll(GRID, 0.8, direction),
            developable.roll(GRID + width, 0.8, direction),
        )
        np.testing.assert_allclose(*ends, atol=1e-14)
        half = developable.roll(GRID + width / 2, 0.8, direction)
        assert np.linalg.norm(half - ends[0], axis=-1).min() == pytest.approx(2 / 0.8)


def test_a_straight_line_becomes_the_helix_in_closed_form():
    slope, curvature = np.radians(35), 0.9
    t = np.linspace(-4, 7, 50)
    points = developable.roll(t * np.exp(1j * slope), curvature)
    turn = curvature * np.cos(slope) * t
    wanted = np.sin(turn) / curvature, t * np.sin(slope), (1 - np.cos(turn)) / curvature
    np.testing.assert_allclose(points, np.stack(wanted, axis=-1), atol=1e-14)


def test_roll_coordinates_take_symbols():
    x, y, k = sympy.symbols("x y k", positive=True)
    X = sympy.Matrix(developable.roll_coordinates(x, y, k))
    J = X.jacobian([x, y])
    assert sympy.simplify(J.T * J - sympy.eye(2)) == sympy.zeros(2)
    values = {x: 0.3, y: 0.4, k: 2}
    found = [float(c.subs(values)) for c in X]
    np.testing.assert_allclose(found, developable.roll(0.3 + 0.4j, 2), rtol=1e-14)


# --- cones --------------------------------------------------------------------------------


def test_the_flat_cone_is_the_plane():
    points = developable.cone(GRID, np.pi / 2, -1 - 1j, 2j)
    np.testing.assert_allclose(points[..., 0] + 1j * points[..., 1], GRID, atol=1e-15)
    np.testing.assert_array_equal(points[..., 2], 0)


@pytest.mark.parametrize("gamma", [0.4, 1.3, 2.2])
def test_cone_points_have_their_distance_from_the_apex_and_the_half_angle(gamma):
    apex = -1 - 1j
    offset = developable.cone(GRID, gamma, apex) - [apex.real, apex.imag, 0]
    distance = np.linalg.norm(offset, axis=-1)
    np.testing.assert_allclose(distance, np.abs(GRID - apex), rtol=1e-13)
    np.testing.assert_allclose(offset[..., 2], distance * np.cos(gamma), rtol=1e-12)


def test_the_closed_sector_meets_itself():
    gamma = 0.5
    half = np.pi * np.sin(gamma)
    distance = np.linspace(0.2, 2, 7)
    edges = [distance * np.exp(1j * s * half) for s in (-1, 1)]
    both = developable.cone(np.array(edges), gamma)
    np.testing.assert_allclose(both[0], both[1], atol=1e-14)
    with pytest.raises(ValueError, match="overlap"):
        developable.cone(np.array(edges) * [[1], [np.exp(1e-6j)]], gamma)


def test_the_apex_stays():
    np.testing.assert_allclose(developable.cone(np.array([2 + 1j]), 0.7, 2 + 1j), [[2, 1, 0]])


# --- curves and the rectifying developable ------------------------------------------------


@pytest.mark.parametrize("turn", [1, -1])
def test_the_rectifying_developable_of_a_plane_curve_is_the_cylinder_over_it(turn):
    flat = np.array([[0, 0], [1, turn], [3, 2 * turn], [6, 2 * turn]])
    lifted = np.insert(flat, 1, 0, axis=1)  # in the plane of x and the height
    plane = developable.arc_length(developable.bezier(flat))
    space = developable.arc_length(developable.bezier(lifted))
    z = 1 + GRID
    wanted = developable.cylinder(z if turn > 0 else np.conj(z), plane)  # B is +y or -y
    np.testing.assert_allclose(developable.rectifying(z, space), wanted, atol=1e-11)


def test_turning_and_shifting_the_curve_turns_and_shifts_the_surface():
    turn, _ = np.linalg.qr(np.arange(9).reshape(3, 3) ** 1.5 + np.eye(3))
    turn *= np.linalg.det(turn)
    for points in (CONTROL, CONTROL * [1, 1, 0]):  # the second gives rulings all but parallel
        moved = developable.arc_length(developable.bezier(points @ turn.T + [1, 2, 3]))
        fixed = developable.arc_length(developable.bezier(points))
        found = developable.rectifying(GRID + 3 - 1j, moved)
        wanted = developable.rectifying(GRID + 3 - 1j, fixed) @ turn.T + [1, 2, 3]
        np.testing.assert_allclose(found, wanted, atol=1e-10)


@pytest.mark.parametrize("pitch", [0.5, -1.2, 0.0])
def test_the_rectifying_developable_of_a_helix_is_its_cylinder(pitch):
    curve = helix(0.7, pitch)
    points = developable.rectifying(0.6 * GRID + 1.6, curve)
    np.testing.assert_allclose(np.hypot(points[..., 0], points[..., 1]), 0.7, rtol=1e-11)
    cot, rate, _, _, kappa = developable.darboux(curve, np.linspace(0, 6, 9))
    np.testing.assert_allclose(cot, pitch / 0.7, atol=1e-13)
    np.testing.assert_allclose(rate, 0, atol=1e-12)
    np.testing.assert_allclose(kappa, 0.7 / (0.7**2 + pitch**2), rtol=1e-13)


def test_the_x_axis_becomes_the_curve_and_its_normal_is_that_of_the_surface():
    s = np.linspace(0.5, SPACE.length - 0.5, 30)
    np.testing.assert_allclose(developable.rectifying(s + 0j, SPACE), SPACE.point(s), atol=1e-12)
    x, y = partials(lambda z: developable.rectifying(z, SPACE), s + 0j)
    h = 1e-3
    bent = SPACE.point(s + h) - 2 * SPACE.point(s) + SPACE.point(s - h)
    normal, bent = np.cross(x, y), bent / np.linalg.norm(bent, axis=-1, keepdims=True)
    assert np.abs(np.cross(normal, bent)).max() < 1e-5
    assert (dot(normal, bent) < 0).all()  # T x B = -N


def test_darboux_agrees_with_frenet_by_differences():
    s, h = np.linspace(1, SPACE.length - 1, 9), 1e-3
    frames = {}
    for k in (-1, 0, 1):
        cot, _, T, B, kappa = developable.darboux(SPACE, SPACE.parameter(s + k * h))
        frames[k] = cot, T, B, kappa
    cot, T, B, kappa = frames[0]
    N = np.cross(B, T)
    change = {k: (frames[1][k] - frames[-1][k]) / (2 * h) for k in range(3)}
    np.testing.assert_allclose(change[1], kappa[:, None] * N, atol=1e-6)
    np.testing.assert_allclose(change[2], -(cot * kappa)[:, None] * N, atol=1e-6)
    rate = developable.darboux(SPACE, SPACE.parameter(s))[1]
    np.testing.assert_allclose(change[0], rate, atol=1e-6)


def test_rulings_stay_straight():
    s, reach = 4.0, np.linspace(-2, 2, 9)
    cot, _, _, _, _ = (
        float(np.ravel(a)[0]) for a in developable.darboux(SPACE, SPACE.parameter(s))
    )
    line = developable.rectifying(s + reach * (cot + 1j), SPACE)
    steps = np.diff(line, axis=0)
    np.testing.assert_allclose(steps, np.broadcast_to(steps[0], steps.shape), atol=1e-11)
    assert np.linalg.norm(steps[0]) == pytest.approx(abs(cot + 1j) / 2, rel=1e-12)


TWISTED = developable.arc_length(
    developable.bezier([[0, 0, 0], [2, 3, 0], [3, -1, 2], [7, 1, 3.0]])
)


def reaches(z, curve):
    """Whether one plane point lies on the surface; if not, for which reason."""
    try:
        developable.rectifying(np.array([z]), curve)
    except ValueError as error:
        assert "grid point (0,) lies behind the edge of regression" in str(error)
        return False
    return True


@pytest.mark.parametrize("x, side", [(2, -1), (3, -1), (3.2, -1), (4, 1), (5, 1), (6, 1)])
def test_a_vertical_line_leaves_the_surface_at_the_edge_of_regression(x, side):
    low, high = 0.0, 8.0
    assert not reaches(x + side * high * 1j, TWISTED)
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (middle, high) if reaches(x + side * middle * 1j, TWISTED) else (low, middle)
    s = np.linspace(0.5, TWISTED.length - 0.5, 200_001)
    edge, _ = developable.regression(TWISTED, s)
    edge = edge[edge.imag * side > 0]
    near = np.argsort(np.abs(edge.real - x))[:200]
    assert np.abs(edge.imag[near] - side * low).min() < 1e-3


def test_the_other_side_of_the_curve_has_no_edge_here():
    V = developable.rectifying(
        np.array([[2 + 3j, 3 + 3j, 3.4 + 3j], [4 - 3j, 5 - 3j, 6 - 3j]]), TWISTED
    )
    assert np.isfinite(V).all()


def test_the_first_offending_grid_point_is_named():
    z = np.linspace(4.5, 5.5, 12).reshape(3, 4) + 0j
    z[1, 2] += 2j
    z[2, 0] += 7j
    with pytest.raises(ValueError, match=r"grid point \(1, 2\) lies behind"):
        developable.rectifying(z, TWISTED)


def test_the_edge_of_regression_is_tangent_to_the_rulings():
    s, h = np.linspace(3.9, 4.5, 5), 1e-4
    _, before = developable.regression(TWISTED, s - h)
    _, after = developable.regression(TWISTED, s + h)
    cot, _, T, B, _ = developable.darboux(TWISTED, TWISTED.parameter(s))
    ruling, moved = cot[:, None] * T + B, after - before
    cosine = dot(ruling, moved) / np.linalg.norm(ruling, axis=1) / np.linalg.norm(moved, axis=1)
    np.testing.assert_allclose(np.abs(cosine), 1, atol=1e-6)


def test_cylinders_have_no_edge_of_regression():
    z, points = developable.regression(helix(), np.array([1.0, 2.0]))
    assert np.isnan(z).all() and np.isnan(points).all()


# --- measuring, chords --------------------------------------------------------------------


def test_tangent_differentiates_to_twelve_digits():
    found = developable.tangent(lambda z: developable.roll(z, 0.8), GRID, 2 + 1j)
    turn = 0.8 * GRID.real
    wanted = np.stack([2 * np.cos(turn), 1 + 0 * turn, 2 * np.sin(turn)], axis=-1)
    np.testing.assert_allclose(found, wanted, atol=1e-12)


@given(st.floats(0.35, 2.8), st.floats(0.35, 2.8), st.floats(-3, 3))
def test_rolled_grids_are_exact_isogonal_nets(theta, theta0, turn):
    z = developable.rolled_grid(theta, theta0, 4, 3, 0.5, 1j, 0.3, np.exp(1j * turn))
    V, Q = developable.roll(z, 0.5).reshape(-1, 3), conformal.quads(z)[1]
    off = np.array(measure.angles(V, Q)) - [[theta], [theta0]]
    assert np.degrees(np.abs(off).max()) < 1e-9


def test_a_closed_rolled_grid_closes_and_tends_to_the_sheared_one():
    changes = []
    for m in (12, 24):
        edge = 2 * np.pi / m
        z = developable.rolled_grid(T, T0, m, 4, 1.0, edge=edge)
        points = developable.roll(z, 1)
        np.testing.assert_allclose(points[0], points[-1], atol=1e-13)
        plain = conformal.sheared_grid(T, T0, m, 4, edge=edge)
        changes.append(abs(z - plain).max() / edge)
        assert changes[-1] > 1e-3
    assert changes[0] / changes[1] == pytest.approx(4, rel=0.05)


def test_rolled_grids_of_curvature_0_are_sheared_grids():
    np.testing.assert_allclose(
        developable.rolled_grid(T, T0, 3, 2, 0, 1 + 2j, 0.5, 1j),
        conformal.sheared_grid(T, T0, 3, 2, 1 + 2j, 0.5, 1j),
        atol=1e-13,
    )


def test_plainly_rolled_grids_have_congruent_faces_a_little_off():
    z = conformal.sheared_grid(T, T0, 12, 5, edge=2 * np.pi / 12)
    theta, theta0 = measure.angles(developable.roll(z, 1).reshape(-1, 3), conformal.quads(z)[1])
    assert np.ptp(theta) < 1e-12 and np.ptp(theta0) < 1e-12
    assert 0.1 < np.degrees(theta[0] - T) < 3


# --- errors -------------------------------------------------------------------------------

NAN = np.array([[0, 1], [1j, np.nan]])
STRAIGHT = developable.arc_length(developable.bezier([[0, 0, 0], [1, 1, 1], [3, 3, 3.0]]))
INFLECTED = developable.arc_length(
    developable.bezier([[0, 0, 0], [1, 2, 0], [3, -2, 0], [4, 0, 0.0]])
)
WRONG = {
    "nan": (lambda: developable.roll(NAN, 1), r"grid point \(1, 1\) is not a finite"),
    "words": (lambda: developable.roll(["a"], 1), "complex numbers or real points"),
    "triples": (lambda: developable.roll(np.zeros((4, 3)), 1), "complex numbers or real points"),
    "empty": (lambda: developable.cone(np.zeros(0, complex), 1), "at least one"),
    "curvature": (lambda: developable.roll(GRID, np.inf), "curvature = inf"),
    "direction": (lambda: developable.roll(GRID, 1, 0), "direction = 0"),
    "gamma": (lambda: developable.cone(GRID, np.pi), "gamma = 3.14"),
    "gamma nan": (lambda: developable.cone(GRID, np.nan), "gamma = nan"),
    "apex": (lambda: developable.cone(GRID, 1, np.inf), "apex = inf"),
    "overlap": (lambda: developable.cone(GRID, 0.1, 0.5 + 0.5j), "overlap"),
    "space directrix": (lambda: developable.cylinder(GRID, SPACE), "3 coordinates: 2 are wanted"),
    "plane geodesic": (lambda: developable.rectifying(GRID, DIRECTRIX), "2 coordinates: 3"),
    "past the end": (lambda: developable.cylinder(GRID + 9, DIRECTRIX), r"point \(\d, \d\) asks"),
    "past the last ruling": (
        lambda: developable.rectifying(SPACE.length - 0.01 + np.array([0, -3j]), SPACE),
        r"grid point \(1,\) lies beyond the last ruling",
    ),
    "straight": (lambda: developable.rectifying(GRID, STRAIGHT), "curvature vanishes near"),
    "inflection": (lambda: developable.rectifying(GRID, INFLECTED), "curvature vanishes near"),
    "counts": (lambda: developable.rolled_grid(T, T0, 0, 3, 1), "m = 0"),
    "edge": (lambda: developable.rolled_grid(T, T0, 3, 3, 1, edge=4), "edge = 4"),
    "curved": (lambda: developable.rolled_grid(T, T0, 3, 3, np.nan), "curvature = nan"),
    "misfit": (
        lambda: developable.rolled_grid(
            np.radians(120), np.radians(90), 3, 3, 1, edge=2, direction=1j
        ),
        "no face with these angles",
    ),
}


@pytest.mark.parametrize("call, message", WRONG.values(), ids=WRONG)
def test_bad_input_is_a_clear_error(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_the_ends_of_a_plane_arc_carry_points_whatever_the_rounding():
    z = np.add.outer([0.0, 1.1 * 1.3], 1j * np.array([-0.7, -0.3, 0.1, 0.3]))
    for seed in range(6):
        axes = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))[0]

        def arc(t, k=0, axes=axes):
            turned = np.asarray(t, dtype=float) + k * np.pi / 2
            return 1.3 * (np.cos(turned)[..., None] * axes[0] + np.sin(turned)[..., None] * axes[1])

        found = developable.rectifying(z, developable.arc_length(arc, 0.0, 1.1))
        side = np.cross(axes[0], axes[1])
        wanted = np.stack([arc(t) + z.imag[0][:, None] * side for t in (0.0, 1.1)])
        np.testing.assert_allclose(found, wanted, atol=1e-9)
