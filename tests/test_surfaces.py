"""`surfaces` against closed forms, quadrature and nets measured by the independent judge."""

from itertools import pairwise

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from inetlib import conformal, measure, mesh, moebius, surfaces
from inetlib.surfaces import CATENOID, CYLINDER, HELICOID, SPHERE, Profile

U, V, T = sympy.symbols("u v t", real=True)
FIVE = [CYLINDER, SPHERE, CATENOID, HELICOID, surfaces.conjugate(0.7)]
NAMES = [surface.name for surface in FIVE]
ASKED = np.arccos(1 / np.sqrt(5)), np.pi / 4


def printed_conjugate(t):
    """cos t C + sin t H with the helicoid as the paper prints it."""

    def coordinates(u, v):
        a, b, c = CATENOID.coordinates(u, v)
        sinh = np.sinh(v)
        x, y, z = sinh * np.cos(u), sinh * np.sin(u), u
        cos, sin = np.cos(t), np.sin(t)
        return cos * a + sin * x, cos * b + sin * y, cos * c + sin * z

    return surfaces.Surface("as printed", coordinates)


def deviations(surface, n, matrix=None):
    """Largest deviation of theta and theta0 (degrees) of the sampled net with n x n faces."""
    z = conformal.sheared_grid(*ASKED, n, n, edge=1.2 * np.sqrt(2) / n, direction=1 - 1j)
    z = z - z.mean() + 0.4 + 0.1j
    points = surface.point(z.real, z.imag).reshape(-1, 3)
    if matrix is not None:
        points = moebius.apply(matrix, points)
    found = measure.angles(points, mesh.grid_quads(n, n))
    return np.degrees([np.abs(f - a).max() for f, a in zip(found, ASKED, strict=True)])


# --- isothermal parametrisations ----------------------------------------------------------


@pytest.mark.parametrize("surface", [*FIVE[:4], surfaces.conjugate(T)], ids=NAMES)
def test_sympy_shows_the_five_surfaces_isothermal(surface):
    x = sympy.Matrix(surface.coordinates(U, V))
    x_u, x_v = x.diff(U), x.diff(V)
    assert sympy.simplify(x_u.dot(x_u) - x_v.dot(x_v)) == 0
    assert sympy.simplify(x_u.dot(x_v)) == 0
    assert x_u.dot(x_u).subs({U: 0.3, V: 0.4, T: 0.7}).evalf() > 0.1


def test_the_catenoid_and_the_helicoid_are_members_of_the_conjugate_family():
    u, v = np.array([0.3, 2.0]), np.array([-0.5, 1.1])
    np.testing.assert_allclose(surfaces.conjugate(0).point(u, v), CATENOID.point(u, v))
    np.testing.assert_allclose(
        surfaces.conjugate(np.pi / 2).point(u, v), HELICOID.point(u, v), atol=1e-14
    )


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


@given(st.floats(-3, 3), st.floats(-2, 2))
def test_point_takes_numbers_and_arrays_alike(u, v):
    for surface in FIVE:
        assert surface.point(u, v).shape == (3,)
        grid = surface.point(np.full((2, 1), u), np.full(3, v))
        assert grid.shape == (2, 3, 3)
        np.testing.assert_array_equal(grid[1, 2], surface.point(np.full(1, u), np.full(1, v))[0])


# --- sampled nets -------------------------------------------------------------------------


@pytest.mark.parametrize("image", [False, True], ids=["surface", "Moebius image"])
@pytest.mark.parametrize("surface", FIVE, ids=NAMES)
def test_sampled_nets_converge_at_second_order(surface, image):
    matrix = moebius.inversion((2.5, -1.5, 1.0), 2.0) if image else None
    worst = [deviations(surface, n, matrix) for n in (8, 16, 32, 64)]
    for coarse, fine in pairwise(worst):
        order = np.log2(coarse / fine)
        assert (np.abs(order - 2) < 0.35).all(), worst
    assert worst[-1].max() < 0.15


