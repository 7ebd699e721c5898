"""`plot` on the Agg backend: what is handed to matplotlib, point by point."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.colors import to_rgba
from test_measure import sheared

from inetlib import plot

turn = st.floats(-7, 7)
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
FACE = np.array([[0, 1, 2, 3]])
ABOVE, BELOW = plot.camera(0, np.pi / 2), plot.camera(0, -np.pi / 2)
RED, GREEN, BLUE = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1)


@pytest.fixture
def ax():
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def test_the_four_families_can_be_told_apart_in_greyscale():
    assert list(plot.COLOURS) == ["u", "v", "d1", "d2"]
    rgb = np.array([to_rgba(colour)[:3] for colour in plot.COLOURS.values()])
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    lightness = 116 * (linear @ [0.2126, 0.7152, 0.0722]) ** (1 / 3) - 16  # CIE L*, 0 to 100
    assert (np.diff(np.sort(lightness)) > 7).all()


def test_words(ax):
    plot.panel(ax, "C_1", "after the map")
    assert ax.get_title(loc="left") == r"$\mathbf{C_1}$  after the map"
    plot.text(ax, 2 + 3j, "here", halo=2.5)
    (words,) = ax.texts
    assert words.get_position() == (2, 3) and len(words.get_path_effects()) == 1
    assert plot.degrees(np.pi / 3) == r"60\degree"
    assert plot.degrees(np.pi / 3, np.pi / 3) == r"\theta=\theta_0=60\degree"
    assert plot.degrees(1.0, np.pi / 4) == r"\theta=57.3\degree,\ \theta_0=45\degree"


def test_curves_are_drawn_through_the_points_given_and_seen_whole(ax):
    np.testing.assert_array_equal(plot.plane([[1 + 2j], [3j]]), [[[1, 2]], [[0, 3]]])
    np.testing.assert_array_equal(plot.plane([[1, 2], [3, 4]]), [[1, 2], [3, 4]])
    np.testing.assert_array_equal(plot.plane([[1, 2, 9.0]]), [[1, 2]])
    lines = [np.array([0, 2 + 1j]), np.array([[5, 1], [6, -3], [7, 0]])]
    drawn = plot.curves(ax, lines, "#d1440c", width=2.5)
    first, second = (path.vertices for path in drawn.get_paths())
    np.testing.assert_array_equal(first, [[0, 0], [2, 1]])
    np.testing.assert_array_equal(second, lines[1])
    assert drawn.get_linewidths() == [2.5]
    np.testing.assert_allclose(ax.dataLim.get_points(), [[0, -3], [7, 1]])


def test_polygons_are_the_faces_and_black_quads_their_midpoint_parallelograms(ax):
    V, Q = sheared(2, 1, v=(0, 1, 0))
    drawn = plot.polygons(ax, V, Q, fill=["#ff0000", "#0000ff"])
    for path, face in zip(drawn.get_paths(), Q, strict=True):
        np.testing.assert_array_equal(path.vertices[:4], V[face][:, :2])
    np.testing.assert_array_equal(drawn.get_facecolor(), [RED, BLUE])
    plot.black_quads(ax, V, Q)
    middle = (V[Q] + V[np.roll(Q, -1, axis=1)])[:, :, :2] / 2
    black = [path.vertices[:4] for path in ax.collections[1].get_paths()]
    np.testing.assert_allclose(black, middle)


def test_net_draws_each_family_asked_for_in_its_own_colour(ax):
    V, Q = sheared(3, 2, v=(0, 1, 0))
    plot.net(ax, V, Q, families=("u", "v", "d2"))
    u, v, d2 = ax.collections
    assert [len(c.get_paths()) for c in (u, v, d2)] == [3, 4, 4]
    for collection, name in ((u, "u"), (v, "v"), (d2, "d2")):
        np.testing.assert_allclose(collection.get_colors(), [to_rgba(plot.COLOURS[name])])
    assert all(np.ptp(path.vertices[:, 1]) == 0 for path in u.get_paths())
    for path in d2.get_paths():
        step = np.diff(path.vertices, axis=0)
        np.testing.assert_array_equal(step[:, 0], step[:, 1])
    with pytest.raises(ValueError, match=r"no family \['w'\]"):
        plot.net(ax, V, Q, families=("u", "w"))


@given(turn, st.floats(0.05, 3.1), st.floats(0.1, 10))
def test_an_arc_has_the_radius_and_the_opening_of_the_angle(start, opening, radius):
    a, b = (3 * np.array([np.cos(t), np.sin(t)]) for t in (start, start + opening))
    if abs(opening - np.pi / 2) < 1e-6:
        opening, b = 1.0, np.array([np.cos(start + 1), np.sin(start + 1)])
    points = plot.arc([2, -1], a, b, radius) - [2, -1]
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), radius, rtol=1e-12)
    z = points @ [1, 1j]
    assert z[0] / radius == pytest.approx(np.exp(1j * start), abs=1e-9)
    np.testing.assert_allclose(np.angle(z[1:] / z[:-1]), opening / 39, rtol=1e-6)
    np.testing.assert_allclose(plot.arc([0, 0], b, a, radius)[::-1], points, atol=1e-12 * radius)


@given(st.integers(0, 2**32 - 1))
def test_an_arc_in_space_lies_in_the_plane_of_its_directions(seed):
    apex, a, b = np.random.default_rng(seed).normal(size=(3, 3))
    points = plot.arc(apex, a, b, 0.7, samples=9) - apex
    assert points.shape == (9, 3)
    np.testing.assert_allclose(points @ np.cross(a, b), 0, atol=1e-12)
    np.testing.assert_allclose(points[0], 0.7 * a / np.linalg.norm(a), atol=1e-12)
    np.testing.assert_allclose(points[-1], 0.7 * b / np.linalg.norm(b), atol=1e-12)
    opening = np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))
    chord = np.linalg.norm(np.diff(points, axis=0), axis=1)
    np.testing.assert_allclose(chord, 1.4 * np.sin(opening / 16), rtol=1e-9)


def test_a_right_angle_is_a_corner_and_parallel_directions_have_no_arc():
    found = plot.arc([1, 1], [0, 5], [-2, 0], 1)
    np.testing.assert_allclose(found, [[1, 1.7], [0.3, 1.7], [0.3, 1]], atol=1e-15)
    assert plot.arc([0, 0], [1, 0], [1e-6, 1], 1).shape == (40, 2)
    for b in ([2, 0], [-1, 0], [0, 0]):
        with pytest.raises(ValueError, match="are parallel: no arc between them"):
            plot.arc([0, 0], [1, 0], b, 1)


def test_the_label_of_an_angle_stands_outside_the_middle_of_its_arc(ax):
    plot.angle(ax, [1, 0], [1, 0], [1, 1], radius=2, label="x", gap=1.5)
    (line,), (text,) = ax.lines, ax.texts
    np.testing.assert_allclose(np.hypot(*(line.get_xydata() - [1, 0]).T), 2)
    away = complex(*text.get_position()) - 1
    assert text.get_text() == "x" and abs(away) == pytest.approx(3)
    assert np.angle(away) == pytest.approx(np.pi / 8, abs=0.03)
    plot.angle(ax, [0, 0], [1, 0], [1, 1], radius=1)
    assert len(ax.texts) == 1 and len(ax.lines) == 2


def test_an_angle_in_space_is_projected(ax):
    """From above, with x to the right: (x, y, z) is seen at (x, y)."""
    view = plot.camera(-np.pi / 2, np.pi / 2)
    plot.angle(ax, [1, 2, 3], [1, 0, 1], [0, 1, 1], 0.5, "a", camera=view)
    wanted = plot.arc([1, 2, 3], [1, 0, 1], [0, 1, 1], 0.5)
    np.testing.assert_allclose(ax.lines[0].get_xydata(), wanted[:, :2], atol=1e-12)
    middle = np.array([1, 2]) + 1.45 * (wanted[20, :2] - [1, 2])
    np.testing.assert_allclose(ax.texts[0].get_position(), middle, atol=1e-12)


@given(turn, st.floats(-1.5, 1.5))
def test_a_camera_is_a_rotation_that_looks_from_its_direction(azimuth, elevation):
    xy, near = plot.camera(azimuth, elevation)(np.eye(3))
    matrix = np.column_stack([xy, near])
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1)
    assert xy[2, 0] == pytest.approx(0, abs=1e-15)  # z points up on the paper
    assert xy[2, 1] > 0
    level = np.cos(elevation)
    wanted = np.cos(azimuth) * level, np.sin(azimuth) * level, np.sin(elevation)
    np.testing.assert_allclose(near, wanted, atol=1e-15)
    xy, near = plot.camera(0, 0)([2, 3, 5])  # from the x axis y points to the right
    np.testing.assert_allclose([*xy, near], [3, 5, 2], atol=1e-15)


def test_a_scene_is_a_picture_with_one_path_for_each_style_of_lines(ax):
    far = np.array([[0, 0, 0], [5, 5, 5]])
    lines = [(SQUARE[[0, 1]], "#00ff00", 2.0), (SQUARE[[1, 2]], "#00ff00", 2.0), (far, "k", 1)]
    view = plot.camera(0.3, 0.4)
    scene = plot.scene(ax, view, [(SQUARE, FACE, "#ff0000")], lines)
    (image,) = ax.images
    np.testing.assert_array_equal(image.get_extent(), scene.extent)
    assert [to_rgba(patch.get_edgecolor()) for patch in ax.patches] == [GREEN, to_rgba("k")]
    green = ax.patches[0].get_path()
    assert np.count_nonzero(green.codes == 1) == 2
    np.testing.assert_allclose(green.vertices, view(SQUARE[[0, 1, 1, 2]])[0], atol=1e-12)
    box, xy = ax.dataLim.get_points(), view(np.concatenate([SQUARE, far]))[0]
    assert (box[0] <= xy.min(axis=0)).all() and (box[1] >= xy.max(axis=0)).all()


def test_a_board_shows_half_of_a_net_as_parallelograms(ax):
    V, Q = sheared(3, 4, v=(0, 1, 0))
    scene = plot.board(ax, ABOVE, V, Q, fill="#ff0000")
    red = scene.image[..., 2] == 0
    assert np.mean(red[scene.seen.face >= 0]) == pytest.approx(0.5, abs=0.02)
