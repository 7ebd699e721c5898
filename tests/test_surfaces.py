"""`surfaces` against closed forms, symbols, quadrature and nets measured by the judge."""

from itertools import pairwise

import numpy as np
import pytest
import sympy
from scipy.integrate import quad

from inetlib import conformal, measure, mesh, moebius, surfaces
from inetlib.surfaces import CATENOID, CYLINDER, HELICOID, SPHERE, Profile

U, V, T, P = sympy.symbols("u v t p", real=True)
FIVE = [CYLINDER, SPHERE, CATENOID, HELICOID, surfaces.conjugate(0.7)]
NAMES = [surface.name for surface in FIVE]
ASKED = np.arccos(1 / np.sqrt(5)), np.pi / 4
GRID = np.meshgrid(np.linspace(-2, 2, 5), np.linspace(-1, 1, 4))
VASE = surfaces.vase_profile()


def zero(*expressions):
    return all(sympy.simplify(x) == 0 for x in expressions)


def same(coordinates, expected):
    return zero(*(a - b for a, b in zip(coordinates, expected, strict=True)))


def deviations(surface, n, matrix=None):
    """Largest deviation of theta and theta0 (degrees) of the sampled net with n x n faces."""
    z = conformal.sheared_grid(*ASKED, n, n, edge=1.2 * np.sqrt(2) / n, direction=1 - 1j)
    z = z - z.mean() + 0.4 + 0.1j
    points = surface.point(z.real, z.imag).reshape(-1, 3)
    if matrix is not None:
        points = moebius.apply(matrix, points)
    off = measure.deviations(points, mesh.grid_quads(n, n), *ASKED)
    return np.degrees(np.abs(off).max(axis=1))


def generatrix(u):
    return 1 + u**2, u, 2 * u


def test_darboux_translational_rotational_and_helical_surfaces_by_hand():
    f, g, h, a, b, c = (sympy.Function(k) for k in "fghabc")
    A = sympy.Matrix(3, 3, lambda i, j: sympy.Function(f"A{i}{j}")(V))
    surface = surfaces.darboux(
        lambda v: A.subs(V, v).tolist(), lambda u: (f(u), g(u), h(u)), lambda v: (a(v), b(v), c(v))
    )
    expected = A * sympy.Matrix([f(U), g(U), h(U)]) + sympy.Matrix([a(V), b(V), c(V)])
    assert same(surface.coordinates(U, V), list(expected))
    plane = surfaces.translation(lambda u: (u, 0, 0), lambda v: (v, 2 * v, 0))
    assert same(plane.coordinates(U, V), (U + V, 2 * V, 0))
    assert surfaces.first_form(plane, U, V) == (1, 1, 5)
    c, s = sympy.cos(V), sympy.sin(V)
    x, y, z = generatrix(U)
    turned = (x * c - y * s, x * s + y * c)
    assert same(surfaces.rotational(generatrix).coordinates(U, V), (*turned, z))
    moved = surfaces.translation(generatrix, lambda v: (v, v**2, 3 * v))
    assert same(moved.coordinates(U, V), (x + V, y + V**2, z + 3 * V))
    assert same(surfaces.helical(generatrix, P).coordinates(U, V), (*turned, z + P * V))


def test_the_sphere_by_hand_and_mean_curvatures_by_symbols():
    E, F, G = surfaces.first_form(SPHERE, U, V)
    L, M, N = surfaces.second_form(SPHERE, U, V)  # on the unit sphere II = -I or +I
    assert zero(E - 1 / sympy.cosh(V) ** 2, F, G - E, (L / E) ** 2 - 1, M, L - N)
    for surface in (CATENOID, HELICOID, surfaces.conjugate(T)):
        assert zero(surfaces.mean_curvature(surface, U, V))
    assert zero(surfaces.mean_curvature(CYLINDER, U, V) ** 2 - sympy.Rational(1, 4))


