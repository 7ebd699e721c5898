"""`conformal` against complex arguments, directly mapped points and the printed formulas."""

import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from inetlib import conformal, measure, mesh

T, T0 = np.radians(60), np.radians(45)
angle = st.floats(0.1, np.pi - 0.1)
part = st.floats(-5, 5)
point = st.builds(complex, part, part)


def diagonals(z):
    """d1, d2 of every cell, from the top left corner counter-clockwise."""
    return z[1:, :-1] - z[:-1, 1:], z[1:, 1:] - z[:-1, :-1]


def deviation(f, theta=T, theta0=T0, m=6, n=5, **grid):
    """Largest deviation from (theta, theta0) in degrees, by complex arguments.

    An argument has a sign: a cell turned over would show.
    """
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


@given(angle, angle, point, st.floats(0.01, 100), point)
def test_origin_edge_and_direction_are_kept(theta, theta0, origin, edge, direction):
    assume(abs(direction) > 0.01)
    z = conformal.sheared_grid(theta, theta0, 2, 3, origin, edge, direction)
    assert z[0, 0] == origin
    u, v = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0]
    assert u == pytest.approx(edge * direction / abs(direction), rel=1e-9, abs=1e-12)
    assert np.angle(v / u) == pytest.approx(theta0, abs=1e-9)
    np.testing.assert_allclose(z, z[:1, :] + z[:, :1] - origin, atol=1e-12 * (9 + 9 * abs(v)))


def test_theta_parallelograms_have_the_height_sin_theta_over_lam():
    z = conformal.sheared_grid(T, T, 1, 1)  # not lam sin theta, as printed in App. A.2
    golden = (1 + 5**0.5) / 2
    assert z[0, 1].imag == pytest.approx(np.sin(T) / golden, rel=1e-14)


def test_an_exact_compensation_tends_to_the_plain_grid():
    plain = conformal.sheared_grid(T, T0, 1, 1, edge=1e-3)
    for kappa in (1, -1, 2 + 1j):
        bent = conformal.sheared_grid(T, T0, 1, 1, edge=1e-3, kappa=kappa)
        assert 1e-11 < abs(bent - plain).max() < 1e-8


BAD_GRIDS = {
    "degrees": (dict(theta=60), "theta = 60 rad"),
    "theta0": (dict(theta0=np.pi), r"theta0 = 3\.14159 rad"),
    "no rows": (dict(n=0), "n = 0: a whole number, 1 or more"),
    "half a quad": (dict(m=2.5), r"m = 2\.5: a whole number"),
    "negative edge": (dict(edge=-1), "edge = -1: a positive finite number"),
    "no edge": (dict(edge=np.nan), "edge = nan: a positive finite number"),
    "no direction": (dict(direction=0), "direction = 0: a complex number other than 0"),
    "endless direction": (dict(direction=np.inf), "direction = inf"),
}


@pytest.mark.parametrize("what", BAD_GRIDS)
def test_a_sheared_grid_refuses(what):
    change, words = BAD_GRIDS[what]
    arguments = dict(theta=T, theta0=T0, m=2, n=3) | change
    with pytest.raises(ValueError, match=words):
        conformal.sheared_grid(**arguments)
    if what == "theta0":
        with pytest.raises(ValueError, match=words):
            conformal.shear(1j, np.pi)


def test_quads_put_grid_point_i_j_at_vertex_i_times_n_plus_1_plus_j():
    z = np.array([[10 * i + 1j * j for j in range(4)] for i in range(3)])
    V, Q = conformal.quads(z)
    np.testing.assert_array_equal(V[1 * 4 + 3], [10, 3, 0])
    np.testing.assert_array_equal(V[:, 0] + 1j * V[:, 1], z.ravel())
    np.testing.assert_array_equal(V[Q[0]][:, :2], [[0, 1], [0, 0], [10, 0], [10, 1]])
    assert len(Q) == 6
    mesh.check(V, Q)


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (np.zeros(4), "a grid of at least 2 x 2 points"),
        (np.zeros((1, 5)), "a grid of at least 2 x 2 points"),
        (np.array([[1, 2], [1j, np.inf]]), r"grid point \(1, 1\) is not finite: is it a pole"),
    ],
)
def test_quads_want_a_finite_grid(bad, words):
    with pytest.raises(ValueError, match=words):
        conformal.quads(bad)


def test_complex_ratios_are_the_measured_ratios_and_angles():
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


def inverse(edge):
    return conformal.sheared_grid(T, T0, *[round(1 / edge)] * 2, origin=1 + 1j, edge=edge)


def test_images_under_1_over_z_approach_the_angles_with_the_square_of_the_mesh_size():
    off = []
    for edge in (0.1, 0.05, 0.025):
        d1, d2 = diagonals(1 / inverse(edge))
        off.append(np.abs(np.angle(d2 / d1) - T).max())
    assert np.degrees(off[0]) > 0.1
    assert 3.6 < off[0] / off[1] < 4.2
    assert 3.8 < off[1] / off[2] < 4.1


def test_images_under_1_over_z_have_the_closed_form_ratio_at_any_mesh_size():
    z = inverse(0.25)
    d1, d2 = diagonals(1 / z)
    middle = (z[:-1, :-1] + z[1:, 1:]) / 2
    u, v = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0]
    p, q = (u + v) / 2, (u - v) / 2
    wanted = p / q * (middle**2 - q**2) / (middle**2 - p**2)
    np.testing.assert_allclose(d2 / d1, wanted, rtol=1e-11)


