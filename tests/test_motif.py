"""Motifs: similar in every quad of a net, by lengths and angles measured here."""

import numpy as np
import pytest

from inetlib import motif, parallelogram, solver, surfaces

THETA, THETA0 = 1.1, 1.0
LAM = parallelogram.ratios(THETA, THETA0)[0]
ONE, TWO = np.array([1.0, 0.0]), LAM * np.array([np.cos(THETA), np.sin(THETA)])


@pytest.fixture(scope="module")
def net():
    V, Q = surfaces.freeform_patch(5, 4)
    return solver.optimize(V, Q, THETA, THETA0).V, Q


def test_every_copy_is_a_similar_image(net):
    points = np.random.default_rng(0).normal(size=(6, 2))
    (copies,) = motif.place(*net, [points], LAM, THETA)
    plane = np.linalg.norm(points[:, None] - points, axis=2)
    space = np.linalg.norm(copies[:, :, None] - copies[:, None], axis=3)
    quotient = space[:, plane > 0] / plane[plane > 0]
    np.testing.assert_allclose(quotient / quotient[:, :1], 1, atol=1e-9)


def test_the_corners_of_the_parallelogram_are_the_middles_of_the_edges(net):
    corners = np.array([-ONE - TWO, ONE - TWO, ONE + TWO, TWO - ONE])
    (copies,) = motif.place(*net, [corners], LAM, THETA)
    v1, v2, v3, v4 = np.moveaxis(net[0][net[1]], 1, 0)
    middles = np.stack([v1 + v2, v2 + v3, v3 + v4, v4 + v1], axis=1) / 2
    np.testing.assert_allclose(copies, middles, atol=1e-12)


def test_the_weave_joins_opposite_corners_and_goes_on_in_the_neighbours(net):
    one, other = waves = motif.weave(LAM, THETA)
    np.testing.assert_allclose(one[[0, -1]], [-ONE - TWO, ONE + TWO], atol=1e-12)
    np.testing.assert_allclose(other[[0, -1]], [TWO - ONE, ONE - TWO], atol=1e-12)
    placed = motif.place(*net, waves, LAM, THETA)
    ends = np.concatenate([copy[:, [0, -1]].reshape(-1, 3) for copy in placed])
    apart = np.linalg.norm(ends[:, None] - ends, axis=2) < 1e-9
    faces, edges = 5 * 4, 5 * 5 + 6 * 4
    assert apart.sum() == (4 * faces - edges) * 2 + 4 * faces  # pairs meet at inner edges


def test_bad_motifs_are_refused(net):
    for lam, theta, word in ((1.0, 0.0, "theta = 0"), (-1.0, 1.0, "lam = -1")):
        with pytest.raises(ValueError, match=word):
            motif.place(*net, [np.zeros((3, 2))], lam, theta)
    for bad in (np.zeros((3, 3)), [[0, np.nan]]):
        with pytest.raises(ValueError, match="finite numbers"):
            motif.place(*net, [bad], 1.0, 1.0)
