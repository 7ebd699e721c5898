"""Motifs: similar in every quad of a net, by lengths and angles measured here."""

import numpy as np
import pytest

from inetlib import motif, parallelogram, solver, surfaces

ANGLES = 1.1, 1.0


def net():
    V, Q = surfaces.freeform_patch(5, 4)
    return solver.optimize(V, Q, *ANGLES).V, Q


def test_every_copy_is_a_similar_image():
    V, Q = net()
    lam, _ = parallelogram.ratios(*ANGLES)
    points = np.random.default_rng(0).normal(size=(6, 2))
    (copies,) = motif.place(V, Q, [points], lam, ANGLES[0])
    plane = np.linalg.norm(points[:, None] - points, axis=2)
    space = np.linalg.norm(copies[:, :, None] - copies[:, None], axis=3)
    quotient = space[:, plane > 0] / plane[plane > 0]
    np.testing.assert_allclose(quotient / quotient[:, :1], 1, atol=1e-9)


def test_the_corners_of_the_parallelogram_are_the_middles_of_the_edges():
    V, Q = net()
    lam, _ = parallelogram.ratios(*ANGLES)
    two = lam * np.array([np.cos(ANGLES[0]), np.sin(ANGLES[0])])
    one = np.array([1.0, 0.0])
    corners = np.array([-one - two, one - two, one + two, two - one])
    (copies,) = motif.place(V, Q, [corners], lam, ANGLES[0])
    v1, v2, v3, v4 = np.moveaxis(V[Q], 1, 0)
    middles = np.stack([v1 + v2, v2 + v3, v3 + v4, v4 + v1], axis=1) / 2
    np.testing.assert_allclose(copies, middles, atol=1e-12)


def test_the_circle_touches_two_sides_and_the_waves_join_opposite_corners():
    for lam, theta in ((1.5, 1.0), (0.6, 2.0)):
        two = lam * np.array([np.cos(theta), np.sin(theta)])
        sides = np.array([[1.0, 0.0], two])
        inside = np.linalg.solve(sides.T, motif.inner_circle(lam, theta, 1.0, 721).T)
        assert np.abs(inside).max() == pytest.approx(1, abs=1e-4)
        one, other = motif.weave(lam, theta)
        np.testing.assert_allclose(one[[0, -1]], [-sides[0] - two, sides[0] + two], atol=1e-12)
        np.testing.assert_allclose(other[[0, -1]], [two - sides[0], sides[0] - two], atol=1e-12)


def test_the_weave_goes_on_in_the_neighbours():
    V, Q = net()
    lam, _ = parallelogram.ratios(*ANGLES)
    placed = motif.place(V, Q, motif.weave(lam, ANGLES[0]), lam, ANGLES[0])
    ends = np.concatenate([copy[:, [0, -1]].reshape(-1, 3) for copy in placed])
    apart = np.linalg.norm(ends[:, None] - ends, axis=2) < 1e-9
    edges = 5 * 5 + 6 * 4
    assert apart.sum() == (4 * len(Q) - edges) * 2 + 4 * len(Q)  # pairs meet at inner edges


def test_bad_motifs_are_refused():
    V, Q = net()
    with pytest.raises(ValueError, match="theta = 0"):
        motif.place(V, Q, [np.zeros((3, 2))], 1.0, 0.0)
    for bad in (np.zeros((3, 3)), [[0, np.nan]]):
        with pytest.raises(ValueError, match="finite numbers"):
            motif.place(V, Q, [bad], 1.0, 1.0)
