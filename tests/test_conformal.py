"""`conformal` against complex arguments, directly mapped points and the printed formulas."""

import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from inetlib import conformal, measure, mesh, parallelogram, surfaces
from inetlib.drawings import beyond_planar, fig03

T, T0 = np.radians(60), np.radians(45)
angle = st.floats(0.1, np.pi - 0.1)
part = st.floats(-5, 5)
point = st.builds(complex, part, part)


def diagonals(z):
    """d1, d2 of every cell, from the top left corner counter-clockwise."""
    return z[1:, :-1] - z[:-1, 1:], z[1:, 1:] - z[:-1, :-1]


def deviation(f, theta=T, theta0=T0, m=6, n=5, **grid):
    """Largest deviation from (theta, theta0) in degrees, by complex arguments.

    An argument has a sign: a cell turned over would show."""
    d1, d2 = diagonals(f(conformal.sheared_grid(theta, theta0, m, n, **grid)))
    found = np.stack([np.angle(d2 / d1), np.angle((d2 - d1) / (d1 + d2))])
    return np.degrees(np.abs(found - [[[theta]], [[theta0]]]).max())


@given(angle)
def test_shear_is_the_printed_matrix_and_tilts_the_vertical_to_theta0(theta0):
    x, y = np.array([[0.3, -1], [2, 0]]), np.array([[0.7, 0.1], [-1.5, 0]])
    found = conformal.shear(x + 1j * y, theta0)
    np.testing.assert_allclose(found, x + y / np.tan(theta0) + 1j * y)
    assert np.angle(conformal.shear(1j, theta0)) == pytest.approx(theta0, rel=1e-12)


@given(angle, angle)
def test_cells_of_a_sheared_grid_have_the_angles_asked_for(theta, theta0):
    z = conformal.sheared_grid(theta, theta0, 3, 2)
    assert z.shape == (4, 3)
    u, v = z[1:, :] - z[:-1, :], z[:, 1:] - z[:, :-1]
    np.testing.assert_allclose(u, 1, rtol=1e-12)
    np.testing.assert_allclose(v, v[0, 0], rtol=1e-9)
    u, v = u[0, 0], v[0, 0]
    assert np.angle(v / u) == pytest.approx(theta0, rel=1e-9)
    assert np.angle((u + v) / (u - v)) == pytest.approx(theta, rel=1e-9)


ISOTHERMAL = [surfaces.SPHERE, surfaces.CATENOID, surfaces.HELICOID, surfaces.conjugate(0.7)]


def test_b3_every_isothermal_net_gives_i_nets_of_any_angles_and_others_do_not():
    rng = np.random.default_rng(3)
    for theta, theta0 in rng.uniform(0.3, np.pi - 0.3, (25, 2)):
        (start, up), (right, _) = conformal.sheared_grid(theta, theta0, 1, 1, direction=2 - 1j)
        a, b = right - start, up - start
        u, v = rng.uniform(-1, 1, (2, 20))
        for surface in (*ISOTHERMAL, surfaces.rotational(lambda t: (2 + np.cos(t), 0, np.sin(t)))):

            def net(u, v, surface=surface, a=a, b=b):
                return surface.coordinates((u * a + v * b).real, (u * a + v * b).imag)

            lam, mu = surfaces.ratios(surfaces.Surface("", net), u, v)
            if surface in ISOTHERMAL:
                np.testing.assert_allclose(lam * np.exp(1j * theta), (a + b) / (a - b), rtol=1e-8)
                np.testing.assert_allclose(np.exp(1j * theta0) / mu, b / a, rtol=1e-8)
            else:
                assert np.ptp(lam) > 1e-3 and np.ptp(mu) > 1e-3


def test_b3_conversely_constant_ratios_make_linear_parameters_isothermal():
    """By symbols, for any surface: E and F follow from G and the ratios; x, y as in B3."""
    lam, mu, E, F, G = sympy.symbols("lam mu E F G", positive=True)
    net = {E: mu**2 * G}
    (net[F],) = sympy.solve((E + 2 * F + G - lam**2 * (E - 2 * F + G)).subs(net), F)
    c = sympy.Symbol("c", real=True)  # cos theta0
    s = sympy.sqrt(1 - c**2)
    one, two = (1, 0), (-c / s, mu / s)  # X_x and X_y, for u = x - y cot theta0, v = y mu / sin

    def product(a, b):
        whole = a[0] * b[0] * E + (a[0] * b[1] + a[1] * b[0]) * F + a[1] * b[1] * G
        return sympy.simplify(whole.subs(net).subs(c, net[F] / (mu * G)))

    assert product(one, two) == 0
    assert sympy.simplify(product(two, two) - product(one, one)) == 0
    assert sympy.simplify(net[F] / (mu * G) - parallelogram.cosines(lam, mu)[1]) == 0


