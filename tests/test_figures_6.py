"""The nets of Figs. 12 and 13, judged by `measure`: angles, faces, steps, and how they differ."""

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial import procrustes

from inetlib import measure, mesh, moebius, parallelogram
from inetlib.drawings import fig12, fig13

STEPS = 17  # of the paper's runs
patch, rings = cache(fig12.nets), cache(fig13.nets)


def off(V, Q, asked):
    """The largest deviation of both angles, degrees."""
    return np.degrees(measure.deviations(V, Q, *asked)).max()


def good(result, Q):
    quality = measure.quality(result.V, Q)
    assert off(result.V, Q, parallelogram.angles(result.lam, result.mu)) < 1e-9
    assert quality.flips == 0 and quality.area_ratio > 0.05
    assert result.converged and 1 <= len(result.history) - 1 <= STEPS


@pytest.mark.parametrize("letter", "ABCDE")
def test_the_patch_becomes_isogonal(letter):
    starts, Q, found = patch()
    good(found[letter], Q)
    wanted = fig12.SETTINGS[letter]
    asked = wanted.get("theta"), wanted.get("theta0")
    assert off(found[letter].V, Q, asked) < 1e-9
    assert off(starts[letter], Q, asked) > 15  # there was something to do


def test_the_parallelograms_are_what_the_titles_say():
    _, Q, found = patch()
    sides = {}
    for letter, result in found.items():
        board = mesh.checkerboard(result.V, Q)
        P = board.V[board.black]
        a, b = P[:, 1] - P[:, 0], P[:, 2] - P[:, 1]
        lengths = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
        cosine = np.einsum("ij,ij->i", a, b) / lengths[0] / lengths[1]
        sides[letter] = np.log(lengths[1] / lengths[0]), cosine
    for letter in "ABCDE":  # similar
        assert max(map(np.ptp, sides[letter])) < 1e-11
    for letter in "BD":  # right angles
        assert np.abs(sides[letter][1]).max() < 1e-11
    for letter in "CD":  # equal sides
        assert np.abs(sides[letter][0]).max() < 1e-11
    assert np.abs(sides["B"][0]).min() > 0.1 and np.abs(sides["C"][1]).min() > 0.1
    golden = np.log((1 + np.sqrt(5)) / 2)
    np.testing.assert_allclose(np.abs(sides["E"][0]), golden, atol=1e-11)
    np.testing.assert_allclose(np.abs(sides["E"][1]), 0.5, atol=1e-11)


def test_the_five_nets_have_different_shapes_and_stay_near_their_starts():
    starts, _, found = patch()
    points = [result.V.reshape(21, 21, 3) for result in found.values()]
    turned = [np.rot90(P, k) for P in points for k in range(4)]
    for (i, P), (j, W) in combinations(enumerate(turned), 2):
        if i // 4 != j // 4:  # the part of the variance that no similarity explains
            assert procrustes(P.reshape(-1, 3), W.reshape(-1, 3))[2] > 0.04
    for letter, V in starts.items():
        assert np.linalg.norm(np.ptp(V, axis=0)) == pytest.approx(1)
        assert np.linalg.norm(found[letter].V - V, axis=1).max() < 0.15


def test_the_hexagon_mesh_becomes_isogonal():
    _, Q, polygon, found = rings()
    assert len(Q) == 432 and len(polygon) == 6
    for letter, asked in (("A", (60, 60)), ("B", (60, 45))):
        good(found[letter], Q)
        assert off(found[letter].V, Q, np.radians(asked)) < 1e-9
        corners = found[letter].V[polygon]
        assert np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min() > 0.01


def test_the_images_are_moebius_images_and_nearly_isogonal():
    _, Q, _, found = rings()
    for result in found.values():
        W = moebius.apply(moebius.inversion(fig13.CENTRE, fig13.RADIUS), result.V)
        assert measure.quality(W, Q).flips == 0
        # finite quads: not exact
        assert 0.01 < off(W, Q, (result.theta, result.theta0)) < 2
        centre = np.array(fig13.CENTRE)
        back = centre + fig13.RADIUS**2 * (W - centre) / np.sum((W - centre) ** 2, axis=1)[:, None]
        np.testing.assert_allclose(back, result.V, atol=1e-12)


def test_the_paper_formulation_runs_from_the_same_start():
    starts, Q, found = fig12.nets("paper, splu", m=8, n=8)
    assert {k: len(r.history) - 1 for k, r in found.items()} == fig12.ITERATIONS
    assert all(r.history[-1].flips == 0 and r.history[-1].residual < 1e-8 for r in found.values())
    for letter, result in found.items():
        assert result.history[-1].flips == measure.quality(result.V, Q).flips
        assert np.linalg.norm(result.V - starts[letter], axis=1).max() < 0.2
