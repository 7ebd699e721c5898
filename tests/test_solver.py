"""Optimised nets, judged by `measure` alone; symmetries of the solver; what it refuses."""

from itertools import pairwise
from unittest.mock import Mock

import numpy as np
import pytest
from test_guided import patch
from test_measure import sheared

import inetlib
from inetlib import loxodrome, measure, mesh, parallelogram, reference, solver
from inetlib.solver import problem, run
from inetlib.solver.goal import aim, freedom

RIGHT, SIXTY = np.pi / 2, np.pi / 3
ONE_NANODEGREE = np.radians(1e-9)
QUADS = mesh.grid_quads(4, 4)


def judge(found, Q, theta, theta0):
    """The judge's verdict on a net that should have these angles."""
    off = measure.deviations(found.V, Q, theta, theta0).max()
    return off < ONE_NANODEGREE and measure.quality(found.V, Q).flips == 0


@pytest.mark.parametrize("residual", ["log", "quadratic"])
@pytest.mark.parametrize("degrees", [(90, 90), (60, 60), (60, 45), (120, 70), (45, 45)])
def test_every_face_has_the_two_given_angles_and_keeps_them(degrees, residual):
    V, Q = patch()
    angles = np.radians(degrees)
    found = solver.optimize(V, Q, *angles, residual=residual)
    assert found.converged and judge(found, Q, *angles)
    off = np.log(measure.ratios(V, Q)) - np.log(parallelogram.ratios(*angles))[:, None]
    assert found.history[0].residual == pytest.approx(np.sum(off**2))
    assert len(found.history) - 1 <= 12
    assert all(step.deviation > 1e-11 for step in found.history[:-1])  # the tolerance: no idle step
    np.testing.assert_allclose((found.lam, found.mu), parallelogram.ratios(*angles))
    np.testing.assert_array_equal(V, patch()[0])  # the input is untouched
    again = solver.optimize(found.V, Q, *angles, residual=residual, shape_steps=0)
    assert np.abs(again.V - found.V).max() < 1e-11


@pytest.mark.parametrize(
    "wanted", [{}, {"theta": RIGHT}, {"theta0": 1.2}, {"lam": 1.3}, {"mu": 0.8}, {"equal": True}]
)
@pytest.mark.parametrize("residual", ["log", "quadratic"])
def test_what_is_not_given_is_found(wanted, residual):
    V, Q = patch()
    found = solver.optimize(V, Q, residual=residual, **wanted)
    assert found.converged and judge(found, Q, found.theta, found.theta0)
    reached = found._asdict() | {"equal": found.theta == pytest.approx(found.theta0, abs=1e-12)}
    for name, value in wanted.items():
        assert abs(reached[name] - value) < 1e-12
    lam, mu = measure.ratios(found.V, Q)
    np.testing.assert_allclose(lam, found.lam, rtol=1e-10)
    np.testing.assert_allclose(mu, found.mu, rtol=1e-10)


def test_an_angle_step_is_the_smallest_change_that_meets_the_linear_equations():
    V, Q = patch(5)
    for wanted in ({"theta": 1.5, "theta0": 1.4}, {"theta": 1.5}, {}):
        goal = aim(**wanted)
        given = problem.prepare(V, Q, goal)
        s = freedom(goal, (0.0, 0.0))
        d, ds = run.angle_step(given, V, goal, s)
        residual, J, slopes = run.equations(given, V, goal, s)
        np.testing.assert_allclose(J @ d.ravel() - slopes @ ds, -residual, atol=1e-10)
        # the same by LAPACK: eliminate s by projecting on what the slopes cannot reach
        rank = np.linalg.matrix_rank(slopes) if slopes.size else 0  # older numpy refuses none
        keep = np.linalg.svd(slopes)[0][:, rank:]
        least = np.linalg.lstsq(keep.T @ J.toarray(), -keep.T @ residual, rcond=None)[0]
        np.testing.assert_allclose(d.ravel(), least, atol=1e-10)