@pytest.mark.parametrize("t", [0.3, 0.7, np.pi / 4, 1.2])
def test_sampled_nets_of_the_printed_family_do_not(t):
    assert deviations(printed_conjugate(t), 64).max() > 9
    assert deviations(surfaces.conjugate(t), 64).max() < 0.05


def test_the_quad_of_two_squares_has_the_printed_shape():
    z = conformal.sheared_grid(*ASKED, 1, 1, edge=np.sqrt(2), direction=1 - 1j)
    np.testing.assert_allclose(z, [[0, 1], [1 - 1j, 2 - 1j]], atol=1e-14)  # edges and diagonals
    lam, mu = measure.ratios(*conformal.quads(np.array([[0, 1], [1 - 1j, 2 - 1j]])))
    assert (lam[0] ** 2, mu[0] ** 2) == pytest.approx((5, 2))


def test_the_stereographic_image_of_the_sphere_is_the_exponential_map():
    u, v = np.meshgrid(np.linspace(-3, 3, 7), np.linspace(-2, 2, 6))
    image = moebius.stereographic(SPHERE.point(u, v))
    np.testing.assert_allclose(image, np.exp(v + 1j * u), rtol=1e-12)


def test_the_stereographic_net_is_exact_on_the_compensated_grid():
    z = conformal.sheared_grid(*ASKED, 6, 9, edge=0.3, direction=1 - 1j, kappa=-1)
    points = SPHERE.point(z.real, z.imag)
    flat = measure.angles(*conformal.quads(moebius.stereographic(points)))
    for found, asked in zip(flat, ASKED, strict=True):
        np.testing.assert_allclose(found, asked, atol=1e-11)
    spatial = measure.angles(points.reshape(-1, 3), mesh.grid_quads(6, 9))
    assert max(np.abs(f - a).max() for f, a in zip(spatial, ASKED, strict=True)) > 1e-3


# --- profiles -----------------------------------------------------------------------------

TORUS = np.sqrt(2.0**2 - 0.8**2)
CLOSED = {
    "sphere": (surfaces.sphere_profile(), lambda t: np.log(np.tan(np.pi / 4 + t / 2))),
    "large sphere": (surfaces.sphere_profile(3.0), lambda t: np.arctanh(np.sin(t))),
    "near the pole": (surfaces.sphere_profile(1.0, -1.57, 1.57), lambda t: np.arctanh(np.sin(t))),
    "torus": (
        surfaces.torus_profile(2.0, 0.8, -3, 3),
        lambda t: 1.6 / TORUS * np.arctan(np.sqrt(1.2 / 2.8) * np.tan(t / 2)),
    ),
    "cone": (surfaces.cone_profile(0.4), lambda t: np.log(t) / np.sin(0.4)),
    "cone near its vertex": (
        surfaces.cone_profile(0.4, 1e-4, 1.0),
        lambda t: np.log(t) / np.sin(0.4),
    ),
    "catenoid": (surfaces.catenoid_profile(), lambda t: t),
    "cylinder": (Profile(lambda t: 2.0, lambda t: t, 0, 3), lambda t: t / 2),
}