@given(angle, angle, point, st.floats(0.01, 100), point)
def test_origin_edge_and_direction_are_kept(theta, theta0, origin, edge, direction):
    assume(abs(direction) > 0.01)
    z = conformal.sheared_grid(theta, theta0, 2, 3, origin, edge, direction)
    assert z[0, 0] == origin
    u, v = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0]
    assert u == pytest.approx(edge * direction / abs(direction), rel=1e-9, abs=1e-12)
    assert np.angle(v / u) == pytest.approx(theta0, abs=1e-9)
    np.testing.assert_allclose(z, z[:1, :] + z[:, :1] - origin, atol=1e-12 * (9 + 9 * abs(v)))


def test_compensated_cells_tend_to_plain_ones():
    plain = conformal.sheared_grid(T, T0, 1, 1, edge=1e-3)
    for kappa in (1, -1, 2 + 1j):
        bent = conformal.sheared_grid(T, T0, 1, 1, edge=1e-3, kappa=kappa)
        assert 1e-11 < abs(bent - plain).max() < 1e-8


def test_quads_put_point_i_j_at_vertex_i_times_n_plus_1_plus_j_and_complex_ratios_are_measured():
    z = np.array([[10 * i + 1j * j for j in range(4)] for i in range(3)])
    V, Q = conformal.quads(z)
    np.testing.assert_array_equal(V[1 * 4 + 3], [10, 3, 0])
    np.testing.assert_array_equal(V[:, 0] + 1j * V[:, 1], z.ravel())
    np.testing.assert_array_equal(V[Q[0]][:, :2], [[0, 1], [0, 0], [10, 0], [10, 1]])
    assert len(Q) == 6
    mesh.check(V, Q)
    rng = np.random.default_rng(4)
    z = np.add.outer(np.arange(5), 1j * np.arange(4)) + rng.uniform(-0.2, 0.2, (5, 4, 2)) @ [1, 1j]
    K, R = conformal.complex_ratios(z)
    lam, mu = measure.ratios(*conformal.quads(z))
    theta, theta0 = measure.angles(*conformal.quads(z))
    np.testing.assert_allclose(K.ravel(), lam * np.exp(1j * theta), rtol=1e-12)
    np.testing.assert_allclose(R.ravel(), np.exp(1j * theta0) / mu, rtol=1e-12)


C = 0.7 + 0.4j
EXACT = {
    "exp": (np.exp, 1),
    "sinh": (np.sinh, 1),
    "cosh": (np.cosh, 1),
    "sin": (np.sin, -1),
    "cos": (np.cos, -1),
    "exp(cz)": (lambda z: np.exp(C * z), C**2),
    "2 exp(cz) - exp(-cz) + 3": (lambda z: 2 * np.exp(C * z) - np.exp(-C * z) + 3, C**2),
    "z": (lambda z: z, 0),
    "z^2": (lambda z: z**2, 0),
    "z^2 + (3 - i) z": (lambda z: z**2 + (3 - 1j) * z, 0),
}


@pytest.mark.parametrize("edge", [0.05, 0.4, 1.5])
@pytest.mark.parametrize("name", EXACT)
def test_images_are_isogonal_to_1e_10_degrees_at_any_mesh_size_under(name, edge):
    f, kappa = EXACT[name]
    for theta, theta0 in np.radians([(60, 45), (80, 45), (50, 50), (110, 70)]):
        for direction in (1, 1j, 2 - 1j):
            grid = dict(edge=edge, origin=0.3 + 0.2j, direction=direction)
            assert deviation(f, theta, theta0, kappa=kappa, **grid) < 1e-10
    if kappa:  # the wrong one is noticed
        assert deviation(f, edge=edge, kappa=-kappa) > 1e-3


def test_the_image_of_a_plain_grid_under_exp_has_constant_but_shifted_angles():
    shifts = []
    for edge in (0.2, 0.1):
        z = conformal.sheared_grid(T, T0, 6, 6, edge=edge)
        d1, d2 = diagonals(np.exp(z))
        u, v = z[1, 0], z[0, 1]
        K = np.sinh((u + v) / 2) / np.sinh((u - v) / 2)
        np.testing.assert_allclose(d2 / d1, K, rtol=1e-11)
        shifts.append(np.degrees(abs(np.angle(K) - T)))
    assert shifts[0] > 0.1
    assert 3.9 < shifts[0] / shifts[1] < 4.1


