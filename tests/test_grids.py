"""Large grids: the blocks against the sparse matrices, the nets against the judge."""

import re
from itertools import pairwise

import numpy as np
import pytest

from inetlib import measure, mesh, parallelogram, solver, surfaces
from inetlib.solver import grids, residuals, run, sparse

ANGLES = [(60, 60), (60, 45), (80, 110), (130, 100)]


def freeform(m, n, stretch=1.0):
    """The patch as a grid (m+1, n+1, 3), made `stretch` times as long."""
    V, _ = surfaces.freeform_patch(m, n)
    return (V * [stretch, 1, 1]).reshape(m + 1, n + 1, 3)


def blocks(m, n, seed=0):
    """A rough grid's (P, f, A) at arbitrary ratios."""
    noise = np.random.default_rng(seed).normal(size=(m + 1, n + 1, 3))
    P = np.moveaxis(freeform(m, n) + 0.1 / max(m, n) * noise, 2, 0)
    return P, *sparse.equations(P, 0.1, -0.2)


def assembled(P):
    """(f, J) of the same grid from the constraints, rows in pairs face by face."""
    Q = mesh.grid_quads(P.shape[1] - 1, P.shape[2] - 1)
    V = np.moveaxis(P, 0, 2).reshape(-1, 3)
    f, jacobian = residuals.log_ratios(V[Q].reshape(-1, 12))
    J = sparse.rows(jacobian, sparse.coordinates(Q), V.size)
    return (f - [0.1, -0.2]).ravel(), J


def flat(x):
    """Grid values, components first, in the order of the sparse matrices."""
    return np.moveaxis(x, 0, 2).ravel()


@pytest.mark.parametrize(("m", "n"), [(2, 2), (7, 4)])
def test_the_blocks_are_the_jacobian_of_the_constraints(m, n):
    P, f, A = blocks(m, n)
    residual, J = assembled(P)
    np.testing.assert_allclose(flat(f), residual, atol=1e-13)
    random = np.random.default_rng(1)
    x, y = random.normal(size=P.shape), random.normal(size=f.shape)
    np.testing.assert_allclose(flat(sparse.times(A, x)), J @ flat(x), rtol=1e-10, atol=1e-9)
    there = flat(sparse.transposed(A, y))
    np.testing.assert_allclose(there, J.T @ flat(y), rtol=1e-10, atol=1e-9)


@pytest.mark.parametrize(("m", "n"), [(12, 9), (30, 50)])
def test_conjugate_gradients_find_the_smallest_step(m, n):
    P, f, A = blocks(m, n)
    residual, J = assembled(P)
    y, count = sparse.solve(A, f, tolerance=1e-9)
    assert 0 < count < 100
    S = (J @ J.T).tocsc()
    np.testing.assert_allclose(S @ flat(y), residual, atol=1e-8 * np.linalg.norm(residual))
    d, few = sparse.step(A, f)
    assert few < count
    best = J.T @ sparse.factor(S)(residual)
    assert np.linalg.norm(flat(d) - best) < 0.01 * np.linalg.norm(best)
    y, count = sparse.solve(A, 0 * f)
    assert count == 0 and not y.any()


@pytest.mark.parametrize("stretch", [1, 5])
def test_the_preconditioner_is_symmetric_and_positive_definite(stretch):
    m, n = 5, 4
    P = np.moveaxis(freeform(m, n, stretch), 2, 0)
    apply = sparse.preconditioner(sparse.equations(P, 0, 0)[1])
    columns = [apply(e.reshape(2, m, n)).ravel() for e in np.eye(2 * m * n)]
    M = np.stack(columns, axis=1)
    np.testing.assert_allclose(M, M.T, atol=1e-5 * np.abs(M).max())
    assert np.linalg.eigvalsh((M + M.T) / 2).min() > 0


@pytest.mark.parametrize(("size", "stretch"), [(20, 1), (80, 1), (80, 6)])
def test_the_number_of_iterations_does_not_grow_with_the_grid(size, stretch):
    P = np.moveaxis(freeform(size, size + 3, stretch), 2, 0)
    f, A = sparse.equations(P, 0, 0)
    assert sparse.solve(A, f)[1] < 40


def test_levels_double_and_end_at_the_grid_and_splines_keep_cubics():
    for m, n in [(20, 20), (100, 60), (1000, 1000), (7, 1000), (2, 3), (45, 400)]:
        sizes = grids.levels(m, n)
        assert sizes[-1] == (m, n)
        assert sizes[0][0] * sizes[0][1] <= 1600
        for small, large in pairwise(sizes):
            for one, two in zip(small, large, strict=True):
                assert two == one or two in (2 * one, 2 * one - 1)
    assert grids.levels(25, 30) == [(25, 30)]
    assert grids.levels(30, 30) == [(30, 30)]
    assert grids.levels(31, 32) == [(16, 16), (31, 32)]
    assert grids.levels(25, 30, coarse=10) == [(13, 15), (25, 30)]
    u, v = np.meshgrid(np.linspace(0, 1, 6), np.linspace(0, 1, 9), indexing="ij")
    fine_u, fine_v = np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 17), indexing="ij")

    def cubic(u, v):
        return np.stack([u**3 - v, u * v**3, u + v**2 * u**2])

    fine = grids.refine(cubic(u, v), 11, 16)
    np.testing.assert_allclose(fine, cubic(fine_u, fine_v), atol=1e-12)
    few = np.mgrid[:1:3j, :1:3j]  # three points a side fix a parabola
    parabolas = [np.stack([x**2, x * y, y**2]) for x, y in (few, np.mgrid[:1:6j, :1:8j])]
    np.testing.assert_allclose(grids.refine(parabolas[0], 5, 7), parabolas[1], atol=1e-12)