@pytest.mark.parametrize("surface", FIVE[1:], ids=NAMES[1:])
def test_forms_of_numbers_agree_with_symbols(surface):
    for form, off in ((surfaces.first_form, 1e-12), (surfaces.second_form, 1e-10)):
        exact = [
            sympy.lambdify((U, V), x, "numpy")(*GRID) + 0 * GRID[0] for x in form(surface, U, V)
        ]
        np.testing.assert_allclose(form(surface, *GRID), exact, atol=off, rtol=off)
    single = surfaces.first_form(surface, 0.3, 0.4)
    assert all(np.shape(x) == () for x in single)
    assert single[0] == pytest.approx(single[2], abs=1e-12)
    small = surfaces.Surface("", lambda u, v: (1e-3 * np.cos(1e3 * u), 1e-3 * np.sin(1e3 * u), v))
    found = surfaces.first_form(small, 0.1, 0.2, step=1e-5)  # the step sets the scale
    assert found == pytest.approx((1, 0, 1), abs=1e-9)


@pytest.mark.parametrize("surface", [*FIVE[:4], surfaces.conjugate(T)], ids=NAMES)
def test_sympy_shows_the_five_surfaces_isothermal(surface):
    x = sympy.Matrix(surface.coordinates(U, V))
    x_u, x_v = x.diff(U), x.diff(V)
    assert zero(x_u.dot(x_u) - x_v.dot(x_v), x_u.dot(x_v))
    assert x_u.dot(x_u).subs({U: 0.3, V: 0.4, T: 0.7}).evalf() > 0.1


def test_the_points_lie_on_the_surfaces_their_names_say():
    u, v = np.meshgrid(np.linspace(-3, 3, 7), np.linspace(-1.2, 1.2, 5))
    x, y, z = np.moveaxis(SPHERE.point(u, v), -1, 0)
    np.testing.assert_allclose(x**2 + y**2 + z**2, 1)
    x, y, z = np.moveaxis(CYLINDER.point(u, v), -1, 0)
    np.testing.assert_allclose(x**2 + y**2, 1)
    x, y, z = np.moveaxis(CATENOID.point(u, v), -1, 0)
    np.testing.assert_allclose(np.hypot(x, y), np.cosh(z))
    x, y, z = np.moveaxis(HELICOID.point(u, v), -1, 0)
    np.testing.assert_allclose(x * np.cos(z) + y * np.sin(z), 0, atol=1e-14)  # rulings
    for t, member in ((0, CATENOID), (np.pi / 2, HELICOID)):
        found = surfaces.conjugate(t).point(u, v)
        np.testing.assert_allclose(found, member.point(u, v), atol=1e-14)
    for surface in FIVE:
        assert surface.point(0.3, -1.2).shape == (3,)
        grid = surface.point(np.full((2, 1), 0.3), np.full(3, -1.2))
        assert grid.shape == (2, 3, 3)
        np.testing.assert_allclose(grid[1, 2], surface.point(0.3, -1.2), rtol=1e-15)


@pytest.mark.parametrize("image", [False, True], ids=["surface", "Moebius image"])
@pytest.mark.parametrize("surface", FIVE, ids=NAMES)
def test_sampled_nets_converge_at_second_order(surface, image):
    matrix = moebius.inversion((2.5, -1.5, 1.0), 2.0) if image else None
    worst = [deviations(surface, n, matrix) for n in (8, 16, 32, 64)]
    for coarse, fine in pairwise(worst):
        assert (np.abs(np.log2(coarse / fine) - 2) < 0.35).all(), worst
    assert worst[-1].max() < 0.15


def test_the_quad_of_two_squares_has_the_printed_shape():
    z = conformal.sheared_grid(*ASKED, 1, 1, edge=np.sqrt(2), direction=1 - 1j)
    np.testing.assert_allclose(z, [[0, 1], [1 - 1j, 2 - 1j]], atol=1e-14)  # edges and diagonals
    lam, mu = measure.ratios(*conformal.quads(np.array([[0, 1], [1 - 1j, 2 - 1j]])))
    assert (lam[0] ** 2, mu[0] ** 2) == pytest.approx((5, 2))