@pytest.mark.parametrize("on_surface", [False, True])
def test_an_angle_step_with_slow_and_fixed_vertices_on_a_sphere_and_off_it(on_surface):
    V, Q = patch(3)
    V[:, 2] += 2
    foot = V / np.linalg.norm(V, axis=1, keepdims=True)  # of the unit sphere, and its normal
    V = foot * np.linspace(0.97, 1.04, len(V))[:, None]
    slow = np.linspace(0, 2, len(V))  # the first one is fixed
    sphere = Mock(diagonal=3.0, closest=lambda V: (foot, foot))
    goal = aim(1.4, 1.3)
    given = problem.prepare(V, Q, goal, reference=sphere, on_surface=on_surface, mobility=slow)
    d, _ = run.angle_step(given, V, goal, np.zeros(0))
    residual, J, _ = run.equations(given, V, goal, np.zeros(0))
    lift = (foot - V) * (slow > 0)[:, None] if on_surface else 0 * V
    # by LAPACK, in two tangents a vertex, or in x, y, z, divided by the root of the mobility
    frames = np.linalg.svd(foot[:, None, :])[2][:, 1 if on_surface else 0 :]
    frames = frames * np.sqrt(slow)[:, None, None]
    columns = np.einsum("fnx,nkx->fnk", J.toarray().reshape(-1, *V.shape), frames)
    wanted = -residual - J @ lift.ravel()
    y = np.linalg.lstsq(columns.reshape(len(wanted), -1), wanted, rcond=None)[0]
    y = y.reshape(len(V), -1)
    np.testing.assert_allclose(d, lift + np.einsum("nk,nkx->nx", y, frames), atol=1e-8)


@pytest.mark.parametrize("weights", [(1e-2, 1.0), (1e-1, 0.0)])
def test_a_coupled_step_is_the_least_squares_solution_of_its_energies(weights):
    V, Q = patch(3)
    surface, slow = reference.mesh(*patch(9)), np.linspace(0.5, 2, len(V))
    goal = aim(theta=1.4)
    given = problem.prepare(V, Q, goal, reference=surface, mobility=slow)
    V = V + 0.03 * np.random.default_rng(3).normal(size=V.shape)
    s = np.array([0.1])
    d, ds = run.coupled_step(given, V, goal, s, weights)
    residual, J, slopes = run.equations(given, V, goal, s)
    (a, b, c, e), loose = np.moveaxis(V[Q], 1, 0), np.sqrt(weights[0])
    long = (np.linalg.norm(c - a, axis=1) + np.linalg.norm(e - b, axis=1)) / 2
    reach = [np.mean([long[k] for k in range(len(Q)) if v in Q[k]]) for v in range(len(V))]
    feet, normals = surface.closest(V)
    rows, right = [np.hstack([J.toarray(), -slopes])], [-residual]
    for k, face in enumerate(Q):  # the shift of every other corner
        rows.append(np.zeros((3, V.size + 1)))
        for sign, v in zip((1, -1, 1, -1), face, strict=True):
            rows[-1][:, 3 * v : 3 * v + 3] = sign * loose * np.sqrt(run.COUPLING) / 2 / long[k]
            rows[-1][:, 3 * v : 3 * v + 3] *= np.eye(3)
        right.append(np.zeros(3))
    for v in range(len(V)):
        rows.append(np.zeros((4, V.size + 1)))
        rows[-1][:3, 3 * v : 3 * v + 3] = loose * np.eye(3) / reach[v] / np.sqrt(slow[v])
        rows[-1][3, 3 * v : 3 * v + 3] = np.sqrt(weights[1]) * normals[v] / reach[v]
        apart = (V[v] - feet[v]) @ normals[v]
        right.append([0, 0, 0, -np.sqrt(weights[1]) * apart / reach[v]])
    best = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]
    if weights[1]:
        np.testing.assert_allclose(np.append(d, ds), best, atol=1e-9)
    else:  # with a second step on what the size has left over of the equations
        left = residual + J @ best[:-1] - slopes @ best[-1:]
        right = np.concatenate([-left, np.zeros(len(np.concatenate(right)) - len(left))])
        best += np.linalg.lstsq(np.concatenate(rows), right, rcond=None)[0]
        np.testing.assert_allclose(np.append(d, ds), best, atol=1e-9)


@pytest.mark.parametrize("slow", [np.ones(25), np.linspace(0.5, 2, 25)])
def test_a_shape_step_minimises_the_linearised_energy(slow):
    V, Q = patch(4)
    surface = reference.mesh(*patch(9))
    goal = aim(theta=1.4)
    given = problem.prepare(V, Q, goal, reference=surface, mobility=slow)
    s = np.array([0.1])
    d, ds = run.shape_step(given, V, goal, s)
    residual, J, slopes = run.equations(given, V, goal, s)
    A, g = problem.shape(given, V)
    close = np.repeat(given.weights.closeness / slow, 3)

    def energy(x):
        d, ds = x[: V.size], x[V.size :]
        f = given.edge * (residual + J @ d - slopes @ ds)
        return f @ f + d @ (A @ d) + 2 * g @ d + close @ d**2

    best = np.concatenate([d.ravel(), ds])
    rng = np.random.default_rng(0)
    for _ in range(20):
        aside = 1e-3 * rng.normal(size=best.size)
        assert energy(best + aside) > energy(best)
        assert abs(energy(best + aside) - energy(best - aside)) < 1e-12