@pytest.mark.parametrize(("theta", "theta0"), ANGLES)
@pytest.mark.parametrize(("m", "n", "stretch"), [(64, 64, 1), (50, 90, 1), (70, 45, 4)])
def test_all_faces_have_the_wanted_angles(theta, theta0, m, n, stretch):
    theta, theta0 = np.radians([theta, theta0])
    result = grids.optimize(freeform(m, n, stretch), theta, theta0)
    assert result.converged, result.message
    Q = mesh.grid_quads(m, n)
    assert np.degrees(measure.deviations(result.V, Q, theta, theta0).max()) < 1e-7
    assert measure.quality(result.V, Q).flips == 0
    assert f"{m} x {n} quads" in result.message
    _, *between, last = map(int, re.findall(r"in (\d+) steps", result.message))
    assert all(steps <= 2 for steps in between) and last <= 4  # none where it is good enough
    assert (result.lam, result.mu) == pytest.approx(parallelogram.ratios(theta, theta0))


def test_the_result_is_told_like_that_of_the_solver_and_the_bar_shows_the_levels(capsys):
    seen = grids.optimize(freeform(60, 61), lam=1.2, mu=0.9, progress=True)
    assert "60 x 61 quads" in capsys.readouterr().err
    assert (seen.lam, seen.mu) == pytest.approx((1.2, 0.9))
    assert all(isinstance(step, run.Step) for step in seen.history)
    first, last = seen.history[0], seen.history[-1]
    assert (first.kind, last.kind) == ("start", "angle")
    assert last.deviation < 1e-9 and last.residual < 1e-12
    assert seen.sizes == (61 * 62 * 3, 2 * 60 * 61)
    assert {"coarse", "refine", "assemble", "solve", "check"} <= seen.seconds.keys()


def test_small_grids_are_left_to_the_solver_and_large_ones_stay_near_their_start():
    X, Q = freeform(9, 12), mesh.grid_quads(9, 12)
    theirs = solver.optimize(X.reshape(-1, 3), Q, 1.2, 1.2)
    np.testing.assert_array_equal(grids.optimize(X, 1.2, 1.2).V, theirs.V)
    X, Q = freeform(80, 80), mesh.grid_quads(80, 80)
    result = grids.optimize(X, np.radians(60), np.radians(60))
    assert max(measure.hausdorff(result.V, Q, X.reshape(-1, 3), Q)) < 0.2


def test_a_hopeless_start_is_reported_and_not_made_worse():
    X = np.random.default_rng(0).normal(size=(13, 11, 3))
    result = grids.optimize(X, 0.3, 2.5)
    assert not result.converged and result.message.startswith("not converged: ")
    assert "the coarse grid failed" in result.message
    assert np.isfinite(result.V).all() and not np.shares_memory(result.V, X)
    Q = mesh.grid_quads(12, 10)
    assert measure.quality(result.V, Q).flips <= measure.quality(X.reshape(-1, 3), Q).flips


def test_a_refinement_that_leads_nowhere_is_tried_again_and_reported(monkeypatch):
    monkeypatch.setattr(sparse, "step", lambda A, f: (np.zeros((3, 1, 1)), 0))
    result = grids.optimize(freeform(130, 120), 1.0, 1.2, coarse=12)
    assert not result.converged and "astray" in result.message
    assert "33 x 30 quads" in result.message  # the finer of the two coarse grids
    assert "17 x 15 quads" not in result.message
    off = measure.deviations(result.V, mesh.grid_quads(130, 120), 1.0, 1.2).max()
    assert 1e-6 < off < 0.1  # the splines through the coarse net, no worse


def test_a_step_to_no_net_is_not_taken(monkeypatch):
    monkeypatch.setattr(sparse, "step", lambda A, f: (np.full((3, 1, 1), np.inf), 0))
    result = grids.optimize(freeform(40, 40), 1.0, 1.2, coarse=12)
    assert not result.converged and np.isfinite(result.V).all()
    assert "40 x 40 quads in 0 steps, where the refinement went astray" in result.message
    assert measure.deviations(result.V, mesh.grid_quads(40, 40), 1.0, 1.2).max() < 0.1


def test_bad_input_is_refused():
    X = freeform(5, 5)
    for changes, words in [
        ({"X": X[0]}, r"shape \(6, 3\)"),
        ({"X": X[:2]}, "at least 2"),
        ({"X": np.where(X > 0.3, np.nan, X)}, "not a finite number"),
        ({"X": X * [1, 0, 0]}, "no area"),
        ({"theta0": None}, "use solver.optimize"),
        ({"theta0": 4.0}, "between 0 and pi"),
        ({"coarse": 1}, "coarse = 1"),
        ({"tolerance": 0}, "tolerance = 0"),
    ]:
        with pytest.raises(ValueError, match=words):
            grids.optimize(**{"X": X, "theta": 1.0, "theta0": 1.0} | changes)
