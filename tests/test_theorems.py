"""The theorems of Section 4 on real nets: smooth ones by derivatives, others face by face."""

import numpy as np
import pytest
import sympy as sp

from inetlib import conformal, measure, mesh, parallelogram

DEG = np.pi / 180


def black_sides(theta, theta0):
    """Side vectors a, b (f, 3) of the black quads of an exact, far from uniform DI-net."""
    z = conformal.sheared_grid(theta * DEG, theta0 * DEG, 9, 7, origin=0.5 + 0.3j, edge=0.2)
    V, Q = conformal.quads(z**2)
    assert measure.quality(V, Q).area_ratio < 0.2
    p1, p2, _, p4 = np.moveaxis(mesh.checkerboard(V, Q).V[mesh.checkerboard(V, Q).black], 1, 0)
    return p2 - p1, p4 - p1


def lengths(*vectors):
    return [np.linalg.norm(v, axis=1) for v in vectors]


def test_thm_7_constant_ratios_of_tangents_mean_constant_angles():
    # An I-net on the catenoid, by symbols: tangents from derivatives, angles from tangents.
    u, v = sp.symbols("u v", real=True)
    mu, theta0 = sp.Rational(3, 2), sp.pi / 3
    x, y = u + v * sp.cos(theta0) / mu, v * sp.sin(theta0) / mu
    X = sp.Matrix([sp.cosh(y) * sp.cos(x), sp.cosh(y) * sp.sin(x), y])
    x_u, x_v = X.diff(u), X.diff(v)
    y_u, y_v = x_u - x_v, x_u + x_v
    assert sp.simplify(x_u.dot(x_u) - mu**2 * x_v.dot(x_v)) == 0
    lam2 = sp.simplify((y_v.dot(y_v) / y_u.dot(y_u)).rewrite(sp.exp))
    assert lam2.is_number
    cosine = sp.simplify((x_u.dot(x_v) / (mu * x_v.dot(x_v))).rewrite(sp.exp))
    assert cosine == sp.Rational(1, 2)
    at = {u: 0.3, v: -0.7}
    one, two = (np.array(t.subs(at).evalf().tolist(), dtype=float).ravel() for t in (y_u, y_v))
    theta = np.arccos(one @ two / np.sqrt((one @ one) * (two @ two)))
    assert parallelogram.angles(float(lam2) ** 0.5, 1.5) == pytest.approx((theta, np.pi / 3))
    rho = np.exp(1j * np.pi / 3) / 1.5
    expected = float(lam2) ** 0.5 * np.exp(1j * theta)
    assert parallelogram.diagonal_ratio(rho) == pytest.approx(expected)


def test_thm_8_the_six_angles_of_a_sampled_web_tend_to_constants():
    theta, theta0 = 75 * DEG, 65 * DEG
    alpha = np.arctan2(np.sin(theta0), parallelogram.ratios(theta, theta0)[1] + np.cos(theta0))
    limits = np.array([theta, theta0, alpha, theta - alpha, theta0 - alpha, theta0 + theta - alpha])
    off = []
    for n in (8, 16, 32):
        z = conformal.sheared_grid(theta, theta0, n, n, origin=-0.5 - 0.5j, edge=1 / n)
        x, y = z.real.ravel(), z.imag.ravel()
        sphere = np.stack([np.cos(x) / np.cosh(y), np.sin(x) / np.cosh(y), np.tanh(y)], axis=1)
        six = np.array(measure.web_angles(sphere, mesh.grid_quads(n, n)))
        off.append(np.abs(six - limits[:, None]).max())
    assert off[0] < 0.01 and 3.5 < off[0] / off[1] < 4.5 and 3.5 < off[1] / off[2] < 4.5


def test_def_10_lam_is_1_exactly_for_orthogonal_nets():
    lam, mu = sp.symbols("lam mu", positive=True)
    assert sp.solve(parallelogram.cosines(lam, mu)[1], lam) == [1]  # theta0 = 90 degrees
    assert sp.solve(parallelogram.cosines(lam, mu)[0], mu) == [1]  # theta = 90 degrees


def test_def_14_cor_15_do_nets_have_similar_rhombuses():
    a, b = black_sides(50, 90)
    assert np.allclose(np.divide(*lengths(a, b)), 1, atol=1e-12)
    assert np.ptp(np.divide(*lengths(a + b, b - a))) < 1e-12


def test_cor_16_mu_1_has_similar_rectangles():
    a, b = black_sides(90, 50)
    cosine = np.einsum("ij,ij->i", a, b) / np.prod(lengths(a, b), axis=0)
    assert np.abs(cosine).max() < 1e-12
    assert np.ptp(np.divide(*lengths(a, b))) < 1e-12


def test_cor_17_theta_quads_have_one_ratio():
    a, b = black_sides(60, 60)
    golden = (1 + np.sqrt(5)) / 2
    assert np.allclose(np.divide(*lengths(b, a)), golden, atol=1e-12)
    assert np.allclose(np.divide(*lengths(a + b, b - a)), golden, atol=1e-12)


def test_cor_18_do_nets_of_theta_quads_have_squares():
    a, b = black_sides(90, 90)
    assert np.allclose(np.divide(*lengths(a, b)), 1, atol=1e-12)
    assert np.allclose(np.divide(*lengths(a + b, b - a)), 1, atol=1e-12)