def test_shape_energies_are_those_of_the_paper():
    V, Q = patch(4)
    surface = reference.mesh(*patch(9))
    weights = problem.Weights(fairness=0.3, approximation=0.5, boundary=0.7)
    given = problem.prepare(V, Q, aim(), weights, reference=surface)
    W = V + 0.05 * np.random.default_rng(1).normal(size=V.shape)
    grid = np.moveaxis(W.reshape(5, 5, 3), 2, 0)
    rows = np.concatenate([np.diff(grid, 2, axis=1).ravel(), np.diff(grid, 2, axis=2).ravel()])
    w = W.ravel()
    np.testing.assert_allclose(w @ (given.fair() @ w), 0.3 * rows @ rows, rtol=1e-12)
    outer = given.boundary
    assert len(outer) == 16
    feet, normals = surface.closest(W)
    p, e1, _, _ = surface.boundary(W[outer])
    pull = 0.5 * np.sum((W - feet) * normals, axis=1)[:, None] * normals
    aside = np.cross(e1, np.cross(W[outer] - p, e1))  # the paper's second form, times e1 again
    pull[outer] += 0.7 * aside
    A, g = problem.shape(given, W)
    np.testing.assert_allclose(g - given.fair() @ w, pull.ravel(), atol=1e-12)
    hessian = 0.5 * normals[:, :, None] * normals[:, None, :]
    hessian[outer] += 0.7 * (np.eye(3) - e1[:, :, None] * e1[:, None, :])
    rest = (A - given.fair()).toarray().reshape(25, 3, 25, 3)
    np.testing.assert_allclose(rest[range(25), :, range(25)], hessian, atol=1e-12)


def test_moved_turned_scaled_and_mirrored_meshes_give_such_nets():
    V, Q = patch(6)
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    one = solver.optimize(V, Q, SIXTY, 1.3)
    two = solver.optimize(7 * V @ turn.T + 3, Q, SIXTY, 1.3)
    np.testing.assert_allclose((two.V - 3) @ turn / 7, one.V, atol=1e-10)
    mirrored = np.roll(Q[:, ::-1], 1, axis=1)
    two = solver.optimize(V * [1, 1, -1], mirrored, np.pi - SIXTY, 1.3)
    # v1 v2 v3 v4 -> v1 v4 v3 v2: d2 changes its sign, the medial lines change places
    np.testing.assert_allclose(two.V * [1, 1, -1], one.V, atol=1e-10)


def test_fixed_vertices_stay_and_slow_ones_lag():
    V, Q = patch()
    mask = np.zeros(len(V), dtype=bool)
    mask[[0, 8, 72, 80]] = True
    for fixed in (mask, [0, 8, 72, 80]):
        found = solver.optimize(V, Q, theta=RIGHT, fixed=fixed)
        assert found.converged
        np.testing.assert_array_equal(found.V[mask], V[mask])
    slow = np.where(V[:, 0] < 0, 0.01, 1.0)
    lazy = solver.optimize(V, Q, RIGHT, RIGHT, mobility=slow)
    free = solver.optimize(V, Q, RIGHT, RIGHT)
    left = V[:, 0] < -0.5
    way = [np.linalg.norm(r.V - V, axis=1)[left].mean() for r in (lazy, free)]
    assert lazy.converged and way[0] < 0.7 * way[1]


def test_gliding_keeps_the_outline_closer_and_vertices_on_a_sphere():
    V, Q = patch()
    surface = reference.mesh(V, Q)
    outer = np.unique(np.concatenate(mesh.boundary_loops(Q)))
    apart = []
    for weight in (0.0, 0.01):
        weights = problem.Weights(boundary=weight)
        found = solver.optimize(V, Q, RIGHT, reference=surface, weights=weights)
        assert found.converged
        feet = surface.boundary(found.V[outer])[0]
        apart.append(np.linalg.norm(found.V[outer] - feet, axis=1).mean())
    assert apart[1] < 0.5 * apart[0]
    x, y = np.meshgrid(*2 * [np.linspace(-0.5, 0.5, 9)], indexing="ij")
    V = np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=-1).reshape(-1, 3)
    Q = mesh.grid_quads(8, 8)
    sphere = reference.parametric(
        lambda u, v: np.stack([np.cos(v) * np.cos(u), np.sin(v), np.cos(v) * np.sin(u)], -1),
        (0.2, 2.9),
        (-1.4, 1.4),
    )
    found = solver.optimize(V, Q, 1.2, 1.3, reference=sphere, on_surface=True)
    assert judge(found, Q, 1.2, 1.3)
    np.testing.assert_allclose(np.linalg.norm(found.V, axis=1), 1, atol=1e-9)


