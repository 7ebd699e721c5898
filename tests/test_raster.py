"""`raster`: pixels against a plain loop; test_drawings casts rays at what is hidden."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from inetlib import plot, raster

ABOVE, BELOW = plot.camera(0, np.pi / 2), plot.camera(0, -np.pi / 2)
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
FACE = np.array([[0, 1, 2, 3]])
ACROSS, UP = np.array([0, 1.0, 0]), np.array([0, 0, 1.0])
RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@pytest.mark.parametrize("seed", range(3))
def test_a_pixel_shows_the_nearest_triangle_over_its_middle(seed):
    rng = np.random.default_rng(seed)
    xy, near, T = rng.uniform(-5, 35, (60, 2)), rng.uniform(0, 9, 60), np.arange(60).reshape(-1, 3)
    xy = np.round(xy * raster.SUB) / raster.SUB
    seen = raster.buffer(xy, near, T, (24, 31))
    for row in range(24):
        for column in range(31):
            middle, best = (column + 0.5, row + 0.5), (-np.inf, -1)
            for k, corners in enumerate(T):
                a = np.vstack([xy[corners].T, np.ones(3)])
                parts = np.linalg.solve(a, [*middle, 1])
                if parts.min() >= 0:
                    best = max(best, (parts @ near[corners], k))
            at = 23 - row, column
            assert seen.face[at] == best[1]
            assert seen.depth[at] == pytest.approx(best[0])


def test_of_equally_near_triangles_the_first_is_seen_and_flat_ones_never():
    xy, T = (
        np.array([[0, 0], [8, 0], [0, 8], [4, 4.0]]),
        np.array([[0, 3, 3], [0, 1, 2], [2, 1, 0]]),
    )
    seen = raster.buffer(xy, np.ones(4), T, (8, 8))
    assert set(np.unique(seen.face)) == {-1, 1}
    assert np.count_nonzero(seen.face == 1) in (28, 36)  # below a diagonal, or with it


@pytest.mark.parametrize("view, wanted", [(ABOVE, BLUE), (BELOW, RED)])
def test_a_picture_shows_the_nearest_surface_whatever_the_order(view, wanted):
    one, two = (SQUARE, FACE, RED), (SQUARE + UP, FACE, BLUE)
    for layers in ([one, two], [two, one]):
        scene = raster.render(view, layers, 50)
        colour = scene.image[25, 25]
        np.testing.assert_array_equal(colour[:3] > 0, np.array(wanted) > 0)
        assert colour[3] == 1 and scene.image[0, 0, 3] == 0
        assert len(raster.in_front(scene, view, [SQUARE[:2] + 0.5 * ACROSS + layers[0][0][0]])) == (
            layers[0][2] == wanted
        )


def test_a_surface_is_darker_the_more_it_turns_from_the_light_and_inside_and_in_hollows():
    def tone(normal):
        """Of a disk around the view's axis, whose normals are all these."""
        seen = raster.buffer(
            8 * SQUARE[:, :2], np.zeros(4), np.array([[0, 1, 2], [0, 2, 3]]), (8, 8)
        )
        unit = np.tile(np.array(normal) / np.linalg.norm(normal), (4, 1))
        return raster.picture(seen, unit, np.ones((2, 3)), np.array([[0, 1, 2], [0, 2, 3]]))[
            4, 4, 0
        ]

    tones = [tone(normal) for normal in (raster.LIGHT, (0, 0, 1), (0, 0, -1), (0.9, -0.1, 0.1))]
    assert tones == sorted(tones, reverse=True) and tones[0] <= 1
    assert tones[2] == pytest.approx(raster.INSIDE * tones[1])
    floor, wall = (SQUARE, FACE, RED), (SQUARE[:, [2, 1, 0]], FACE, BLUE)
    image = raster.render(plot.camera(0.3, 1.4), [floor, wall], 200).image
    red = image[..., 0] * (image[..., 2] == 0)
    lit = red[red > 0]
    assert lit.min() < 0.8 * np.median(lit)  # beside the wall


def test_a_line_is_cut_where_a_surface_hides_it():
    view, roof = plot.camera(0, np.pi / 2), SQUARE * [0.5, 1, 1] + np.array([0.25, 0, 1])
    layers = [(SQUARE, FACE, RED), (roof, FACE, BLUE)]
    scene = raster.render(view, layers, 200)
    runs = raster.in_front(scene, view, [[[0, 0.5, 0], [1, 0.5, 0]]])
    ends = sorted(x for run in runs for x in run[[0, -1], 0])
    np.testing.assert_allclose(ends, [0, 0.25, 0.75, 1], atol=0.02)
    assert len(raster.in_front(scene, view, [[[0, 0.5, 1], [1, 0.5, 1]]], layers=2)) == 1


def test_a_pixel_is_decided_alike_where_the_last_digits_differ():
    angle = np.pi / 8 * np.arange(16)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    V, k = np.concatenate([ring, ring + UP]), np.arange(16)
    Q = np.stack([k + 16, k, (k + 1) % 16, (k + 1) % 16 + 16], axis=1)
    view = plot.camera(0.0, 0.3)
    images = []
    for seed in range(4):
        noise = 1e-13 * np.random.default_rng(seed).uniform(-1, 1, V.shape)
        scene = raster.render(view, [(V * (1 + noise), Q, plot.PALE)], 150)
        images.append(scene.image)
        assert np.abs(images[0] - scene.image).max() < 1e-6
    assert np.ptp(images[0][..., :3]) > 0.3 and to_rgb(plot.PALE)
