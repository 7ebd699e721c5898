"""`developable` against closed forms, fundamental forms by differences, and integrals."""

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.integrate import quad

from inetlib import conformal, developable, measure

T, T0 = np.radians(60), np.radians(45)
GRID = conformal.sheared_grid(T, T0, 5, 4, edge=0.4, direction=np.exp(0.3j))
CONTROL = np.array([[0, 0, 0], [3, 0, 0], [6, 3, 1], [6, 6, 3.0]])
PLANE_CONTROL = np.array([[0, 0], [1, 2], [3, -1], [5, 1.0]])
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


def bezier(points):
    return developable.arc_length(developable.bezier(points))


SPACE, DIRECTRIX = bezier(CONTROL), bezier(PLANE_CONTROL)
TWISTED = bezier([[0, 0, 0], [2, 3, 0], [3, -1, 2], [7, 1, 3.0]])
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


def stretch(bend, z):
    """How far the first fundamental form is from that of the plane."""
    x, y = partials(bend, z)
    return np.abs([dot(x, x) - 1, dot(x, y), dot(y, y) - 1]).max()


@each_map
def test_the_first_fundamental_form_is_that_of_the_plane(bend):
    assert stretch(bend, GRID) < 1e-9


@given(st.floats(-3, 3), st.floats(0.35, 2.8), st.floats(-4, 4))
def test_the_form_is_constant_through_the_families_of_cylinders_and_cones(curvature, gamma, turn):
    assert stretch(lambda z: developable.roll(z, curvature, np.exp(1j * turn)), GRID) < 1e-9
    apex, direction = -3 * np.exp(0.7j), np.exp(0.7j)
    assert stretch(lambda z: developable.cone(z, gamma, apex, direction), GRID) < 1e-9


@pytest.mark.parametrize("part", np.linspace(0, 1, 9))
def test_the_form_is_constant_while_control_points_move(part):
    moved = (1 - part) * CONTROL + part * np.array([[0, 0, 0], [2, 1, 0], [5, 4, -1], [5, 7, 4]])
    curve = bezier(moved)
    assert stretch(lambda z: developable.rectifying(z, curve), GRID[:3, :2] + 3.5 - 0.3j) < 1e-9


@each_map
def test_orientation_shape_and_kind_of_the_points_do_not_matter(bend):
    V = bend(GRID)
    assert measure.quality(V.reshape(-1, 3), conformal.quads(GRID)[1]).flips == 0
    assert np.allclose(bend(GRID[1, 2]), V[1, 2], atol=1e-12)
    points = np.stack([GRID.real, GRID.imag], axis=-1)
    np.testing.assert_array_equal(developable.roll(points, 0.5), developable.roll(GRID, 0.5))


def test_flat_ends_are_the_plane():
    plane = np.stack([GRID.real, GRID.imag, 0 * GRID.real], axis=-1)
    np.testing.assert_array_equal(developable.roll(GRID, 0), plane)
    flat = developable.cone(GRID, np.pi / 2, -1 - 1j, 2j)
    np.testing.assert_allclose(flat, plane, atol=1e-15)
    np.testing.assert_array_equal(flat[..., 2], 0)
    np.testing.assert_allclose(developable.cone(np.array([2 + 1j]), 0.7, 2 + 1j), [[2, 1, 0]])


@given(st.floats(-1e-3, 1e-3))
def test_near_curvature_0_the_height_is_half_k_x_squared(curvature):
    x, y, height = np.moveaxis(developable.roll(GRID, curvature), -1, 0)
    turn = curvature * GRID.real
    np.testing.assert_allclose(x, GRID.real * (1 - turn**2 / 6), atol=1e-11)
    np.testing.assert_array_equal(y, GRID.imag)
    wanted = curvature * GRID.real**2 / 2 * (1 - turn**2 / 12 + turn**4 / 360)
    np.testing.assert_allclose(height, wanted, rtol=1e-12, atol=1e-300)


def test_the_cylinder_closes_at_a_full_turn():
    for direction in (1, np.exp(0.7j), -1j):
        width = direction * 2 * np.pi / 0.8
        start, half, end = (developable.roll(GRID + k * width, 0.8, direction) for k in (0, 0.5, 1))
        np.testing.assert_allclose(start, end, atol=1e-14)
        assert np.linalg.norm(half - start, axis=-1).min() == pytest.approx(2 / 0.8)