@pytest.mark.parametrize("via", ["mean", "jump", "medials", "diagonals", "squares"])
def test_every_way_leads_to_the_angles(via):
    V, Q = patch()
    found = solver.optimize(V, Q, 1.3, 1.2, via=via)
    assert judge(found, Q, 1.3, 1.2)
    goals = {(s.goal.kind, s.goal.values) for s in found.history[1:]}
    through = {"medials": ("theta0", (RIGHT,)), "diagonals": ("theta", (RIGHT,))}
    through |= {"squares": ("angles", (RIGHT, RIGHT))}
    assert through.get(via, ("angles", (1.3, 1.2))) in goals
    assert (len(goals) == 1) == (via == "jump")


def test_the_hexagon_mesh_goes_to_60_and_45_degrees_step_by_step():
    V, Q, polygon = mesh.polygon_rings(6, 4)
    V[:, 2] = 0.02 * (V[:, :2] ** 2).sum(axis=1) * np.cos(3 * np.arctan2(V[:, 1], V[:, 0]))
    found = solver.optimize(V, Q, SIXTY, np.pi / 4, polygons=[polygon])
    assert judge(found, Q, SIXTY, np.pi / 4)
    way = np.array([step.goal.values for step in found.history[1:]])
    assert np.abs(np.diff(way[:, 1])).max() <= solver.STRIDE + 1e-12


def test_a_reference_may_be_a_tenth_of_its_diagonal_away():
    x, y = np.mgrid[:1:5j, :1:5j]
    low, near, far = (
        np.stack([x, y, z + 0 * x], axis=-1).reshape(-1, 3)
        for z in np.multiply(2**0.5, [0, 0.08, 0.12])
    )
    problem.prepare(near, QUADS, aim(), reference=reference.mesh(low, QUADS))
    with pytest.raises(ValueError, match=r"far away, 0\.12 of its diagonal"):
        problem.prepare(far, QUADS, aim(), reference=reference.mesh(low, QUADS))


def test_random_patches_converge_or_say_that_they_did_not():
    rng = np.random.default_rng(7)
    good = 0
    for _ in range(40):
        m, n = rng.integers(8, 15, 2)
        u, v = np.meshgrid(np.linspace(0, 1, m + 1), np.linspace(0, 1, n + 1), indexing="ij")
        z = sum(rng.normal() * np.cos(a * u + b * v) for a, b in rng.uniform(-6, 6, (3, 2)))
        V = np.stack([u, v, z * rng.uniform(0.05, 0.3) / np.ptp(z)], axis=-1).reshape(-1, 3)
        Q, angles = mesh.grid_quads(m, n), rng.uniform(*np.radians([30, 150]), 2)
        found = solver.optimize(V, Q, *angles)
        assert found.converged == judge(found, Q, *angles)
        good += found.converged
    assert good >= 39


def test_a_hopeless_case_says_so_and_returns_the_best_net():
    V, Q = patch(4)
    still = np.arange(25) != 12  # all vertices but one
    found = solver.optimize(V, Q, SIXTY, SIXTY, fixed=still)
    assert not found.converged and "not converged" in found.message
    least = min((s.flips, s.deviation) for s in found.history)
    off = measure.deviations(found.V, Q, SIXTY, SIXTY).max()
    assert least == (measure.quality(found.V, Q).flips, pytest.approx(off))
    with pytest.raises(inetlib.NotConverged, match="not converged") as caught:
        solver.optimize(V, Q, SIXTY, SIXTY, fixed=still, strict=True)
    np.testing.assert_array_equal(caught.value.result.V, found.V)


def test_extreme_angles_never_give_nan_and_far_nets_are_as_exact_as_their_coordinates():
    V, Q = patch(5)
    for degrees in ((1, 1), (179, 1), (5, 175), (179.9, 90)):
        found = solver.optimize(V, Q, *np.radians(degrees))
        assert np.isfinite(found.V).all()
        assert found.converged == judge(found, Q, *np.radians(degrees))
    one, large = (problem.prepare(k * V, Q, aim()).rounding for k in (1, 2**20))
    assert one == large  # an angle: it has no scale
    found = solver.optimize(V + 1e6, Q, SIXTY, SIXTY)
    off = max(np.abs(a - SIXTY).max() for a in measure.angles(found.V, Q))
    assert found.converged and 1e-11 < off < 1e-7


