"""`plot` on the Agg backend: what is handed to matplotlib, point by point."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.collections import LineCollection, PathCollection, PolyCollection

from inetlib import mesh, plot

turn = st.floats(-7, 7)


@pytest.fixture
def ax():
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def grid(m, n):
    V = np.array([[i, j, 0.0] for i in range(m + 1) for j in range(n + 1)])
    return V, mesh.grid_quads(m, n)


# --- style --------------------------------------------------------------------------------


def lightness(colour):
    """CIE L* of an sRGB colour, 0 black to 100 white."""
    rgb = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return 116 * (linear @ [0.2126, 0.7152, 0.0722]) ** (1 / 3) - 16


def test_the_four_families_can_be_told_apart_in_greyscale():
    assert list(plot.COLOURS) == ["u", "v", "d1", "d2"]
    steps = np.diff(sorted(lightness(c) for c in plot.COLOURS.values()))
    assert (steps > 7).all()


def test_the_style_makes_svg_ids_and_glyphs_the_same_on_every_machine():
    with plt.rc_context():
        plt.rcdefaults()
        assert plt.rcParams["svg.hashsalt"] != "inetlib"
        plot.use_style()
        assert plt.rcParams["svg.hashsalt"] == "inetlib"
        assert plt.rcParams["svg.fonttype"] == "path"


def test_the_style_starts_from_the_defaults_of_matplotlib():
    with plt.rc_context():
        plt.rcdefaults()
        plot.use_style()
        wanted = dict(plt.rcParams)
        mine = {"font.size": 20, "lines.linewidth": 4, "figure.dpi": 50, "savefig.bbox": "tight"}
        plt.rcParams.update(mine | {"axes.prop_cycle": plt.cycler(color="rgb")})
        plot.use_style()
        differ = {name for name, value in plt.rcParams.items() if value != wanted[name]}
        assert differ == set()


def test_canvas_has_the_panels_asked_for_without_frames_and_with_equal_aspect():
    figure, axes = plot.canvas([["A", "B"], ["C", "C"]], 6, 4, ratios=[1, 2])
    assert set(axes) == {"A", "B", "C"}
    np.testing.assert_allclose(figure.get_size_inches(), (6, 4))
    for ax in axes.values():
        assert ax.get_aspect() == 1
        assert not ax.axison
    assert axes["A"].get_gridspec().get_width_ratios() == [1, 2]
    plt.close(figure)


def test_panel_writes_its_letter_in_bold_and_the_text_after_it(ax):
    plot.panel(ax, "B", "after the map")
    assert ax.get_title(loc="left") == r"$\mathbf{B}$  after the map"
    plot.panel(ax, "C_1")
    assert ax.get_title(loc="left") == r"$\mathbf{C_1}$"


# --- in the plane -------------------------------------------------------------------------


def test_plane_takes_complex_numbers_pairs_and_triples():
    np.testing.assert_array_equal(plot.plane([[1 + 2j], [3j]]), [[[1, 2]], [[0, 3]]])
    np.testing.assert_array_equal(plot.plane([[1, 2], [3, 4]]), [[1, 2], [3, 4]])
    np.testing.assert_array_equal(plot.plane([[1, 2, 9.0]]), [[1, 2]])


def test_curves_are_drawn_through_the_points_given_and_seen_whole(ax):
    lines = [np.array([0, 2 + 1j]), np.array([[5, 1], [6, -3], [7, 0]])]
    drawn = plot.curves(ax, lines, "#d1440c", width=2.5)
    assert isinstance(drawn, LineCollection)
    first, second = (path.vertices for path in drawn.get_paths())
    np.testing.assert_array_equal(first, [[0, 0], [2, 1]])
    np.testing.assert_array_equal(second, lines[1])
    assert drawn.get_linewidths() == [2.5]
    np.testing.assert_allclose(ax.dataLim.get_points(), [[0, -3], [7, 1]])


def test_polygons_are_the_faces_with_one_colour_each(ax):
    V, Q = grid(2, 1)
    drawn = plot.polygons(ax, V, Q, fill=["#ff0000", "#0000ff"])
    assert isinstance(drawn, PolyCollection)
    for path, face in zip(drawn.get_paths(), Q, strict=True):
        np.testing.assert_array_equal(path.vertices[:4], V[face][:, :2])
    np.testing.assert_array_equal(drawn.get_facecolor(), [[1, 0, 0, 1], [0, 0, 1, 1]])


def test_net_draws_each_family_asked_for_in_its_own_colour(ax):
    V, Q = grid(3, 2)
    plot.net(ax, V, Q, families=("u", "v", "d2"))
    u, v, d2 = ax.collections
    counts = [len(c.get_paths()) for c in (u, v, d2)]
    assert counts == [3, 4, 4]
    for collection, name in ((u, "u"), (v, "v"), (d2, "d2")):
        wanted = plt.matplotlib.colors.to_rgba(plot.COLOURS[name])
        np.testing.assert_allclose(collection.get_colors(), [wanted])
    for path in u.get_paths():
        assert np.ptp(path.vertices[:, 1]) == 0
    for path in d2.get_paths():
        step = np.diff(path.vertices, axis=0)
        np.testing.assert_array_equal(step[:, 0], step[:, 1])


def test_black_quads_are_the_midpoint_parallelograms(ax):
    V, Q = grid(3, 2)
    plot.black_quads(ax, V, Q)
    (drawn,) = ax.collections
    middle = (V[Q] + V[np.roll(Q, -1, axis=1)])[:, :, :2] / 2
    found = [path.vertices[:4] for path in drawn.get_paths()]
    np.testing.assert_allclose(found, middle)


# --- angle marks --------------------------------------------------------------------------


@given(turn, st.floats(0.05, 3.1), st.floats(0.1, 10))
def test_an_arc_has_the_radius_and_the_opening_of_the_angle(start, opening, radius):
    a, b = (3 * np.array([np.cos(t), np.sin(t)]) for t in (start, start + opening))
    if abs(opening - np.pi / 2) < 1e-6:
        opening, b = 1.0, np.array([np.cos(start + 1), np.sin(start + 1)])
    points = plot.arc([2, -1], a, b, radius) - [2, -1]
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), radius, rtol=1e-12)
    z = points @ [1, 1j]
    assert z[0] / radius == pytest.approx(np.exp(1j * start), abs=1e-9)
    steps = np.angle(z[1:] / z[:-1])
    np.testing.assert_allclose(steps, opening / 39, rtol=1e-6)


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


def test_an_arc_takes_the_short_way_whichever_direction_comes_first():
    one, two = plot.arc([0, 0], [1, 0], [1, 1], 1), plot.arc([0, 0], [1, 1], [1, 0], 1)
    np.testing.assert_allclose(one, two[::-1], atol=1e-12)


def test_a_right_angle_is_a_corner():
    found = plot.arc([1, 1], [0, 5], [-2, 0], 1)
    np.testing.assert_allclose(found, [[1, 1.7], [0.3, 1.7], [0.3, 1]], atol=1e-15)
    assert plot.arc([0, 0], [1, 0], [1e-6, 1], 1).shape == (40, 2)


@pytest.mark.parametrize("b", [[2, 0], [-1, 0], [0, 0]])
def test_parallel_directions_have_no_arc(b):
    with pytest.raises(ValueError, match="are parallel: no arc between them"):
        plot.arc([0, 0], [1, 0], b, 1)


def test_the_label_of_an_angle_stands_outside_the_middle_of_its_arc(ax):
    plot.angle(ax, [1, 0], [1, 0], [1, 1], radius=2, label="x", gap=1.5)
    (line,), (text,) = ax.lines, ax.texts
    np.testing.assert_allclose(np.hypot(*(line.get_xydata() - [1, 0]).T), 2)
    assert text.get_text() == "x"
    away = np.array(text.get_position()) - [1, 0]
    assert np.hypot(*away) == pytest.approx(3)
    assert np.arctan2(*away[::-1]) == pytest.approx(np.pi / 8, abs=0.03)


def test_an_angle_without_a_label_writes_nothing(ax):
    plot.angle(ax, [0, 0], [1, 0], [1, 1], radius=1)
    assert len(ax.texts) == 0
    assert len(ax.lines) == 1


def test_an_angle_in_space_is_projected(ax):
    """From above, with x to the right: (x, y, z) is seen at (x, y)."""
    view = plot.camera(-np.pi / 2, np.pi / 2)
    plot.angle(ax, [1, 2, 3], [1, 0, 1], [0, 1, 1], 0.5, "a", camera=view)
    wanted = plot.arc([1, 2, 3], [1, 0, 1], [0, 1, 1], 0.5)
    np.testing.assert_allclose(ax.lines[0].get_xydata(), wanted[:, :2], atol=1e-12)
    middle = np.array([1, 2]) + 1.45 * (wanted[20, :2] - [1, 2])
    np.testing.assert_allclose(ax.texts[0].get_position(), middle, atol=1e-12)


def test_a_vector_reaches_from_start_to_end(ax):
    plot.vector(ax, [1, 1], [5, 3])
    (arrow,) = ax.texts
    assert arrow.xy == pytest.approx((5, 3))
    assert arrow.get_position() == pytest.approx((1, 1))
    assert (arrow.arrowprops["shrinkA"], arrow.arrowprops["shrinkB"]) == (0, 0)
    np.testing.assert_allclose(ax.dataLim.get_points(), [[1, 1], [5, 3]])


# --- in space -----------------------------------------------------------------------------


@given(turn, st.floats(-1.5, 1.5))
def test_a_camera_is_a_rotation(azimuth, elevation):
    xy, near = plot.camera(azimuth, elevation)(np.eye(3))
    matrix = np.column_stack([xy, near])
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1)
    assert xy[2, 0] == pytest.approx(0, abs=1e-15)  # z points up on the paper
    assert xy[2, 1] > 0


def test_a_camera_sees_from_the_direction_of_its_azimuth_and_elevation():
    xy, near = plot.camera(0, 0)([[2, 3, 5]])  # from the x axis: y to the right, z up
    np.testing.assert_allclose(xy, [[3, 5]], atol=1e-15)
    np.testing.assert_allclose(near, [2])
    azimuth, elevation = 0.7, 0.4
    towards = [np.cos(0.7) * np.cos(0.4), np.sin(0.7) * np.cos(0.4), np.sin(0.4)]
    xy, near = plot.camera(azimuth, elevation)([towards])
    np.testing.assert_allclose(xy, 0, atol=1e-15)
    np.testing.assert_allclose(near, 1)


SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
FACE = np.array([[0, 1, 2, 3]])


def test_a_face_turned_to_the_light_keeps_its_colour_and_a_grazing_one_loses_the_depth():
    found = plot.shade(SQUARE, FACE, "#ff8000", light=(0, 0, 2), depth=0.35)
    np.testing.assert_allclose(found, [[1, 128 / 255, 0]])
    found = plot.shade(SQUARE, FACE, "#ff8000", light=(3, 0, 0), depth=0.35)
    np.testing.assert_allclose(found, [[0.65, 0.65 * 128 / 255, 0]])


def test_both_sides_of_a_face_are_shaded_alike_whatever_its_size():
    light = (0.3, -0.5, 0.8)
    one = plot.shade(SQUARE, FACE, light=light)
    np.testing.assert_allclose(plot.shade(100 * SQUARE, FACE[:, ::-1], light=light), one)


def test_shades_are_colours_and_triangles_and_collapsed_faces_have_one_too():
    V = np.random.default_rng(2).normal(size=(30, 3))
    for corners in (3, 4):
        faces = np.arange(12 * (30 // 12)).reshape(-1, corners)
        found = plot.shade(V, faces)
        assert found.shape == (len(faces), 3)
        assert ((found > 0) & (found <= 1)).all()
    assert plot.shade(np.zeros((4, 3)), FACE).shape == (1, 3)


def test_a_triangle_is_shaded_by_its_normal():
    V = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 1.0]])  # its normal is the y axis
    found = plot.shade(V, np.array([[0, 1, 2]]), "#ffffff", light=(0, 1, 1), depth=0.5)
    np.testing.assert_allclose(found, 1 - 0.5 * (1 - 0.5**0.5))


def stacked(heights):
    """Unit squares at the given heights."""
    V = np.concatenate([SQUARE + np.array([0, 0, h]) for h in heights])
    return V, np.arange(len(V)).reshape(-1, 4)


ABOVE = plot.camera(0, np.pi / 2)
RED, GREEN, BLUE = (1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0), (2, 1, 0)])
def test_a_scene_paints_the_nearest_face_last(ax, order):
    heights, colours = np.array([0.0, 1, 2])[list(order)], np.array([RED, GREEN, BLUE])
    drawn = plot.scene(ax, ABOVE, *stacked(heights), fill=colours[list(order)])
    assert isinstance(drawn, PathCollection)
    np.testing.assert_array_equal(drawn.get_facecolors(), [RED, GREEN, BLUE])


def test_a_scene_seen_from_below_paints_the_other_way_round(ax):
    below = plot.camera(0, -np.pi / 2)
    drawn = plot.scene(ax, below, *stacked([0, 1, 2]), fill=[RED, GREEN, BLUE])
    np.testing.assert_array_equal(drawn.get_facecolors(), [BLUE, GREEN, RED])


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=30), st.integers(0, 99))
def test_ties_are_painted_in_their_order_whatever_the_last_digits_are(levels, seed):
    keys = np.array(levels) / 3
    noisy = keys * (1 + 1e-13 * np.random.default_rng(seed).uniform(-1, 1, keys.shape))
    wanted = [k for _, k in sorted(zip(levels, range(len(levels)), strict=True))]
    assert plot.order(keys).tolist() == plot.order(noisy).tolist() == wanted


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=30))
def test_the_order_is_that_of_the_keys_up_to_ties(keys):
    keys = np.array(keys)
    painted = plot.order(keys)
    assert sorted(painted.tolist()) == list(range(len(keys)))
    assert np.diff(keys[painted], prepend=keys.min()).min() >= -len(keys) * 3e-9


def test_a_tie_in_a_scene_does_not_hang_on_the_last_bit(ax):
    heights = np.array([0.3, 0.1 + 0.2, 1.0])  # 0.3 and the number after it
    assert heights[0] < heights[1]
    colours = [RED, GREEN, BLUE]
    for other in (heights, heights[[1, 0, 2]]):
        drawn = plot.scene(ax, ABOVE, *stacked(other), fill=colours)
        np.testing.assert_array_equal(drawn.get_facecolors(), colours)


def test_a_line_on_a_face_is_painted_over_it_and_under_the_next_one(ax):
    line = np.array([[0, 0, 0], [0.5, 0.5, 0], [1, 1, 0]])
    fill = [RED, BLUE]
    drawn = plot.scene(ax, ABOVE, *stacked([0, 1]), fill=fill, lines=[(line, "#00ff00", 2.0)])
    np.testing.assert_array_equal(drawn.get_edgecolors(), [RED, GREEN, GREEN, BLUE])
    assert list(drawn.get_linewidths()) == [0.3, 2, 2, 0.3]
    xy = ABOVE(line)[0]
    np.testing.assert_allclose(drawn.get_paths()[1].vertices, xy[:2])
    np.testing.assert_allclose(drawn.get_paths()[2].vertices, xy[1:])
    assert drawn.get_facecolors()[1][3] == 0


def test_every_part_of_a_slanted_face_is_painted_before_the_lines_on_it(ax):
    view = plot.camera(0.3, 0.4)
    border = SQUARE[[0, 1, 2, 3, 0]]
    drawn = plot.scene(ax, view, SQUARE, FACE, fill=[RED], lines=[(border, "#00ff00", 1.0)])
    np.testing.assert_array_equal(drawn.get_edgecolors(), [RED] + [GREEN] * 4)


def test_a_scene_is_shaded_by_default_and_takes_one_colour_for_all_faces(ax):
    V, faces = stacked([0, 1])
    drawn = plot.scene(ax, ABOVE, V, faces)
    np.testing.assert_allclose(drawn.get_facecolors()[:, :3], plot.shade(V, faces))
    drawn = plot.scene(ax, ABOVE, V, faces, fill="#ff0000")
    np.testing.assert_array_equal(drawn.get_facecolors(), [RED, RED])


def test_the_axes_see_the_whole_scene(ax):
    V, faces = stacked([0, 1])
    plot.scene(
        ax, plot.camera(0.3, 0.4), V, faces, lines=[(np.array([[0, 0, 0], [5, 5, 5]]), "k", 1)]
    )
    xy = plot.camera(0.3, 0.4)(np.concatenate([V, [[5, 5, 5]]]))[0]
    np.testing.assert_allclose(ax.dataLim.get_points(), [xy.min(axis=0), xy.max(axis=0)])


def test_a_family_that_does_not_exist_is_refused():
    _, axes = plot.canvas([["A"]], 2, 2)
    with pytest.raises(ValueError, match=r"no family \['w'\]"):
        plot.net(axes["A"], np.zeros((4, 3)), [[0, 1, 2, 3]], families=("u", "w"))