def test_images_under_1_over_z_approach_the_angles_with_the_square_of_the_mesh_size():
    off = []
    for n in (4, 10, 20, 40):
        z = conformal.sheared_grid(T, T0, n, n, origin=1 + 1j, edge=1 / n)
        d1, d2 = diagonals(1 / z)
        off.append(np.abs(np.angle(d2 / d1) - T).max())
        u, v, middle = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0], (z[:-1, :-1] + z[1:, 1:]) / 2
        p, q = (u + v) / 2, (u - v) / 2
        closed = p / q * (middle**2 - q**2) / (middle**2 - p**2)  # at any mesh size
        np.testing.assert_allclose(d2 / d1, closed, rtol=1e-11)
    assert np.degrees(off[1]) > 0.1
    assert 3.6 < off[1] / off[2] < 4.2
    assert 3.8 < off[2] / off[3] < 4.1


@given(point, point)
def test_mapped_points_lie_on_the_inversion_circle_and_the_square_conic_which_is_a_parabola(
    start, direction
):
    assume(abs(direction) > 0.1 and abs(np.imag(np.conj(direction) * start)) > 0.05)
    centre, radius = conformal.inversion_circle(start, direction)
    mapped = 1 / (start + direction * np.linspace(-3, 3, 13))
    np.testing.assert_allclose(abs(mapped - centre), radius, rtol=1e-8)
    assume(abs(direction) > 0.1)
    conic = conformal.square_conic(start, direction)
    w = (start + direction * np.linspace(-2, 2, 9)) ** 2
    u, v = w.real, w.imag
    terms = np.array(conic)[:, None] * [u * u, u * v, v * v, u, v, 1 + 0 * u]
    size = abs(direction) ** 4 * abs(w).max() ** 2
    assert abs(terms.sum(axis=0)).max() <= 1e-12 * size
    a, b, c, *_ = conic
    assert b**2 == pytest.approx(4 * a * c)
    assert a + c == pytest.approx(abs(direction) ** 4)


def test_inversion_circles_are_the_printed_ones():
    A, B, k = sympy.symbols("A B k", positive=True)
    circle = conformal.inversion_circle(sympy.I * A, sympy.Integer(1))
    assert circle == (-sympy.I / (2 * A), 1 / (2 * A))
    centre, radius = conformal.inversion_circle(B, 1 + sympy.I * k)
    assert sympy.simplify(centre - (1 / (2 * B) + sympy.I / (2 * k * B))) == 0
    assert sympy.simplify(radius**2 - (1 + k**2) / (4 * k**2 * B**2)) == 0


def test_square_conics_have_the_printed_coefficients():
    A, B, k = sympy.symbols("A B k", positive=True)
    horizontal = conformal.square_conic(sympy.I * A, sympy.Integer(1))
    assert horizontal == (0, 0, 1, -4 * A**2, 0, -4 * A**4)
    slanted = conformal.square_conic(B, 1 + sympy.I * k)
    quadratic = 4 * k**2, 4 * k * (k**2 - 1), (k**2 - 1) ** 2
    printed = *quadratic, 4 * k**2 * B**2 * (k**2 - 1), -8 * k**3 * B**2, -4 * k**4 * B**4
    assert [sympy.expand(a - b) for a, b in zip(slanted, printed, strict=True)] == [0] * 6


@given(point, point)
def test_the_square_bezier_curve_is_the_mapped_segment(start, end):
    b0, b1, b2 = fig03.square_bezier(start, end)
    t = np.linspace(0, 1, 11)
    curve = (1 - t) ** 2 * b0 + 2 * t * (1 - t) * b1 + t**2 * b2
    np.testing.assert_allclose(curve, ((1 - t) * start + t * end) ** 2, atol=1e-12)


def test_image_lines_sample_the_straight_edges_before_mapping_them():
    z = np.array([[0, 1j, 2j + 1], [1, 1 + 2j, 3j]])  # m = 1, n = 2, bent lines
    u_lines, v_lines = conformal.image_lines(lambda w: w**2 + 1, z, samples=5)
    t = np.linspace(0, 1, 5)[:, None]
    assert (u_lines.shape, v_lines.shape) == ((3, 5), (2, 9))
    np.testing.assert_allclose(u_lines.T, ((1 - t) * z[0] + t * z[1]) ** 2 + 1, atol=1e-14)
    for j in range(2):
        wanted = ((1 - t) * z[:, j] + t * z[:, j + 1]) ** 2 + 1
        np.testing.assert_allclose(v_lines[:, 4 * j : 4 * j + 5].T, wanted, atol=1e-14)
    assert conformal.image_lines(np.exp, z, samples=2)[0].shape == (3, 2)


LINES = [0, 1 + 2j, -0.3 - 0.6j]  # through 0 in the direction 1 + 2j
M1 = np.array([[1 + 1j, 2], [0.5j, 3]])
M2 = np.array([[2, -1j], [1, 1 - 2j]])
POINTS = np.array([0.3, 1 + 2j, -2.5j, 4 - 1j])