def test_the_stereographic_image_of_the_sphere_is_the_exponential_map():
    u, v = np.meshgrid(np.linspace(-3, 3, 7), np.linspace(-2, 2, 6))
    image = moebius.stereographic(SPHERE.point(u, v))
    np.testing.assert_allclose(image, np.exp(v + 1j * u), rtol=1e-12)
    z = conformal.sheared_grid(*ASKED, 6, 9, edge=0.3, direction=1 - 1j, kappa=-1)
    points = SPHERE.point(z.real, z.imag)
    flat = measure.deviations(*conformal.quads(moebius.stereographic(points)), *ASKED)
    np.testing.assert_allclose(flat, 0, atol=1e-11)
    spatial = measure.deviations(points.reshape(-1, 3), mesh.grid_quads(6, 9), *ASKED)
    assert np.abs(spatial).max() > 1e-3


ROOT = np.sqrt(2.0**2 - 0.8**2)
CLOSED = {
    "sphere": (surfaces.sphere_profile(), lambda t: np.log(np.tan(np.pi / 4 + t / 2))),
    "large sphere": (surfaces.sphere_profile(3.0), lambda t: np.arctanh(np.sin(t))),
    "near the pole": (surfaces.sphere_profile(1.0, -1.57, 1.57), lambda t: np.arctanh(np.sin(t))),
    "torus": (
        surfaces.torus_profile(2.0, 0.8, -3, 3),
        lambda t: 1.6 / ROOT * np.arctan(np.sqrt(1.2 / 2.8) * np.tan(t / 2)),
    ),
    "cone": (surfaces.cone_profile(0.4, 1e-4, 1.0), lambda t: np.log(t) / np.sin(0.4)),
    "two points": (
        surfaces.spline_profile([[1, 0], [2, 1]]),
        lambda t: np.sqrt(2) * np.log(1 + t / np.sqrt(2)),
    ),
    "catenoid": (surfaces.catenoid_profile(), lambda t: t),
    "cylinder": (Profile(lambda t: 2.0, lambda t: t, 0, 3), lambda t: t / 2),
}