def test_a_straight_line_becomes_the_helix_in_closed_form():
    slope, curvature = np.radians(35), 0.9
    t = np.linspace(-4, 7, 50)
    points = developable.roll(t * np.exp(1j * slope), curvature)
    turn = curvature * np.cos(slope) * t
    wanted = np.sin(turn) / curvature, t * np.sin(slope), (1 - np.cos(turn)) / curvature
    np.testing.assert_allclose(points, np.stack(wanted, axis=-1), atol=1e-14)


def test_roll_coordinates_take_symbols_and_tangent_differentiates_to_twelve_digits():
    x, y, k = sympy.symbols("x y k", positive=True)
    X = sympy.Matrix(developable.roll_coordinates(x, y, k))
    J = X.jacobian([x, y])
    assert sympy.simplify(J.T * J - sympy.eye(2)) == sympy.zeros(2)
    values = {x: 0.3, y: 0.4, k: 2}
    found = [float(c.subs(values)) for c in X]
    np.testing.assert_allclose(found, developable.roll(0.3 + 0.4j, 2), rtol=1e-14)
    found = developable.tangent(lambda z: developable.roll(z, 0.8), GRID, 2 + 1j)
    turn = 0.8 * GRID.real
    wanted = np.stack([2 * np.cos(turn), 1 + 0 * turn, 2 * np.sin(turn)], axis=-1)
    np.testing.assert_allclose(found, wanted, atol=1e-12)


@pytest.mark.parametrize("gamma", [0.4, 1.3, 2.2])
def test_cones_have_their_distances_their_half_angle_and_closed_sectors(gamma):
    apex = -1 - 1j
    offset = developable.cone(GRID, gamma, apex) - [apex.real, apex.imag, 0]
    distance = np.linalg.norm(offset, axis=-1)
    np.testing.assert_allclose(distance, np.abs(GRID - apex), rtol=1e-13)
    np.testing.assert_allclose(offset[..., 2], distance * np.cos(gamma), rtol=1e-12)
    end = np.linspace(0.2, 2, 7) * np.exp(1j * np.pi * np.sin(gamma))
    edges = np.stack([end.conj(), end])
    np.testing.assert_allclose(*developable.cone(edges, gamma), atol=1e-14)
    with pytest.raises(ValueError, match="overlap"):
        developable.cone(edges * [[1], [np.exp(1e-6j)]], gamma)


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("kept", [[0, 1, 2, 3], [0, 1, 3]], ids=["cubic", "parabola"])
def test_the_rectifying_developable_of_a_plane_curve_is_the_cylinder_over_it(turn, kept):
    flat = np.array([[0, 0], [1, turn], [3, 2 * turn], [6, 2 * turn]])[kept]
    lifted = np.insert(flat, 1, 0, axis=1)  # in the plane of x and the height
    z = 1 + GRID
    wanted = developable.cylinder(z if turn > 0 else np.conj(z), bezier(flat))  # B is +y or -y
    np.testing.assert_allclose(developable.rectifying(z, bezier(lifted)), wanted, atol=1e-11)


def test_turning_and_shifting_the_curve_turns_and_shifts_the_surface():
    turn, _ = np.linalg.qr(np.arange(9).reshape(3, 3) ** 1.5 + np.eye(3))
    turn *= np.linalg.det(turn)
    for points in (CONTROL, CONTROL * [1, 1, 0]):  # the second gives rulings all but parallel
        moved = bezier(points @ turn.T + [1, 2, 3])
        fixed = bezier(points)
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


def test_the_x_axis_becomes_the_curve_with_the_surface_normal_and_rulings_stay_straight():
    s = np.linspace(0.5, SPACE.length - 0.5, 30)
    np.testing.assert_allclose(developable.rectifying(s + 0j, SPACE), SPACE.point(s), atol=1e-12)
    x, y = partials(lambda z: developable.rectifying(z, SPACE), s + 0j)
    h = 1e-3
    bent = SPACE.point(s + h) - 2 * SPACE.point(s) + SPACE.point(s - h)
    normal, bent = np.cross(x, y), bent / np.linalg.norm(bent, axis=-1, keepdims=True)
    assert np.abs(np.cross(normal, bent)).max() < 1e-5
    assert (dot(normal, bent) < 0).all()  # T x B = -N
    s, reach = 4.0, np.linspace(-2, 2, 9)
    cot = developable.darboux(SPACE, SPACE.parameter(s))[0]
    line = developable.rectifying(s + reach * (cot + 1j), SPACE)
    steps = np.diff(line, axis=0)
    np.testing.assert_allclose(steps, np.broadcast_to(steps[0], steps.shape), atol=1e-11)
    assert np.linalg.norm(steps[0]) == pytest.approx(abs(cot + 1j) / 2, rel=1e-12)


