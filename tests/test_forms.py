"""`forms` against closed forms: symbols exactly, numbers to the accuracy the module states."""

import numpy as np
import pytest
import sympy

from inetlib import surfaces
from inetlib.surfaces import CATENOID, CYLINDER, HELICOID, SPHERE

U, V, T = sympy.symbols("u v t", real=True)
GRID = np.meshgrid(np.linspace(-2, 2, 5), np.linspace(-1, 1, 4))


def test_the_sphere_by_hand():
    E, F, G = surfaces.first_form(SPHERE, U, V)
    assert sympy.simplify(E - 1 / sympy.cosh(V) ** 2) == 0
    assert sympy.simplify(F) == 0
    assert sympy.simplify(G - E) == 0
    L, M, N = surfaces.second_form(SPHERE, U, V)  # on the unit sphere II = -I or +I
    assert sympy.simplify((L / E) ** 2) == 1
    assert sympy.simplify(M) == 0
    assert sympy.simplify(L - N) == 0


def test_the_helicoid_is_not_in_principal_parameters():
    L, M, N = (sympy.simplify(x) for x in surfaces.second_form(HELICOID, U, V))
    assert (L, abs(M), N) == (0, 1, 0)


@pytest.mark.parametrize(
    "surface", [CYLINDER, SPHERE, CATENOID], ids=["cylinder", "sphere", "catenoid"]
)
def test_isothermal_surfaces_of_revolution_are_in_principal_parameters(surface):
    assert sympy.simplify(surfaces.second_form(surface, U, V)[1]) == 0


@pytest.mark.parametrize(
    "surface", [CATENOID, HELICOID, surfaces.conjugate(T)], ids=["catenoid", "helicoid", "family"]
)
def test_the_conjugate_surfaces_are_minimal(surface):
    assert sympy.simplify(surfaces.mean_curvature(surface, U, V)) == 0


def test_mean_curvature_of_a_cylinder_is_half():
    assert sympy.simplify(surfaces.mean_curvature(CYLINDER, U, V) ** 2) == sympy.Rational(1, 4)


@pytest.mark.parametrize("surface", [SPHERE, CATENOID, HELICOID, surfaces.conjugate(0.7)])
def test_numbers_agree_with_symbols(surface):
    for form, off in ((surfaces.first_form, 1e-12), (surfaces.second_form, 1e-10)):
        exact = [
            sympy.lambdify((U, V), x, "numpy")(*GRID) + 0 * GRID[0] for x in form(surface, U, V)
        ]
        np.testing.assert_allclose(form(surface, *GRID), exact, atol=off, rtol=off)
    single = surfaces.first_form(surface, 0.3, 0.4)
    assert all(np.shape(x) == () for x in single)
    assert single[0] == pytest.approx(single[2], abs=1e-12)


def test_the_step_sets_the_scale():
    small = surfaces.Surface("", lambda u, v: (1e-3 * np.cos(1e3 * u), 1e-3 * np.sin(1e3 * u), v))
    found = surfaces.first_form(small, 0.1, 0.2, step=1e-5)
    assert found == pytest.approx((1, 0, 1), abs=1e-9)