def test_a_closed_torus_finds_angles_that_fit_it_and_refuses_others():
    net = loxodrome.torus_web(2.0, 0.8, m=24, n=12, shift=6)
    V = net.V + 0.01 * np.random.default_rng(0).normal(size=net.V.shape)
    found = solver.optimize(V, net.Q)
    assert found.converged and judge(found, net.Q, found.theta, found.theta0)
    other = solver.optimize(V, net.Q, equal=True)
    assert not other.converged and np.isfinite(other.V).all()


def test_a_caller_can_watch_stop_and_limit_and_sees_a_bar_on_request(capsys):
    V, Q = patch()
    watch = Mock(side_effect=[True, True, False])
    stopped = solver.optimize(V, Q, SIXTY, SIXTY, callback=watch)
    assert watch.call_count == len(stopped.history) - 1 == 3
    assert "stopped by the caller" in stopped.message
    assert all(0 < seconds < 60 for seconds in stopped.seconds.values())
    nets = [V, *(call.args[1] for call in watch.call_args_list)]
    ways = [np.linalg.norm(b - a, axis=1).max() for a, b in pairwise(nets)]
    assert [step.size for step in stopped.history] == pytest.approx([0, *ways])
    limited = solver.optimize(V, Q, SIXTY, SIXTY, iterations=2)
    assert len(limited.history) == 3 and not limited.converged
    for found in (stopped, limited):
        assert measure.quality(found.V, Q).flips == 0
    assert capsys.readouterr().err == ""
    solver.optimize(V, Q, RIGHT, progress=True)
    assert "step" in capsys.readouterr().err


def test_angles_near_zero_end_in_words_not_in_a_singular_matrix():
    V, Q = sheared(2, 2, v=(0, 1, 0))
    found = solver.optimize(V, Q, 1.1e-6, 1.0, residual="quadratic")
    assert not found.converged and "not converged" in found.message
    for bad in (1e-7, np.pi - 1e-7):
        with pytest.raises(ValueError, match="1e-06 or more away from 0 and pi"):
            solver.optimize(V, Q, bad)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"Q": [[0, 1, 2, 3], [0, 1, 2, 3, 4]]}, "polygons="),
        ({"Q": QUADS[:, :3]}, "triangles"),
        ({"Q": np.concatenate([QUADS[:1], np.roll(QUADS[1:], 1, 1)])}, "label"),
        ({"V": np.full((25, 3), np.nan)}, "not a finite"),
        ({"V": np.zeros((25, 3))}, "length zero|no area"),
        ({"weights": problem.Weights(fairness=-1.0)}, "fairness = -1"),
        ({"weights": problem.Weights(closeness=np.nan)}, "closeness"),
        ({"weights": problem.Weights(boundary=np.ones(3))}, "boundary has the shape"),
        ({"reference": reference.mesh(patch(4)[0] + 10, QUADS)}, "far away"),
        ({"on_surface": True}, "needs a reference"),
        ({"on_surface": True, "formulation": "paper"}, 'need formulation="ratio"'),
        ({"coupled": True, "formulation": "paper"}, 'need formulation="ratio"'),
        ({"on_surface": True, "coupled": True}, "no coupled steps: give one of the two"),
        ({"formulation": "magic"}, "ratio, paper"),
        ({"residual": "cubic"}, "log, quadratic"),
        ({"via": "moon"}, "squares"),
        ({"stride": 0.0}, "positive"),
        ({"tolerance": -1.0}, "positive"),
        ({"iterations": 1.5}, "whole number"),
        ({"shape_steps": -1}, "whole number"),
        ({"fixed": [99]}, "0 to 24"),
        ({"fixed": "corner"}, "boundary"),
        ({"fixed": np.ones(3, dtype=bool)}, "25 entries"),
        ({"fixed": np.ones(25, dtype=bool)}, "no vertex is free"),
        ({"mobility": -np.ones(25)}, "mobility"),
        ({"polygons": [[0, 1, 2]]}, "not a hole"),
    ],
)
def test_bad_input_is_refused_before_any_work(change, words):
    V, Q = patch(4)
    kwargs = {"V": V, "Q": Q, "theta": 1.2, "theta0": 1.3} | change
    with pytest.raises(ValueError, match=words):
        solver.optimize(callback=lambda *_: pytest.fail("work was done"), **kwargs)