def test_darboux_agrees_with_frenet_by_differences():
    s, h = np.linspace(1, SPACE.length - 1, 9), 1e-3
    at = (SPACE.parameter(s + k * h) for k in (-1, 0, 1))
    before, now, after = (developable.darboux(SPACE, t) for t in at)
    cot, rate, T, B, kappa = now
    N = np.cross(B, T)
    change = [(b - a) / (2 * h) for a, b in zip(before, after, strict=True)]
    np.testing.assert_allclose(change[0], rate, atol=1e-6)
    np.testing.assert_allclose(change[2], kappa[:, None] * N, atol=1e-6)
    np.testing.assert_allclose(change[3], -(cot * kappa)[:, None] * N, atol=1e-6)


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
    s = np.linspace(0.5, TWISTED.length - 0.5, 50_001)
    edge, _ = developable.regression(TWISTED, s)
    edge = edge[edge.imag * side > 0]
    near = np.argsort(np.abs(edge.real - x))[:50]
    assert np.abs(edge.imag[near] - side * low).min() < 1e-3


def test_the_first_offending_grid_point_is_named_and_the_other_side_has_none():
    z = np.linspace(4.5, 5.5, 12).reshape(3, 4) + 0j
    z[1, 2] += 2j
    z[2, 0] += 7j
    with pytest.raises(ValueError, match=r"grid point \(1, 2\) lies behind"):
        developable.rectifying(z, TWISTED)
    z = np.array([[2 + 3j, 3 + 3j, 3.4 + 3j], [4 - 3j, 5 - 3j, 6 - 3j]])
    assert np.isfinite(developable.rectifying(z, TWISTED)).all()


def test_the_edge_of_regression_is_tangent_to_the_rulings_and_cylinders_have_none():
    s, h = np.linspace(3.9, 4.5, 5), 1e-4
    _, before = developable.regression(TWISTED, s - h)
    _, after = developable.regression(TWISTED, s + h)
    cot, _, T, B, _ = developable.darboux(TWISTED, TWISTED.parameter(s))
    ruling, moved = cot[:, None] * T + B, after - before
    cosine = dot(ruling, moved) / np.linalg.norm(ruling, axis=1) / np.linalg.norm(moved, axis=1)
    np.testing.assert_allclose(np.abs(cosine), 1, atol=1e-6)
    z, points = developable.regression(helix(), np.array([1.0, 2.0]))
    assert np.isnan(z).all() and np.isnan(points).all()


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


@given(arrays(float, (4, 3), elements=st.floats(-9, 9)), st.floats(0, 1))
def test_cubic_bezier_curves_and_their_derivatives(points, t):
    a, b, c, d = points
    s = 1 - t
    curve = developable.bezier(points)
    value = s**3 * a + 3 * s**2 * t * b + 3 * s * t**2 * c + t**3 * d
    first = 3 * (s**2 * (b - a) + 2 * s * t * (c - b) + t**2 * (d - c))
    second = 6 * (s * (c - 2 * b + a) + t * (d - 2 * c + b))
    third = 6 * (d - 3 * c + 3 * b - a)
    for k, wanted in enumerate((value, first, second, third, 0 * third, 0 * third)):
        np.testing.assert_allclose(curve(t, k), wanted, atol=1e-11)


@pytest.mark.parametrize("points", [CONTROL, CONTROL[:, :2], CONTROL[:2], CONTROL[[0, 2, 1, 3]]])
def test_arc_lengths_agree_with_adaptive_quadrature(points):
    position, curve = developable.bezier(points), bezier(points)
    for t in (0.3, 0.8, 1.0):
        length = quad(lambda x: np.linalg.norm(position(x, 1)), 0, t, epsabs=1e-13, limit=200)[0]
        assert curve.integral(t) == pytest.approx(length, abs=1e-11)
    assert curve.length == pytest.approx(length, abs=1e-11)
    assert bezier(1e6 * points).length == pytest.approx(1e6 * curve.length, rel=1e-13)
    ends = curve.point(np.array([0, curve.length]))
    np.testing.assert_allclose(ends, points[[0, -1]], atol=1e-12)


