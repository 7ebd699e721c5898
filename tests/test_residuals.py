"""Every Jacobian against finite differences, every residual against the independent judge."""

import inspect

import numpy as np
import pytest
import sympy as sp

from inetlib import conformal, measure, mesh, parallelogram
from inetlib.solver import guided, residuals
from inetlib.solver.goal import aim

RANDOM = np.random.default_rng(4)
UNIT = np.linalg.qr(RANDOM.normal(size=(6, 3, 3)))[0]
CASES = {
    "log_ratios": (12, ()),
    "scaled_ratios": (12, (1.3, 0.8, RANDOM.uniform(0.5, 2, (6, 2)))),
    "squared_diagonals": (14, ()),
    "squared_medials": (14, ()),
    "proportional": (3, ()),
    "square_root": (2, ()),
    "given": (1, (0.7,)),
    "given_angle": (3, (1.1,)),
    "theta_quad": (12, ()),
    "distances": (3, (RANDOM.normal(size=(6, 3)), UNIT[:, 1], UNIT[:, 2])),
}


def test_no_constraint_is_missing_here():
    public = [n for n, f in inspect.getmembers(residuals, inspect.isfunction) if n[0] != "_"]
    assert sorted([*CASES, "logarithms"]) == public


@pytest.mark.parametrize("name", CASES)
def test_the_jacobian_of(name):
    k, extra = CASES[name]
    function = getattr(residuals, name)
    x = np.random.default_rng(1).normal(size=(6, k)) + 0.2
    residual, jacobian = function(x, *extra)
    assert jacobian.shape == (*residual.shape, k)
    h = 1e-3
    for j in range(k):
        e = np.zeros(k)
        e[j] = h
        steps = [function(x + s * e, *extra)[0] for s in (1, -1, 2, -2)]
        slope = (8 * (steps[0] - steps[1]) - (steps[2] - steps[3])) / (12 * h)
        np.testing.assert_allclose(jacobian[:, :, j], slope, rtol=1e-6, atol=1e-8)


def net(theta=1.0, theta0=1.2):
    z = conformal.sheared_grid(theta, theta0, 4, 3, origin=1 + 1j, edge=0.3)
    return conformal.quads(z**2)


def corners(V, Q):
    return V[Q].reshape(len(Q), 12)


def test_log_ratios_are_the_measured_ones_and_scaled_ones_vanish_on_a_net_with_their_derivatives():
    V = np.random.default_rng(2).normal(size=(20, 3))
    Q = np.arange(20).reshape(5, 4)
    found, _ = residuals.log_ratios(corners(V, Q))
    np.testing.assert_allclose(np.exp(found).T, measure.ratios(V, Q), rtol=1e-13)
    V, Q = net()
    lam, mu = parallelogram.ratios(1.0, 1.2)
    d1, d2, m13, m24 = (np.linalg.norm(d, axis=1) for d in measure.vectors(V, Q))
    residual, jacobian = residuals.scaled_ratios(corners(V, Q), lam, mu)
    same, _ = residuals.scaled_ratios(corners(V, Q), 2, 2, np.stack([d1 * d2, m13 * m24], axis=1))
    np.testing.assert_allclose(residuals.scaled_ratios(corners(V, Q), 2, 2)[0], same, rtol=1e-13)
    np.testing.assert_allclose(residual, 0, atol=1e-12)
    np.testing.assert_allclose(jacobian, residuals.log_ratios(corners(V, Q))[1], atol=1e-9)


def test_eqs_17_18_20_vanish_on_a_net_with_these_angles():
    V, Q = net()
    squares = (np.sum(d**2, axis=1) for d in measure.vectors(V, Q))  # by the judge
    La, Lb, Lp, Lq = (k * square for k, square in zip((1, 1, 4, 4), squares, strict=True))
    lam, mu = (np.full(len(Q), r) for r in parallelogram.ratios(1.0, 1.2))
    x = corners(V, Q)
    for residual, _ in (
        residuals.squared_diagonals(np.column_stack([x, La, Lb])),
        residuals.squared_medials(np.column_stack([x, Lp, Lq])),
        residuals.proportional(np.stack([Lb, La, lam**2], axis=1)),
        residuals.proportional(np.stack([Lp, Lq, mu**2], axis=1)),
        residuals.square_root(np.stack([lam, lam**2], axis=1)),
        residuals.given_angle(np.stack([lam, lam**2, mu**2], axis=1), 1.0),
        residuals.given_angle(np.stack([mu, mu**2, lam**2], axis=1), 1.2),
    ):
        np.testing.assert_allclose(residual, 0, atol=1e-10)
    other, _ = residuals.given_angle(np.stack([lam, lam**2, mu**2], axis=1), 1.2)
    assert np.abs(other).min() > 0.1


def test_eq_20_is_eq_3_cleared_of_denominators():
    lam, mu = sp.symbols("lam mu", positive=True)
    cos_theta, cos_theta0 = parallelogram.cosines(lam, mu)
    assert sp.simplify((1 + lam**2) * (mu**2 - 1) - 2 * cos_theta * lam * (1 + mu**2)) == 0
    assert sp.simplify((1 + mu**2) * (lam**2 - 1) - 2 * cos_theta0 * mu * (1 + lam**2)) == 0


def test_eq_21_vanishes_where_the_angles_are_equal_only():
    equal, _ = residuals.theta_quad(corners(*net(1.1, 1.1)))
    other, _ = residuals.theta_quad(corners(*net(1.1, 1.0)))
    np.testing.assert_allclose(equal, 0, atol=1e-12)
    assert np.abs(other).min() > 1e-3


def test_eq_22_is_the_ratio_of_a_theta_parallelogram():
    for theta in (0.3, np.pi / 3, np.pi / 2, 2.5):
        ratio = np.cos(theta) + np.sqrt(1 + np.cos(theta) ** 2)
        np.testing.assert_allclose(parallelogram.ratios(theta, theta), ratio)
        Q = mesh.grid_quads(1, 1)
        goal = aim(theta, theta)
        function, _, value = guided.equations(guided.layout(Q, 4, goal.equal), goal)[-1]
        assert function is residuals.given and value[0] == pytest.approx(ratio**2)
