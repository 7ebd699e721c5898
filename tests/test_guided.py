"""The paper's formulation: counts, its own residual, and what its residual does not say."""

import numpy as np
import pytest

from inetlib import conformal, measure, mesh, parallelogram, solver, surfaces
from inetlib.solver import guided, problem
from inetlib.solver.goal import aim

RIGHT, SIXTY = np.pi / 2, np.pi / 3


def count(Q, **wanted):
    return guided.size(Q, Q.max() + 1, aim(**wanted))


def test_variables_and_constraints_of_a_20_x_20_grid():
    Q, V, F = mesh.grid_quads(20, 20), 441, 400
    assert count(Q) == (3 * V + 6 * F + 2, 8 * F) == (3725, 3200)
    assert count(Q, theta=RIGHT) == (3 * V + 6 * F + 2, 9 * F)
    assert count(Q, theta=SIXTY, theta0=RIGHT) == (3 * V + 6 * F + 2, 10 * F)
    assert count(Q, lam=1.5) == (3 * V + 6 * F + 2, 8 * F + 1)
    assert count(Q, equal=True) == (3 * V + 2 * F + 1, 4 * F)
    assert count(Q, theta=SIXTY, theta0=SIXTY) == (3 * V + 2 * F + 1, 4 * F + 1) == (2124, 1601)


def test_variables_of_the_hexagon_mesh_are_the_printed_ones():
    """Printed: 2323 and 4052 variables, 1730 and 4321 constraints, one row of zeros in each."""
    _, Q, _ = mesh.polygon_rings(6, 8)
    assert count(Q, theta=SIXTY, theta0=SIXTY) == (2323, 1730 - 1)
    assert count(Q, theta=SIXTY, theta0=np.pi / 4) == (4052, 4321 - 1)


@pytest.mark.parametrize("angles", [(1.0, 1.2), (1.1, 1.1)])
def test_the_start_is_a_solution_on_a_net_of_these_angles(angles):
    z = conformal.sheared_grid(*angles, 4, 3, origin=1 + 1j, edge=0.3)
    V, Q = conformal.quads(z**2)
    goal = aim(*angles)
    lay = guided.layout(Q, len(V), goal.equal)
    x = guided.start(lay, V, Q)
    residual, H = guided.hard(lay, goal, x)
    np.testing.assert_allclose(residual, 0, atol=1e-10)
    assert H.shape == guided.size(Q, len(V), goal)[::-1]
    lam, mu = parallelogram.ratios(*angles)
    np.testing.assert_allclose(np.exp(guided.logs(lay, x)), (lam, mu), rtol=1e-10)


def test_the_jacobian_of_all_equations_together():
    V = np.random.default_rng(0).normal(size=(12, 3))
    Q = mesh.grid_quads(3, 2)
    for wanted in ({"theta": 1.0, "theta0": 1.2}, {"theta": 1.0, "theta0": 1.0}, {"mu": 1.3}):
        goal = aim(**wanted)
        lay = guided.layout(Q, len(V), goal.equal)
        x = guided.start(lay, V, Q) + 0.1
        d = np.random.default_rng(1).normal(size=x.size)
        _, H = guided.hard(lay, goal, x)
        up, down = (guided.hard(lay, goal, x + s * 1e-4 * d)[0] for s in (1, -1))
        # quadratic equations: central differences are exact up to rounding
        np.testing.assert_allclose(H @ d, (up - down) / 2e-4, rtol=1e-8, atol=1e-7)


def patch(n=8):
    u, v = np.meshgrid(*2 * [np.linspace(-1, 1, n + 1)], indexing="ij")
    z = 0.3 * np.cos(1.3 * u - 0.4) * np.cos(1.1 * v + 0.3) + 0.2 * u * v
    return np.stack([u * (1 + 0.1 * v), v, z], axis=-1).reshape(-1, 3), mesh.grid_quads(n, n)


def test_guided_projection_reaches_residuals_like_the_printed_ones():
    V, Q = patch()
    found = solver.optimize(V, Q, formulation="paper, splu")
    assert len(found.history) - 1 == 17
    residuals = [step.residual for step in found.history[1:]]
    assert residuals[-1] < 1e-11 and residuals[-1] < 1e-3 * residuals[0]
    lam, mu = measure.ratios(found.V, Q)
    np.testing.assert_allclose(lam, found.lam, atol=1e-2)
    np.testing.assert_allclose(mu, found.mu, atol=1e-2)


def test_a_tiny_residual_is_no_certificate_of_the_angles():
    V, Q = patch(16)
    found = solver.optimize(V, Q, SIXTY, SIXTY, formulation="paper", via="jump")
    last = found.history[-1]
    assert last.residual < 1e-6 and np.degrees(last.deviation) > 0.1
    assert not found.converged and "not converged" in found.message


def test_steps_depend_on_neither_the_scale_nor_the_linear_solver_and_fixed_vertices_stay():
    V, Q = patch(5)
    fixed, options = [0, 6, 20], {"theta": RIGHT, "iterations": 4}
    one, big, other = (
        solver.optimize(k * V, Q, formulation=formulation, fixed=fixed, **options)
        for k, formulation in ((1, "paper"), (1000.0, "paper"), (1, "paper, splu"))
    )
    np.testing.assert_allclose(big.V / 1000, one.V, atol=1e-9)
    np.testing.assert_allclose(other.V, one.V, atol=1e-9)
    np.testing.assert_array_equal(one.V[fixed], V[fixed])
    np.testing.assert_array_equal(other.V[fixed], V[fixed])
    assert np.abs(one.V - V).max() > 1e-3


def test_a_caller_stops_guided_projection_after_a_step():
    V, Q = patch(5)
    seen = []

    def callback(step, W):
        seen.append(step.kind)
        return len(seen) < 3

    found = solver.optimize(V, Q, RIGHT, formulation="paper, splu", callback=callback)
    assert seen == ["guided"] * 3 and len(found.history) == 4
    assert found.message.startswith("stopped by the caller after 3 steps")


def test_a_run_that_overflows_ends_with_the_best_net_so_far():
    """Weights whose squares are infinite, and a net far too small for its formulation."""
    V, Q = patch(4)
    heavy = problem.Weights(fairness=1e300)
    found = solver.optimize(V, Q, 1.2, 1.1, formulation="paper, splu", via="jump", weights=heavy)
    assert not found.converged and len(found.history) < 17 + 1
    assert found.message.startswith(f"not converged in {len(found.history) - 1} steps")
    assert np.isfinite(found.V).all() and measure.quality(found.V, Q).flips == 0
    V, Q = surfaces.freeform_patch(4, 4)
    tiny = {"formulation": "ratio", "residual": "quadratic", "via": "jump"}
    found = solver.optimize(1e-80 * V, Q, 1e-6, 1.1, **tiny)
    assert not found.converged and np.isfinite(found.V).all()
    off = measure.deviations(found.V, Q, 1e-6, 1.1).max()
    assert min(step.deviation for step in found.history) == pytest.approx(off)
