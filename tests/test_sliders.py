"""Figures with sliders: still by default, live on request, and true at every place."""

import io

import matplotlib.pyplot as plt
import numpy as np
import PIL.Image
import pytest

from inetlib import parallelogram, raster, sliders
from inetlib.drawings import ideas

render = raster.render
RANGES = {
    ideas.star: {"theta": (20, 160, 70), "theta0": (20, 160, 55)},
    ideas.half_plane: {"theta": (20, 160, 60), "theta0": (20, 160, 50)},
    ideas.mercator: {"theta": (40, 140, 75), "theta0": (40, 140, 60)},
    ideas.refinement: {"m": (6, 64, 16)},
    ideas.bending: {"curvature": (0.0, 1.0, 0.5)},
}


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Surfaces are painted coarsely here, and quickly."""
    monkeypatch.setattr(raster, "render", lambda *args: render(*args[:2], 150, *args[3:]))


def pixels(png):
    return np.asarray(PIL.Image.open(io.BytesIO(png)).convert("RGB"), dtype=int)


@pytest.mark.notebook
@pytest.mark.parametrize("draw", RANGES)
def test_a_slider_redraws_the_figure_and_a_tool_gets_the_first_one(draw):
    still = sliders.slide(draw, live=False, **RANGES[draw])
    box = sliders.slide(draw, live=True, **RANGES[draw])
    *bars, picture, words = box.children
    assert [bar.description for bar in bars] == list(RANGES[draw])
    assert picture.value == still.data and words.value == ""
    first = pixels(still.data)
    assert np.ptp(first) > 100
    bars[0].value = bars[0].max
    moved = pixels(picture.value)
    assert moved.shape == first.shape and np.abs(moved - first).max() > 100
    bars[0].value = RANGES[draw][bars[0].description][2]
    assert picture.value == still.data


def test_what_is_refused_is_said_and_the_picture_stays():
    def draw(m):
        if m > 3:
            raise ValueError(f"m = {m}: 3 or less is wanted")
        return plt.figure(figsize=(1, 1))

    bar, picture, words = sliders.slide(draw, live=True, m=(1, 5, 2)).children
    before = picture.value
    bar.value = 4
    assert words.value == "m = 4: 3 or less is wanted" and picture.value == before
    bar.value = 3
    assert words.value == ""


def test_the_star_marks_the_ratios_and_refinement_has_the_second_order():
    theta, theta0 = np.radians([100, 40])
    figure = ideas.star(theta, theta0)
    plt.close(figure)
    (point,) = (line for line in figure.axes[0].lines if line.get_marker() == "o")
    found = float(point.get_xdata()[0]), float(point.get_ydata()[0])
    assert found == pytest.approx(parallelogram.ratios(theta, theta0))
    figure = ideas.refinement(32)
    plt.close(figure)
    sizes, off = figure.axes[1].lines[0].get_data()
    order = np.log(off[-2] / off[-1]) / np.log(sizes[-1] / sizes[-2])
    assert order == pytest.approx(2, abs=0.1)


def test_the_pencil_of_the_half_plane_has_the_angles_asked_for():
    theta, theta0 = np.radians([75, 50])
    figure = ideas.half_plane(theta, theta0)
    plt.close(figure)
    ways = {}
    for collection in figure.axes[1].collections:
        (a, b), colour = collection.get_segments()[0], tuple(collection.get_colors()[0])
        ways[colour] = b - a
    u, v, d2, d1 = ways.values()  # in the order in which they are drawn
    pairs = [[x / np.linalg.norm(x) for x in pair] for pair in ((u, v), (d1, d2))]
    between = [np.arccos(one @ two) for one, two in pairs]
    assert between == pytest.approx([theta0, theta])