@pytest.mark.parametrize(("profile", "closed"), CLOSED.values(), ids=CLOSED)
def test_mercator_is_the_closed_form(profile, closed):
    w_of_t, t_of_w = surfaces.mercator(profile)
    t = np.linspace(profile.start, profile.stop, 777)
    w = closed(t) - closed(profile.start)
    np.testing.assert_allclose(w_of_t(t), w, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(t_of_w(w), t, rtol=1e-10, atol=1e-10)
    np.testing.assert_array_equal(t_of_w(np.array([-1.0, 99.0])), [profile.start, profile.stop])


def test_splines_pass_through_their_points_and_their_mercator_is_the_quadrature():
    rng = np.random.default_rng(5)
    profile = surfaces.spline_profile(np.stack([rng.uniform(0.6, 1.4, 7), np.arange(7.0)], axis=1))
    radius, height = profile.radius.derivative(), profile.height.derivative()

    def rate(t):
        return np.hypot(radius(t), height(t)) / profile.radius(t)

    ends = np.unique(profile.radius.t)
    total = sum(quad(rate, a, b, epsabs=1e-12, limit=200)[0] for a, b in pairwise(ends))
    w_of_t, t_of_w = surfaces.mercator(profile)
    assert w_of_t(profile.stop) == pytest.approx(total, abs=1e-8)
    t = np.linspace(0, profile.stop, 99)
    np.testing.assert_allclose(t_of_w(w_of_t(t)), t, atol=1e-10)
    t = np.linspace(-1.2, 1.2, 41)
    points = np.stack([np.cos(t), np.sin(t)], axis=1)
    profile = surfaces.spline_profile(points)
    knots = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    np.testing.assert_allclose(profile.radius(knots), points[:, 0], atol=1e-14)
    s = np.linspace(0, profile.stop, 500)
    np.testing.assert_allclose(np.hypot(profile.radius(s), profile.height(s)), 1, atol=1e-6)
    w_of_t, _ = surfaces.mercator(profile)
    assert w_of_t(profile.stop) == pytest.approx(2 * np.arctanh(np.sin(1.2)), abs=1e-5)


def test_the_named_profiles_can_be_used_as_they_are():
    assert list(surfaces.PROFILES) == [
        "sphere", "torus", "catenoid", "vase", "cone", "barrel", "hourglass"
    ]  # fmt: skip
    for make in surfaces.PROFILES.values():
        assert surfaces.check_profile(make()).start < make().stop
    cone = surfaces.PROFILES["cone"]()
    assert np.degrees(np.arctan2(cone.radius(1.0), cone.height(1.0))) == pytest.approx(30)
    t = np.linspace(-1.2, 1.2, 31)  # the slope is the derivative up to the ends
    slope = surfaces.slope(surfaces.sphere_profile(), t)
    np.testing.assert_allclose(slope, [-np.sin(t), np.cos(t)], atol=1e-9)


def test_revolve_is_eq_14():
    f, g = VASE.radius(1.3), VASE.height(1.3)
    x = surfaces.revolve(VASE, np.array([0, np.pi / 2, 0.4]), 1.3)
    expected = [[f, 0, g], [0, f, g], [f * np.cos(0.4), f * np.sin(0.4), g]]
    np.testing.assert_allclose(x, expected, atol=1e-15)
    turned = surfaces.rotational(lambda t: (2 + np.cos(t), 0, np.sin(t))).point(*GRID)
    torus = surfaces.revolve(surfaces.torus_profile(2, 1), GRID[1], GRID[0])
    np.testing.assert_allclose(turned, torus, atol=1e-15)


def screw(pitch, profile=VASE):
    """A helical surface in isothermal parameters, and nine values of w over its range."""
    surface, stop = surfaces.helical_isothermal(profile, pitch)
    return surface, np.linspace(0, stop, 9)


@pytest.mark.parametrize("pitch", [-0.6, 0.0, 0.4, 2.0])
@pytest.mark.parametrize("profile", [VASE, surfaces.torus_profile()], ids=["vase", "torus"])
def test_helical_surfaces_become_isothermal(profile, pitch):
    surface, w = screw(pitch, profile)
    x, w = np.meshgrid(np.linspace(0, 6, 4), w[1:-1])
    E, F, G = surfaces.first_form(surface, x, w, step=w.max() / 1000)
    np.testing.assert_allclose(G, E, rtol=1e-7)
    np.testing.assert_allclose(F / E, 0, atol=1e-7)


def test_helical_coordinates_lie_on_the_surface_and_are_mercator_or_the_helicoid_where_known():
    surface, w = screw(0.4)
    x, y, z = surface.point(0.7, w).T
    height = z - 0.4 * np.unwrap(np.arctan2(y, x))  # of the meridian, up to full turns
    turns = 2 * np.pi * 0.4 * np.arange(-3, 4)[:, None]
    off = np.hypot(x, y) - VASE.radius(height + turns)
    assert np.abs(off).max(axis=1).min() < 1e-9
    surface, w = screw(0.0)
    w_of_t, t_of_w = surfaces.mercator(VASE)
    assert w[-1] == pytest.approx(w_of_t(VASE.stop), rel=1e-11)
    expected = surfaces.revolve(VASE, 1.1, t_of_w(w))
    np.testing.assert_allclose(surface.point(1.1, w), expected, atol=1e-9)
    # the helicoid, of a piece of the x-axis: isothermal for radius = sinh(w + constant)
    surface, w = screw(1.0, Profile(lambda t: t, lambda t: 0 * t, 0.1, 2.0))
    assert w[-1] == pytest.approx(np.arcsinh(2.0) - np.arcsinh(0.1), rel=1e-10)
    radius = np.hypot(*surface.point(0.3, w).T[:2])
    np.testing.assert_allclose(radius, np.sinh(np.arcsinh(0.1) + w), rtol=1e-9)


BAD = [
    (Profile(lambda t: t, lambda t: t, 1, 1), "start < stop"),
    (Profile(lambda t: t, lambda t: t, 0, np.inf), "start < stop"),
    (Profile(lambda t: t, lambda t: t, 0, 1), "stay positive"),
    (surfaces.sphere_profile(1, -1, 2), "stay positive"),
    (Profile(lambda t: 1 + 0 * t, lambda t: 0 * t, 0, 1), "stands still"),
    (Profile(lambda t: 1 + t**2, lambda t: t**2, -1, 1), "turns back .* the height 0"),
    (Profile(lambda t: t * np.nan, lambda t: t, 0, 1), "not finite"),
]
WRONG = [
    (surfaces.spline_profile, [[1.0, 0]], "shape"),
    (surfaces.spline_profile, [[1.0, 0, 0], [1, 1, 0]], "shape"),
    (surfaces.spline_profile, [[1.0, 0], [1, 0], [1, 1]], "points 0 and 1 are the same"),
    (surfaces.spline_profile, [[1.0, 0], [np.nan, 1]], "point 1 is not finite"),
    (surfaces.spline_profile, [[1.0, 0], [-1, 1]], "stay positive"),
    (surfaces.torus_profile, 0.5, "major = 0.5"),
    (surfaces.cone_profile, 2.0, "gamma = 2"),
    *((surfaces.mercator, profile, words) for profile, words in BAD),
    *((lambda p: surfaces.helical_isothermal(p, 0.3), *bad) for bad in BAD),
]


@pytest.mark.parametrize(("function", "argument", "words"), WRONG)
def test_bad_profiles_and_arguments_are_named(function, argument, words):
    with pytest.raises(ValueError, match=words):
        function(argument)


def test_the_freeform_patch_is_a_dome_and_a_saddle_in_a_unit_box_at_any_resolution():
    for m, n in ((20, 20), (7, 12)):
        vertices, quads = surfaces.freeform_patch(m, n)
        assert vertices.shape == ((m + 1) * (n + 1), 3) and quads.shape == (m * n, 4)
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        assert np.linalg.norm(high - low) == pytest.approx(1, abs=1e-12)
        np.testing.assert_allclose(low + high, 0, atol=1e-12)
        assert measure.quality(vertices, quads).flips == 0
    coarse, fine = (surfaces.freeform_patch(k, k)[0].reshape(k + 1, k + 1, 3) for k in (20, 40))
    coarse, fine = ((x - x[0, 0]) / np.linalg.norm(x[0, 0] - x[-1, -1]) for x in (coarse, fine))
    np.testing.assert_allclose(fine[::2, ::2], coarse, atol=1e-12)
    vertices, quads = surfaces.freeform_patch()
    theta, theta0 = (np.degrees(x) for x in measure.angles(vertices, quads))
    assert np.ptp(theta) > 20 and np.ptp(theta0) > 20
    assert abs(theta.mean() - 90) > 10 and abs(theta0.mean() - 90) > 10
    u, v = (np.gradient(vertices.reshape(21, 21, 3), axis=k) for k in (0, 1))
    second = [np.gradient(u, axis=0), np.gradient(u, axis=1), np.gradient(v, axis=1)]
    uu, uv, vv = (np.sum(x * np.cross(u, v), axis=-1)[3:-3, 3:-3] for x in second)
    assert np.mean(uu * vv - uv**2 > 0) > 0.2  # the dome
    assert np.mean(uu * vv - uv**2 < 0) > 0.2  # the saddle


@pytest.mark.parametrize("start", [-3.0, 0.0, 2.0])
def test_slopes_are_found_inside_the_profile_only(start):
    def inside(t, value):
        return np.where((start <= t) & (t <= start + 1), value, np.nan)

    profile = Profile(
        lambda t: inside(t, 9 + t**3), lambda t: inside(t, np.sin(t)), start, start + 1
    )
    t = np.linspace(start, start + 1, 41)
    np.testing.assert_allclose(surfaces.slope(profile, t), (3 * t**2, np.cos(t)), atol=1e-8)
