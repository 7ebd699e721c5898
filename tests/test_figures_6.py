"""The nets of Figs. 12 and 13, judged by `measure`: angles, faces, steps, and how they differ."""

from itertools import combinations

import matplotlib.pyplot as plt
import numpy as np
import pytest

from inetlib import measure, mesh, moebius, solver
from inetlib.drawings import fig12, fig13, patches
from inetlib.parallelogram import angles as exact_angles

STEPS = 17  # of the paper's runs


@pytest.fixture(scope="module")
def patch():
    return fig12.nets()


@pytest.fixture(scope="module")
def rings():
    return fig13.nets()


@pytest.fixture(autouse=True)
def no_open_figures():
    yield
    plt.close("all")


def degrees_off(V, Q, asked):
    return max(
        np.degrees(np.abs(x - a)).max() for x, a in zip(measure.angles(V, Q), asked, strict=True)
    )


def good(result, Q):
    asked = exact_angles(result.lam, result.mu)
    quality = measure.quality(result.V, Q)
    assert degrees_off(result.V, Q, asked) < 1e-9
    assert quality.flips == 0
    assert quality.area_ratio > 0.05
    assert result.converged
    assert 1 <= len(result.history) - 1 <= STEPS


@pytest.mark.parametrize("letter", "ABCDE")
def test_the_patch_becomes_isogonal(patch, letter):
    _, Q, found = patch
    good(found[letter], Q)
    names = "theta", "theta0"
    for name, values in zip(names, measure.angles(found[letter].V, Q), strict=True):
        wanted = fig12.SETTINGS[letter].get(name, values.mean())
        np.testing.assert_allclose(values, wanted, atol=np.radians(1e-9))


def test_the_parallelograms_are_what_the_titles_say(patch):
    _, Q, found = patch
    sides = {}
    for letter, result in found.items():
        board = mesh.checkerboard(result.V, Q)
        P = board.V[board.black]
        a, b = P[:, 1] - P[:, 0], P[:, 2] - P[:, 1]
        lengths = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
        cosine = np.einsum("ij,ij->i", a, b) / lengths[0] / lengths[1]
        sides[letter] = np.log(lengths[1] / lengths[0]), cosine
    for letter in "BD":  # right angles
        assert np.abs(sides[letter][1]).max() < 1e-11
    for letter in "CD":  # equal sides
        assert np.abs(sides[letter][0]).max() < 1e-11
    assert np.abs(sides["B"][0]).min() > 0.1 and np.abs(sides["C"][1]).min() > 0.1
    golden = np.log((1 + np.sqrt(5)) / 2)
    np.testing.assert_allclose(np.abs(sides["E"][0]), golden, atol=1e-11)
    np.testing.assert_allclose(np.abs(sides["E"][1]), 0.5, atol=1e-11)


def test_the_five_nets_differ_visibly_and_stay_near_the_start(patch):
    V, _, found = patch
    nets = [result.V for result in found.values()]
    apart = [np.linalg.norm(a - b, axis=1).mean() for a, b in combinations(nets, 2)]
    assert min(apart) > 0.02  # of the diagonal; an edge is about 0.03
    assert max(np.linalg.norm(W - V, axis=1).max() for W in nets) < 0.15


def test_the_hexagon_mesh_becomes_isogonal(rings):
    _, Q, polygon, found = rings
    assert len(Q) == 432 and len(polygon) == 6
    for letter, asked in (("A", (60, 60)), ("B", (60, 45))):
        good(found[letter], Q)
        assert degrees_off(found[letter].V, Q, np.radians(asked)) < 1e-9
        corners = found[letter].V[polygon]
        assert np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min() > 0.01


def test_the_images_are_moebius_images_and_nearly_isogonal(rings):
    _, Q, _, found = rings
    for result in found.values():
        W = moebius.apply(moebius.inversion(fig13.CENTRE, fig13.RADIUS), result.V)
        assert measure.quality(W, Q).flips == 0
        off = degrees_off(W, Q, (result.theta, result.theta0))
        assert 0.01 < off < 2  # finite quads: not exact
        centre = np.array(fig13.CENTRE)
        back = centre + fig13.RADIUS**2 * (W - centre) / np.sum((W - centre) ** 2, axis=1)[:, None]
        np.testing.assert_allclose(back, result.V, atol=1e-12)


def test_the_start_is_seen_by_the_judge(patch):
    V, Q, found = patch
    off = np.degrees(measure.deviations(V, Q).max(axis=0))
    theta, theta0 = np.degrees(measure.angles(V, Q))
    assert off[0] == pytest.approx(
        max(abs(theta[0] - theta.mean()), abs(theta0[0] - theta0.mean()))
    )
    assert off.max() > 20  # there is something to do
    assert np.all(off >= np.abs(theta0 - theta0.mean()) - 1e-12)
    assert np.degrees(measure.deviations(found["A"].V, Q)).max() < 1e-9


def test_the_paper_formulation_runs_from_the_same_start():
    V, Q, found = fig12.nets("paper, splu", m=8, n=8)
    assert {k: len(r.history) - 1 for k, r in found.items()} == fig12.ITERATIONS
    assert all(r.history[-1].flips == 0 and r.history[-1].residual < 1e-8 for r in found.values())
    for result in found.values():
        assert result.history[-1].flips == measure.quality(result.V, Q).flips
        assert np.linalg.norm(result.V - V, axis=1).max() < 0.2


@pytest.mark.parametrize("module", [fig12, fig13])
def test_drawings_list_their_nets_and_steps(module):
    drawing = module.draw()
    assert drawing.name == module.__name__.rsplit(".", 1)[1]
    assert len(drawing.nets) == len(module.SETTINGS)
    for letter, (V, Q, *asked) in zip(module.SETTINGS, drawing.nets, strict=True):
        assert degrees_off(V, Q, asked) < 1e-9
        assert drawing.claims[f"{letter}_steps"] <= STEPS
        np.testing.assert_allclose(drawing.data[f"net_{letter}"], V, atol=6e-5)


def test_four_coloured_faces_are_laid_into_their_plane(patch):
    _, Q, found = patch
    _, ax = plt.subplots()
    patches.enlarged(ax, [0, 0, 1, 1], found["D"].V, Q, np.array([189, 190, 209, 210]))
    quads = [p.vertices[:4] for p in ax.child_axes[0].collections[1].get_paths()]
    assert len(quads) == 4
    for quad in quads:
        sides = np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1)
        assert sides.max() / sides.min() < 1.02  # squares, a little tilted


def test_results_hardly_feel_the_last_digits_of_the_start():
    V, Q = fig12.surfaces.freeform_patch(8, 8)
    noise = 1e-14 * np.sin(np.arange(V.size)).reshape(V.shape)
    one, two = (solver.optimize(W, Q, theta=np.pi / 2) for W in (V, V + noise))
    assert len(one.history) == len(two.history)
    assert np.abs(one.V - two.V).max() < 1e-10