@pytest.mark.parametrize("name", CLOSED)
def test_mercator_is_the_closed_form(name):
    profile, closed = CLOSED[name]
    w_of_t, t_of_w = surfaces.mercator(profile)
    t = np.linspace(profile.start, profile.stop, 777)
    w = closed(t) - closed(profile.start)
    np.testing.assert_allclose(w_of_t(t), w, rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(t_of_w(w), t, rtol=1e-10, atol=1e-10)
    assert w_of_t(profile.start) == pytest.approx(0, abs=1e-13)


def test_mercator_of_the_vase_is_the_quadrature():
    profile = surfaces.vase_profile()
    w_of_t, _ = surfaces.mercator(profile)

    def rate(t):
        slope = 0.33 * 1.9 * np.cos(1.9 * t + 0.25)
        return np.hypot(slope, 1) / (0.72 + 0.33 * np.sin(1.9 * t + 0.25))

    for t in (0.1, 1.0, 2.2, 3.2):
        assert w_of_t(t) == pytest.approx(quad(rate, 0, t, epsabs=1e-13)[0], abs=1e-10)


def test_a_torus_has_the_period_of_the_closed_form():
    w_of_t, _ = surfaces.mercator(surfaces.torus_profile(2.0, 0.8))
    assert w_of_t(np.pi) == pytest.approx(2 * np.pi * 0.8 / TORUS, rel=1e-11)


def test_mercator_makes_any_profile_isothermal():
    for profile in (surfaces.vase_profile(), surfaces.torus_profile()):
        w_of_t, t_of_w = surfaces.mercator(profile)
        u, w = np.meshgrid(np.linspace(0, 6, 4), np.linspace(0.1, 0.9, 5) * w_of_t(profile.stop))

        def coordinates(u, w, profile=profile, t_of_w=t_of_w):
            return tuple(np.moveaxis(surfaces.revolve(profile, u, t_of_w(w)), -1, 0))

        E, F, G = surfaces.first_form(surfaces.Surface("", coordinates), u, w)
        np.testing.assert_allclose(G, E, rtol=1e-8)
        np.testing.assert_allclose(F, 0, atol=1e-10)


def test_t_of_w_stays_on_the_profile():
    profile = surfaces.vase_profile()
    _, t_of_w = surfaces.mercator(profile)
    np.testing.assert_array_equal(t_of_w(np.array([-1.0, 99.0])), [profile.start, profile.stop])


def test_slope_is_the_derivative_up_to_the_ends():
    t = np.linspace(-1.2, 1.2, 31)
    radius, height = surfaces.slope(surfaces.sphere_profile(), t)
    np.testing.assert_allclose(radius, -np.sin(t), atol=1e-9)
    np.testing.assert_allclose(height, np.cos(t), atol=1e-9)


def test_revolve_is_eq_14():
    profile = surfaces.vase_profile()
    f, g = profile.radius(1.3), profile.height(1.3)
    x = surfaces.revolve(profile, np.array([0, np.pi / 2, 0.4]), 1.3)
    expected = [[f, 0, g], [0, f, g], [f * np.cos(0.4), f * np.sin(0.4), g]]
    np.testing.assert_allclose(x, expected, atol=1e-15)


@pytest.mark.parametrize(
    ("profile", "word"),
    [
        (Profile(lambda t: t, lambda t: t, 1, 1), "start < stop"),
        (Profile(lambda t: t, lambda t: t, 0, np.inf), "start < stop"),
        (Profile(lambda t: t, lambda t: t, 0, 1), "stay positive"),
        (surfaces.sphere_profile(1, -1, 2), "stay positive"),
        (Profile(lambda t: 1 + 0 * t, lambda t: 0 * t, 0, 1), "stands still"),
        (Profile(lambda t: 1 + t**2, lambda t: t**2, -1, 1), "turns back .* near t = 0"),
        (Profile(lambda t: t * np.nan, lambda t: t, 0, 1), "not finite"),
    ],
)
def test_a_bad_profile_is_named(profile, word):
    with pytest.raises(ValueError, match=word):
        surfaces.mercator(profile)


def test_bad_numbers_of_the_ready_profiles_are_named():
    with pytest.raises(ValueError, match="major = 1"):
        surfaces.torus_profile(1, 2)
    with pytest.raises(ValueError, match=r"gamma = 2"):
        surfaces.cone_profile(2.0)


# --- splines ------------------------------------------------------------------------------


def test_a_spline_passes_through_its_points_and_comes_near_the_curve():
    t = np.linspace(-1.2, 1.2, 41)
    points = np.stack([np.cos(t), np.sin(t)], axis=1)
    profile = surfaces.spline_profile(points)
    knots = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    np.testing.assert_allclose(profile.radius(knots), points[:, 0], atol=1e-14)
    s = np.linspace(0, profile.stop, 500)
    np.testing.assert_allclose(np.hypot(profile.radius(s), profile.height(s)), 1, atol=1e-6)
    w_of_t, _ = surfaces.mercator(profile)
    assert w_of_t(profile.stop) == pytest.approx(2 * np.arctanh(np.sin(1.2)), abs=1e-5)


def test_mercator_of_a_spline_is_the_quadrature_span_by_span():
    rng = np.random.default_rng(5)
    points = np.stack([rng.uniform(0.6, 1.4, 7), np.arange(7.0)], axis=1)
    profile = surfaces.spline_profile(points)
    radius, height = profile.radius.derivative(), profile.height.derivative()

    def rate(t):
        return np.hypot(radius(t), height(t)) / profile.radius(t)

    ends = np.unique(profile.radius.t)
    total = sum(quad(rate, a, b, epsabs=1e-12, limit=200)[0] for a, b in pairwise(ends))
    w_of_t, t_of_w = surfaces.mercator(profile)
    assert w_of_t(profile.stop) == pytest.approx(total, abs=1e-8)
    t = np.linspace(0, profile.stop, 99)
    np.testing.assert_allclose(t_of_w(w_of_t(t)), t, atol=1e-10)


def test_two_points_make_a_cone():
    profile = surfaces.spline_profile([[1.0, 0], [2.0, 1]])
    w_of_t, _ = surfaces.mercator(profile)
    assert w_of_t(profile.stop) == pytest.approx(np.sqrt(2) * np.log(2), rel=1e-11)


@pytest.mark.parametrize(
    ("points", "word"),
    [
        ([[1.0, 0]], "shape"),
        ([[1.0, 0, 0], [1, 1, 0]], "shape"),
        ([[1.0, 0], [1, 0], [1, 1]], "points 0 and 1 are the same"),
        ([[1.0, 0], [np.nan, 1]], "point 1 is not finite"),
        ([[1.0, 0], [-1, 1]], "stay positive"),
    ],
)
def test_bad_points_are_named(points, word):
    with pytest.raises(ValueError, match=word):
        surfaces.spline_profile(points)


@pytest.mark.parametrize(("m", "n"), [(20, 20), (7, 12)])
def test_the_freeform_patch_has_the_unit_box_and_its_own_quads(m, n):
    vertices, quads = surfaces.freeform_patch(m, n)
    assert vertices.shape == ((m + 1) * (n + 1), 3) and quads.shape == (m * n, 4)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    assert np.linalg.norm(high - low) == pytest.approx(1, abs=1e-12)
    np.testing.assert_allclose(low + high, 0, atol=1e-12)
    assert measure.quality(vertices, quads).flips == 0


def test_the_freeform_patch_is_a_dome_and_a_saddle_far_from_isogonal():
    vertices, quads = surfaces.freeform_patch()
    theta, theta0 = (np.degrees(x) for x in measure.angles(vertices, quads))
    assert np.ptp(theta) > 20 and np.ptp(theta0) > 20
    assert abs(theta.mean() - 90) > 10 and abs(theta0.mean() - 90) > 10
    grid = vertices.reshape(21, 21, 3)
    u, v = (np.gradient(grid, axis=k) for k in (0, 1))
    normal = np.cross(u, v)
    second = [np.gradient(u, axis=0), np.gradient(u, axis=1), np.gradient(v, axis=1)]
    uu, uv, vv = (np.sum(x * normal, axis=-1)[3:-3, 3:-3] for x in second)
    assert np.mean(uu * vv - uv**2 > 0) > 0.2  # the dome
    assert np.mean(uu * vv - uv**2 < 0) > 0.2  # the saddle


def test_freeform_patches_of_any_resolution_lie_on_one_surface():
    coarse, fine = (surfaces.freeform_patch(k, k)[0].reshape(k + 1, k + 1, 3) for k in (20, 40))
    shift = fine[0, 0] / np.linalg.norm(fine[0, 0] - fine[-1, -1])
    scale = np.linalg.norm(coarse[0, 0] - coarse[-1, -1])
    moved = fine / np.linalg.norm(fine[0, 0] - fine[-1, -1]) - shift
    np.testing.assert_allclose(moved[::2, ::2], (coarse - coarse[0, 0]) / scale, atol=1e-12)