def test_a_circle_by_a_strange_parameter():
    def position(t, k=0):
        turn, size = np.exp(t) + k * np.pi / 2, np.exp(k * t)  # enough for k = 0 and 1
        return size[..., None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)

    curve = developable.arc_length(position, 0.0, 1.5)
    assert curve.length == pytest.approx(np.exp(1.5) - 1, abs=1e-12)
    s = np.linspace(0, curve.length, 9)
    wanted = np.stack([np.cos(1 + s), np.sin(1 + s)], axis=-1)
    np.testing.assert_allclose(curve.point(s), wanted, atol=1e-12)
    s = np.linspace(0.1, SPACE.length - 0.1, 50)
    np.testing.assert_allclose(SPACE.integral(SPACE.parameter(s)), s, atol=1e-12)


@given(st.floats(0.35, 2.8), st.floats(0.35, 2.8), st.floats(-3, 3))
def test_rolled_grids_are_exact_isogonal_nets(theta, theta0, turn):
    z = developable.rolled_grid(theta, theta0, 4, 3, 0.5, 1j, 0.3, np.exp(1j * turn))
    V, Q = developable.roll(z, 0.5).reshape(-1, 3), conformal.quads(z)[1]
    assert np.degrees(np.abs(measure.deviations(V, Q, theta, theta0)).max()) < 1e-9


def test_rolled_grids_close_tend_to_sheared_ones_and_are_sheared_ones_at_curvature_0():
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
    flat = developable.rolled_grid(T, T0, 3, 2, 0, 1 + 2j, 0.5, 1j)
    plain = conformal.sheared_grid(T, T0, 3, 2, 1 + 2j, 0.5, 1j)
    np.testing.assert_allclose(flat, plain, atol=1e-13)


NAN = np.array([[0, 1], [1j, np.nan]])
INFLECTED = [[0, 0, 0], [1, 2, 0], [3, -2, 0], [4, 0, 0.0]]
SHEET = T, T0, 3, 3
LAST = SPACE.length - 0.01 + np.array([0, -3j])
WRONG = [
    (developable.roll, (NAN, 1), r"grid point \(1, 1\) is not a finite"),
    (developable.roll, (["a"], 1), "complex numbers or real points"),
    (developable.roll, (np.zeros((4, 3)), 1), "complex numbers or real points"),
    (developable.cone, (np.zeros(0, complex), 1), "at least one"),
    (developable.roll, (GRID, np.inf), "curvature = inf"),
    (developable.roll, (GRID, 1, 0), "direction = 0"),
    (developable.cone, (GRID, np.pi), "gamma = 3.14"),
    (developable.cone, (GRID, np.nan), "gamma = nan"),
    (developable.cone, (GRID, 1, np.inf), "apex = inf"),
    (developable.cone, (GRID, 0.1, 0.5 + 0.5j), "overlap"),
    (developable.cylinder, (GRID, SPACE), "3 coordinates: 2 are wanted"),
    (developable.cylinder, (GRID + 9, DIRECTRIX), r"point \(\d, \d\) asks"),
    (developable.rectifying, (GRID, DIRECTRIX), "2 coordinates: 3"),
    (developable.rectifying, (LAST, SPACE), r"grid point \(1,\) lies beyond the last ruling"),
    (developable.rectifying, (GRID, bezier([[0, 0, 0], [3, 3, 3.0]])), "curvature vanishes near"),
    (developable.rectifying, (GRID, bezier(INFLECTED)), "curvature vanishes near"),
    (developable.rolled_grid, (T, T0, 0, 3, 1), "m = 0"),
    (developable.rolled_grid, (*SHEET, 1, 0, 4), "edge = 4"),
    (developable.rolled_grid, (*SHEET, np.nan), "curvature = nan"),
    (developable.rolled_grid, (2 * T, 2 * T0, 3, 3, 1, 0, 2, 1j), "no face with these angles"),
    (developable.bezier, ([[0, 0, 0]],), "at least two control points"),
    (developable.bezier, ([[0, 0, 0, 0], [1, 1, 1, 1]],), "at least two control points"),
    (developable.bezier, ([[0, 0], [1, np.inf]],), "not a finite number"),
    (developable.arc_length, (developable.bezier(CONTROL), 1, 0), "start < stop"),
    (bezier, (0 * CONTROL,), "cusp"),
    (bezier, ([[0, 0], [1, 1], [0, 1], [1, 0]],), "cusp"),
    (SPACE.point, ([0, 99.0],), r"grid point \(1,\) asks for arc length 99 on a curve of .* 9\.9"),
]


@pytest.mark.parametrize("call, arguments, message", WRONG)
def test_bad_input_is_a_clear_error(call, arguments, message):
    with pytest.raises(ValueError, match=message):
        call(*arguments)
