"""Pieces of grids: found in any numbering, their waves against factors, and coarse to fine."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from inetlib import design, examples, measure, mesh, reference, solver, surfaces
from inetlib.solver import lattice, residuals, sparse

DEGREE = np.pi / 180


def shuffled(V, Q, seed=0):
    """The same mesh, its vertices and faces in another order, some faces half a turn on."""
    random = np.random.default_rng(seed)
    vertices, faces = random.permutation(len(V)), random.permutation(len(Q))
    Q = np.argsort(vertices)[Q[faces]]
    turned = random.random(len(Q)) < 0.5
    return V[vertices], np.where(turned[:, None], np.roll(Q, 2, axis=1), Q)


def bulge(m, n, k=0, across=0):
    """A rough grid of m x n quads, or one that closes: (i + k, j + across) is (i, j)."""
    i, j = np.mgrid[: m + 1, : n + 1].reshape(2, -1)
    V, Q = np.stack([i, 1.3 * j + 0.1 * i, 0.02 * i * j], axis=1), mesh.grid_quads(m, n)
    if k:
        length = np.hypot(k, across)
        u = 2 * np.pi * (k * i + across * j) / length**2
        r = 2 * length + (k * j - across * i) / length
        V = np.stack([r * np.cos(u), r * np.sin(u), 0.3 * r], axis=1)
        _, first, same = np.unique(np.round(V, 6), axis=0, return_index=True, return_inverse=True)
        V, Q = V[first], same.ravel()[Q]
        Q = Q[np.unique(np.sort(Q, axis=1), axis=0, return_index=True)[1]]
    return V + 0.05 * np.random.default_rng(1).normal(size=V.shape), Q


def corner(V, Q):
    """The faces of a grid that are not near one of its corners, a piece with a notch."""
    middle = V[Q].mean(axis=1)
    return Q[np.linalg.norm(middle - middle.max(axis=0), axis=1) > 0.4 * np.ptp(middle[:, 0])]


def used(V, Q):
    at, Q = np.unique(Q, return_inverse=True)
    return V[at], Q.reshape(-1, 4)


RINGS = {"ring": (9, 4, 9, 0), "winding": (9, 9, 9, -4), "steep": (8, 11, 3, 11)}
PIECES = {"grid": bulge(9, 7), "notch": used((made := bulge(10, 9))[0], corner(*made))}
PIECES |= {name: bulge(*sizes) for name, sizes in RINGS.items()}


def system(V, Q):
    """(piece, J, residuals) of the two logarithms of each face."""
    Q, piece = lattice.find(Q, mesh.face_neighbours(Q))
    found, jacobian = residuals.log_ratios(V[Q].reshape(-1, 12))
    return piece, sparse.rows(jacobian, sparse.coordinates(Q), V.size), found.ravel()


@pytest.mark.parametrize("size", [(7, 4), (31, 50)])
def test_a_grid_is_found_in_any_numbering(size):
    V, Q = shuffled(*bulge(*size))
    turned, piece = lattice.find(Q, mesh.face_neighbours(Q))
    assert not piece.period.any()
    grid = lattice.vertices(turned, piece.place)
    assert grid.shape == (size[0] + 1, size[1] + 1)
    W = bulge(*size)[0].reshape(*grid.shape, 3)
    found = V[grid] if np.allclose(V[grid[0, 0]], W[0, 0]) else V[grid[::-1, ::-1]]
    np.testing.assert_array_equal(found, W)


@pytest.mark.parametrize("name", PIECES)
def test_pieces_have_places_and_rings_a_period(name):
    _, Q = shuffled(*PIECES[name])
    turned, piece = lattice.find(Q, mesh.face_neighbours(Q))
    step = {(0, 2): (1, 0), (1, 3): (0, 1)}
    one, two = mesh.pairs(turned).T
    period = RINGS.get(name, (0, 0))[-2:]
    assert tuple(piece.period) in (period, tuple(-k for k in np.array(period)))
    broken = 0
    for a, b in zip(one, two, strict=True):
        along = np.array(step[tuple(sorted((a % 4, b % 4)))])
        off = piece.place[b // 4] - piece.place[a // 4]
        rest = off - along if a % 4 in (2, 3) else off + along
        assert tuple(rest) in ((0, 0), period, tuple(-k for k in np.array(period)))
        broken += rest.any()
    assert (broken > 0) == any(period)
    assert (lattice.vertices(turned, piece.place) is not None) == (name == "grid")


def test_what_is_no_piece_of_a_grid_has_no_places():
    _, Q, _ = mesh.polygon_rings(6, 5)
    assert lattice.find(Q, mesh.face_neighbours(Q))[1] is None
    two = np.concatenate([mesh.grid_quads(3, 3), 16 + mesh.grid_quads(3, 3)])
    assert lattice.find(two, mesh.face_neighbours(two))[1] is None


@pytest.mark.parametrize("name", PIECES)
def test_waves_solve_what_factors_solve(name):
    piece, J, f = system(*shuffled(*PIECES[name]))
    more = 1e-14
    S = (J @ J.T).tocsc()
    S.setdiag(S.diagonal() + more)
    b = np.stack([f, np.ones(len(f))], axis=1)
    y = lattice.solve(piece, J, b, 1e-11, more)
    expected = spsolve(S, b)
    np.testing.assert_allclose(J.T @ y, J.T @ expected, atol=1e-6 * np.abs(J.T @ expected).max())
    assert lattice.solve(piece, J, np.nan * b, 1e-6, more) is None


@pytest.mark.parametrize("name", PIECES)
def test_waves_are_symmetric_positive_and_nearly_the_inverse(name):
    piece, J, _ = system(*PIECES[name])
    blocks = J.data.reshape(-1, 2, 12)
    factors = np.linalg.inv(np.linalg.cholesky(np.einsum("fak,fbk->fab", blocks, blocks)))
    rows = np.einsum("fab,fbk->afk", factors, blocks)
    apply = lattice.waves(piece, rows.reshape(2, len(blocks), 4, 3))
    M = np.stack([apply(e) for e in np.eye(J.shape[0])], axis=1)
    np.testing.assert_allclose(M, M.T, atol=1e-5 * np.abs(M).max())
    index = np.tile(J.indices.reshape(-1, 2, 12)[:, 0], (2, 1))
    scaled = sparse.rows(rows.reshape(-1, 1, 12), index, J.shape[1])
    half = np.linalg.cholesky((M + M.T) / 2)  # fails unless all is positive
    values = np.linalg.eigvalsh(half.T @ (scaled @ scaled.T) @ half)
    plain = np.linalg.eigvalsh((scaled @ scaled.T).toarray())
    assert 0 < values[-1] / values[0] < 0.6 * plain[-1] / plain[0]


@pytest.fixture(scope="module")
def large():
    """A grid of more quads than are solved at once, in a number of its own."""
    return shuffled(*surfaces.freeform_patch(50, 44))


def test_a_large_grid_goes_from_coarse_to_fine_by_itself(large):
    V, Q = large
    near, seen = reference.mesh(V, Q), []
    found = solver.optimize(V, Q, 60 * DEGREE, 75 * DEGREE, callback=lambda *a: seen.append(a))
    assert found.converged and measure.deviations(found.V, Q, *np.radians([60, 75])).max() < 1e-10
    kinds = [step.kind for step in found.history]
    assert kinds[0] == "start" and "refined" in kinds and kinds[-1] == "angle"
    assert [step for step, _ in seen] == found.history[1:]
    assert all(W.shape == V.shape for _, W in seen)
    plain = solver.optimize(V, Q, 60 * DEGREE, 75 * DEGREE, iterations=40)
    assert "refined" not in [step.kind for step in plain.history]
    assert measure.quality(found.V, Q).area_ratio > measure.quality(plain.V, Q).area_ratio
    close = solver.optimize(V, Q, 60 * DEGREE, 75 * DEGREE, reference=near)
    assert close.converged and "refined" in [step.kind for step in close.history]
    far, nearer = (
        np.linalg.norm(near.closest(W)[0] - W, axis=1).mean() for W in (found.V, close.V)
    )
    assert nearer < far / 2


@pytest.mark.parametrize("given", [{}, {"mu": 1.1}, {"theta": 1.2}, {"equal": True}])
def test_free_ratios_go_from_coarse_to_fine(large, given):
    found = solver.optimize(*large, **given)
    assert found.converged and "refined" in [step.kind for step in found.history]
    lam, mu = measure.ratios(found.V, large[1])
    np.testing.assert_allclose([lam, mu], [[found.lam] * len(lam), [found.mu] * len(mu)], rtol=1e-9)


def test_what_forbids_a_coarser_grid_is_respected(large):
    V, Q = large
    corners = np.flatnonzero(np.bincount(Q.ravel()) == 1)
    found = solver.optimize(V, Q, 75 * DEGREE, 75 * DEGREE, fixed=corners)
    assert found.converged and "refined" in [step.kind for step in found.history]
    np.testing.assert_array_equal(found.V[corners], V[corners])
    inside = np.flatnonzero(np.bincount(Q.ravel()) == 4)[0]
    wavy = V + 0.02 * np.stack([np.sin(900 * V[:, 1] ** 2), 0 * V[:, 0], 0 * V[:, 0]], axis=1)
    for start, options in ((V, {"fixed": [inside]}), (wavy, {}), (V, {"shape_steps": 0})):
        options |= {"via": "jump", "callback": lambda step, _: step.kind == "none"}
        found = solver.optimize(start, Q, 75 * DEGREE, 75 * DEGREE, **options)
        assert "stopped" in found.message and len(found.history) == 2
        assert np.shape(found.V) == V.shape


def test_a_caller_stops_on_a_coarser_grid(large):
    calls = []
    found = solver.optimize(*large, 1.2, 1.2, callback=lambda step, V: calls.append(V) or False)
    assert len(calls) == 1 and not found.converged and "stopped" in found.message
    assert [step.kind for step in found.history] == ["start", "shape", "refined"]


@pytest.mark.parametrize("make", [examples.wavy_roof, examples.saddle_with_hole])
def test_large_covers_are_exact_and_on_the_surface(make):
    theta, theta0 = 75 * DEGREE, 50 * DEGREE
    net = design.cover(*make(20), theta, theta0, count=6000, direction=0.3)
    assert net.report.converged and net.report.flips == 0
    assert measure.deviations(net.V, net.Q, theta, theta0).max() < 2e-11
    assert net.report.distance_max < 1e-5
    assert len(net.Q) == pytest.approx(6000, rel=0.005)
