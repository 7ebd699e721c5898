"""`kinematic` against surfaces written down by hand, and E = G, F = 0 where it is promised."""

import numpy as np
import pytest
import sympy

from inetlib import surfaces

U, V, P = sympy.symbols("u v p", real=True)


def generatrix(u):
    return 1 + u**2, u, 2 * u


def same(coordinates, expected):
    return all(sympy.simplify(a - b) == 0 for a, b in zip(coordinates, expected, strict=True))


def test_a_darboux_surface_is_the_printed_product():
    f, g, h, a, b, c = (sympy.Function(k) for k in "fghabc")
    A = sympy.Matrix(3, 3, lambda i, j: sympy.Function(f"A{i}{j}")(V))
    surface = surfaces.darboux(
        lambda v: A.subs(V, v).tolist(), lambda u: (f(u), g(u), h(u)), lambda v: (a(v), b(v), c(v))
    )
    expected = A * sympy.Matrix([f(U), g(U), h(U)]) + sympy.Matrix([a(V), b(V), c(V)])
    assert same(surface.coordinates(U, V), list(expected))


def test_translation_of_two_lines_is_a_plane_of_congruent_parallelograms():
    surface = surfaces.translation(lambda u: (u, 0, 0), lambda v: (v, 2 * v, 0))
    assert same(surface.coordinates(U, V), (U + V, 2 * V, 0))
    E, F, G = surfaces.first_form(surface, U, V)
    assert (E, F, G) == (1, 1, 5)


def test_rotational_and_helical_surfaces_by_hand():
    c, s = sympy.cos(V), sympy.sin(V)
    x, y, z = generatrix(U)
    turned = (x * c - y * s, x * s + y * c)
    assert same(surfaces.rotational(generatrix).coordinates(U, V), (*turned, z))
    assert same(surfaces.helical(generatrix, P).coordinates(U, V), (*turned, z + P * V))


def test_a_rotational_surface_of_a_meridian_is_eq_14():
    surface = surfaces.rotational(lambda u: (2 + np.cos(u), 0, np.sin(u)))
    u, v = np.meshgrid(np.linspace(0, 3, 4), np.linspace(-1, 1, 3))
    expected = surfaces.revolve(surfaces.torus_profile(2, 1), v, u)
    np.testing.assert_allclose(surface.point(u, v), expected, atol=1e-15)


@pytest.mark.parametrize("v", [0.3, V], ids=["number", "symbol"])
def test_turn_is_a_rotation_about_the_z_axis(v):
    A = sympy.Matrix(surfaces.turn(v))
    assert sympy.simplify((A.T * A - sympy.eye(3)).norm()).evalf() == pytest.approx(0, abs=1e-12)
    assert sympy.simplify(A.det()) == pytest.approx(1)


# --- isothermal helical surfaces ----------------------------------------------------------


@pytest.mark.parametrize("pitch", [-0.6, 0.0, 0.4, 2.0])
@pytest.mark.parametrize("profile", [surfaces.vase_profile(), surfaces.torus_profile()])
def test_helical_surfaces_become_isothermal(profile, pitch):
    surface, stop = surfaces.helical_isothermal(profile, pitch)
    x, w = np.meshgrid(np.linspace(0, 6, 4), np.linspace(0.1, 0.9, 5) * stop)
    E, F, G = surfaces.first_form(surface, x, w, step=stop / 1000)
    np.testing.assert_allclose(G, E, rtol=1e-7)
    np.testing.assert_allclose(F / E, 0, atol=1e-7)


def test_its_points_lie_on_the_helical_surface():
    profile, pitch = surfaces.vase_profile(), 0.4
    surface, stop = surfaces.helical_isothermal(profile, pitch)
    w = np.linspace(0, stop, 9)
    x, y, z = surface.point(0.7, w).T
    angle = np.unwrap(np.arctan2(y, x))
    height = z - pitch * angle  # of the meridian that was turned by `angle`, up to full turns
    turns = 2 * np.pi * pitch * np.arange(-3, 4)[:, None]
    off = np.hypot(x, y) - profile.radius(height + turns)
    assert np.abs(off).max(axis=1).min() < 1e-9


def test_without_pitch_it_is_the_mercator_coordinate():
    profile = surfaces.vase_profile()
    surface, stop = surfaces.helical_isothermal(profile, 0.0)
    w_of_t, t_of_w = surfaces.mercator(profile)
    assert stop == pytest.approx(w_of_t(profile.stop), rel=1e-11)
    w = np.linspace(0, stop, 9)
    expected = surfaces.revolve(profile, 1.1, t_of_w(w))
    np.testing.assert_allclose(surface.point(1.1, w), expected, atol=1e-9)


def test_a_horizontal_line_gives_the_helicoid():
    """Turned and lifted, a piece of the x-axis: isothermal for radius = sinh(w + constant)."""
    profile = surfaces.Profile(lambda t: t, lambda t: 0 * t, 0.1, 2.0)
    surface, stop = surfaces.helical_isothermal(profile, 1.0)
    assert stop == pytest.approx(np.arcsinh(2.0) - np.arcsinh(0.1), rel=1e-10)
    w = np.linspace(0, stop, 7)
    radius = np.hypot(*surface.point(0.3, w).T[:2])
    np.testing.assert_allclose(radius, np.sinh(np.arcsinh(0.1) + w), rtol=1e-9)


def test_a_bad_profile_is_named():
    with pytest.raises(ValueError, match="stay positive"):
        surfaces.helical_isothermal(surfaces.sphere_profile(1, -2, 2), 0.3)