def test_moebius_is_the_quotient_and_products_are_compositions():
    first = conformal.moebius(M1, POINTS)
    wanted = [((1 + 1j) * z + 2) / (0.5j * z + 3) for z in POINTS]
    np.testing.assert_allclose(first, wanted, rtol=1e-14)
    np.testing.assert_allclose(conformal.moebius([[2, 1], [0, 1]], POINTS), 2 * POINTS + 1)
    np.testing.assert_allclose(conformal.moebius(7j * M1, POINTS), first)
    twice = conformal.moebius(M2, first)
    np.testing.assert_allclose(conformal.moebius(M2 @ M1, POINTS), twice, rtol=1e-13)
    np.testing.assert_allclose(conformal.moebius(np.linalg.inv(M1), first), POINTS, rtol=1e-13)


def test_moebius_through_three_points_maps_them_and_keeps_cross_ratios():
    def cross_ratio(a, b, c, d):
        return (a - c) * (b - d) / ((b - c) * (a - d))

    z, w = [0, 1, 1j], [2 + 1j, -3, 0.5j]
    M = conformal.moebius_through(z, w)
    np.testing.assert_allclose(conformal.moebius(M, z), w, atol=1e-13)
    image = conformal.moebius(M, 0.4 - 0.2j)
    assert cross_ratio(*w, image) == pytest.approx(cross_ratio(*z, 0.4 - 0.2j), rel=1e-12)


NET = [[1, 2, 3], [4, -1 + 2j, 6]]
TWICE = [[1, 1, 2], [1, 2, 2], [3, 1, 3]]
WRONG = [
    (conformal.sheared_grid, (60, T0, 2, 3), "theta = 60 rad"),
    (conformal.sheared_grid, (T, np.pi, 2, 3), r"theta0 = 3\.14159 rad"),
    (conformal.shear, (1j, np.pi), r"theta0 = 3\.14159 rad"),
    (conformal.sheared_grid, (T, T0, 2, 0), "n = 0: a whole number, 1 or more"),
    (conformal.sheared_grid, (T, T0, 2.5, 3), r"m = 2\.5: a whole number"),
    (conformal.sheared_grid, (T, T0, 2, 3, 0, -1), "edge = -1: a positive finite number"),
    (conformal.sheared_grid, (T, T0, 2, 3, 0, np.nan), "edge = nan: a positive finite number"),
    (conformal.sheared_grid, (T, T0, 2, 3, 0, 1, 0), "direction = 0: a complex number other"),
    (conformal.sheared_grid, (T, T0, 2, 3, 0, 1, np.inf), "direction = inf"),
    (conformal.quads, (np.zeros(4),), "a grid of at least 2 x 2 points"),
    (conformal.quads, (np.zeros((1, 5)),), "a grid of at least 2 x 2 points"),
    (conformal.quads, ([[1, 2], [1j, np.inf]],), r"point \(1, 1\) is not finite: is it a pole"),
    *((conformal.inversion_circle, (x, 1 + 2j), "passes through 0") for x in LINES),
    (conformal.inversion_circle, (1 + 1j, 0), "direction = 0"),
    (conformal.square_conic, (1 + 1j, 0), "direction = 0"),
    (conformal.image_lines, (np.exp, np.eye(2), 1), "samples = 1"),
    (conformal.moebius, ([[1, 2], [2, 4]], POINTS), "det M = 0"),
    (conformal.moebius, (np.zeros((2, 2)), POINTS), "det M = 0"),
    (conformal.moebius, ([1, 2], POINTS), "2 x 2 matrix"),
    (conformal.moebius, ([[1, np.nan], [0, 1]], POINTS), "2 x 2 matrix of finite"),
    (conformal.moebius, ([[0, 1], [1, 0]], 0), "lies on the pole 0"),
    (conformal.moebius, ([[1, 0], [1, 1 - 2j]], NET), r"z\[1, 1\] lies on the pole -1\+2j of"),
    (conformal.cell_errors, (np.exp, 0, 1, 2), "not parallel"),
    (conformal.leading_errors, (0, 1, 1, 1j), "not conformal"),
    (conformal.kappa, (sympy.Integer(3), sympy.Symbol("z")), "does not depend"),
    (beyond_planar.annulus, (T, T, 30), "multiple of 4"),
    *((conformal.moebius_through, (bad, [0, 1, 2]), "three distinct") for bad in TWICE),
    *((conformal.moebius_through, ([0, 1, 2], bad), "three distinct") for bad in TWICE),
]


@pytest.mark.parametrize(("function", "arguments", "words"), WRONG)
def test_bad_arguments_are_named(function, arguments, words):
    with pytest.raises(ValueError, match=words):
        function(*arguments)