@given(point, point)
def test_the_inversion_circle_passes_through_the_mapped_points(start, direction):
    assume(abs(direction) > 0.1 and abs(np.imag(np.conj(direction) * start)) > 0.05)
    centre, radius = conformal.inversion_circle(start, direction)
    mapped = 1 / (start + direction * np.linspace(-3, 3, 13))
    np.testing.assert_allclose(abs(mapped - centre), radius, rtol=1e-8)


def test_inversion_circles_are_the_printed_ones():
    A, B, k = sympy.symbols("A B k", positive=True)
    assert conformal.inversion_circle(sympy.I * A, sympy.Integer(1)) == (
        -sympy.I / (2 * A),
        1 / (2 * A),
    )
    centre, radius = conformal.inversion_circle(B, 1 + sympy.I * k)
    assert sympy.simplify(centre - (1 / (2 * B) + sympy.I / (2 * k * B))) == 0
    assert sympy.simplify(radius**2 - (1 + k**2) / (4 * k**2 * B**2)) == 0


@pytest.mark.parametrize("start", [0, 1 + 2j, -0.3 - 0.6j])
def test_a_line_through_0_has_no_inversion_circle(start):
    with pytest.raises(ValueError, match="the line passes through 0"):
        conformal.inversion_circle(start, 1 + 2j)


@pytest.mark.parametrize("image", [conformal.inversion_circle, conformal.square_conic])
def test_a_line_without_a_direction_is_refused(image):
    with pytest.raises(ValueError, match="direction = 0"):
        image(1 + 1j, 0)


@given(point, point)
def test_mapped_points_satisfy_the_square_conic_which_is_a_parabola(start, direction):
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


def test_square_conics_have_the_printed_coefficients():
    A, B, k = sympy.symbols("A B k", positive=True)
    horizontal = conformal.square_conic(sympy.I * A, sympy.Integer(1))
    assert horizontal == (0, 0, 1, -4 * A**2, 0, -4 * A**4)
    slanted = conformal.square_conic(B, 1 + sympy.I * k)
    printed = (
        4 * k**2,
        4 * k * (k**2 - 1),
        (k**2 - 1) ** 2,
        4 * k**2 * B**2 * (k**2 - 1),
        -8 * k**3 * B**2,
        -4 * k**4 * B**4,
    )
    assert [sympy.expand(a - b) for a, b in zip(slanted, printed, strict=True)] == [0] * 6


@given(point, point)
def test_the_square_bezier_curve_is_the_mapped_segment(start, end):
    b0, b1, b2 = conformal.square_bezier(start, end)
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
    with pytest.raises(ValueError, match="samples = 1"):
        conformal.image_lines(np.exp, z, samples=1)


M1 = np.array([[1 + 1j, 2], [0.5j, 3]])
M2 = np.array([[2, -1j], [1, 1 - 2j]])
POINTS = np.array([0.3, 1 + 2j, -2.5j, 4 - 1j])


def test_moebius_is_the_quotient_point_by_point():
    wanted = [((1 + 1j) * z + 2) / (0.5j * z + 3) for z in POINTS]
    np.testing.assert_allclose(conformal.moebius(M1, POINTS), wanted, rtol=1e-14)
    np.testing.assert_allclose(conformal.moebius([[2, 1], [0, 1]], POINTS), 2 * POINTS + 1)


def test_products_are_compositions_and_the_inverse_matrix_is_the_inverse_map():
    twice = conformal.moebius(M2, conformal.moebius(M1, POINTS))
    np.testing.assert_allclose(conformal.moebius(M2 @ M1, POINTS), twice, rtol=1e-13)
    back = conformal.moebius(np.linalg.inv(M1), conformal.moebius(M1, POINTS))
    np.testing.assert_allclose(back, POINTS, rtol=1e-13)
    np.testing.assert_allclose(conformal.moebius(7j * M1, POINTS), conformal.moebius(M1, POINTS))


def cross_ratio(z):
    a, b, c, d = z
    return (a - c) * (b - d) / ((b - c) * (a - d))


def test_moebius_through_three_points_maps_them_and_keeps_cross_ratios():
    z, w = [0, 1, 1j], [2 + 1j, -3, 0.5j]
    M = conformal.moebius_through(z, w)
    np.testing.assert_allclose(conformal.moebius(M, z), w, atol=1e-13)
    image = conformal.moebius(M, 0.4 - 0.2j)
    assert cross_ratio([*w, image]) == pytest.approx(cross_ratio([*z, 0.4 - 0.2j]), rel=1e-12)


def test_a_point_on_the_pole_is_named():
    z = np.array([[1, 2, 3], [4, -1 + 2j, 6]])
    with pytest.raises(ValueError, match=r"point z\[1, 1\] lies on the pole -1\+2j of the map"):
        conformal.moebius([[1, 0], [1, 1 - 2j]], z)
    with pytest.raises(ValueError, match="lies on the pole 0"):
        conformal.moebius([[0, 1], [1, 0]], 0)


@pytest.mark.parametrize(
    ("M", "words"),
    [
        ([[1, 2], [2, 4]], "det M = 0"),
        (np.zeros((2, 2)), "det M = 0"),
        ([1, 2], "2 x 2 matrix"),
        ([[1, np.nan], [0, 1]], "2 x 2 matrix of finite"),
    ],
)
def test_moebius_refuses(M, words):
    with pytest.raises(ValueError, match=words):
        conformal.moebius(M, POINTS)


@pytest.mark.parametrize("bad", [[1, 1, 2], [1, 2, 2], [3, 1, 3]])
def test_three_points_must_be_distinct(bad):
    for points in ((bad, [0, 1, 2]), ([0, 1, 2], bad)):
        with pytest.raises(ValueError, match="three distinct"):
            conformal.moebius_through(*points)
