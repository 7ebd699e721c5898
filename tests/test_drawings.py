"""Every figure, drawn once: it is the stored one, and what it shows is judged by closed forms."""

import importlib
import re
from functools import cache
from pathlib import Path
from unittest.mock import patch

import igl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from test_gliding import DEFECTS, back_on_surface

from inetlib import drawings, measure, mesh, motif, publish, raster, solver, surfaces
from inetlib.drawings import (
    beyond_freedom,
    beyond_labels,
    beyond_planar,
    beyond_rho,
    beyond_star,
    enlarged,
    fig03,
    fig09,
    optimisation,
    own_surface,
    same,
    table1,
)

FIGURES = Path(__file__).resolve().parent.parent / "figures"
STORED = publish.read_manifest(FIGURES)


CAST = "fig07", "fig09", "fig10"  # where rays are cast
SCENES: dict = {}  # of the figures drawn: [(view, layers, `raster.Picture`, lines on it)]


render = raster.render


def coarse(view, layers, pixels, lift):
    """A surface painted coarsely, and quickly."""
    return render(view, layers, min(pixels, 150), lift)


@cache
def drawn(name):
    made, in_front = SCENES.setdefault(name, []), raster.in_front

    def watched(view, layers, pixels, lift):
        pixels = min(pixels, 400 if name in CAST else 150)
        made.append((view, layers, render(view, layers, pixels, lift), []))
        return made[-1][2]

    def listed(scene, view, lines, *options):
        made[-1][3].extend(map(np.asarray, lines))
        return in_front(scene, view, lines, *options)

    with patch.multiple(raster, render=watched, in_front=listed):
        drawing = importlib.import_module(f"inetlib.drawings.{name}").draw()
    plt.close(drawing.figure)
    return drawing


def pairs(array):
    """An array as it is stored: complex numbers as pairs."""
    array = np.asarray(array)
    return np.stack([array.real, array.imag], -1) if np.iscomplexobj(array) else array


@pytest.mark.notebook
@pytest.mark.parametrize("name", STORED)
def test_the_stored_figure_is_what_is_drawn(name):
    drawing, entry = drawn(name), STORED[name]
    assert (drawing.name, drawing.function) == (name, entry["function"])
    for part in ("parameters", "claims"):
        assert same.claims(entry[part], drawings.rounded(getattr(drawing, part))), part
    arrays = {key: pairs(array) for key, array in drawing.data.items()}
    assert same.data(publish.read_data(FIGURES / "data" / f"{name}.npz"), arrays) == []
    assert np.degrees(publish.deviations(drawing.nets)).max() < 1e-9


@pytest.mark.notebook
@pytest.mark.parametrize("name", STORED)
def test_its_panels_have_letters_in_the_order_in_which_they_are_read(name):
    figure = drawn(name).figure
    words = [ax.get_title(loc="left") for ax in figure.axes]
    words += [text.get_text() for ax in figure.axes for text in ax.texts]
    letters = [found[1] for text in words if (found := re.match(r"\$\\mathbf\{(.*?)\}", text))]
    plain = [letter for letter in letters if len(letter) == 1]
    assert plain == list("ABCDEFGH"[: len(plain)]) and len(set(letters)) == len(letters)
    assert {letter[0] for letter in letters} <= set(plain) or name == "fig09"
    assert bool(letters) is (name != "fig01")  # left, middle and right there


def angle(a, b):
    """Degrees between vectors, complex or (..., 3)."""
    if np.iscomplexobj(a):
        return np.degrees(np.abs(np.angle(b / a)))
    cosine = np.sum(a * b, -1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)
    return np.degrees(np.arccos(cosine))


def test_the_parallelograms_of_figs_1_and_2_have_the_angles_and_ratios_beside_them():
    first, second = drawn("fig01"), drawn("fig02")
    wanted = dict(zip("ABCDEFG", [(65, 70), (65, 110), (115, 70), (115, 110)], strict=False))
    wanted |= {letter: (x, x) for letter, x in zip("EFG", (60, 45, 30), strict=True)}
    shapes = [(first.data["general"], (first.claims["lam"], first.claims["mu"]), (70, 55))]
    for letter, angles in wanted.items():
        shapes.append((second.data[letter], second.claims[f"lam, mu {letter}"], angles))
    for (A, B, C, D), ratios, angles in shapes:
        assert (angle(C - B, A - B), angle(D - B, A - C)) == pytest.approx(angles)
        assert (abs(A - B) / abs(C - B), abs(D - B) / abs(A - C)) == pytest.approx(ratios)
    big, small = (np.abs(np.diff(z, append=z[:1])) for z in first.data["same_pose"])
    assert big / small == pytest.approx(np.full(3, 2**0.5))


def test_the_images_of_fig_3_are_those_of_grids():
    """Turned back by hand, all are parallelograms again; in C3 the two sheets coincide."""
    z = drawn("fig03").data
    back = {"A'": 1 / z["A'"], "C1": 1 / z["C1"]}
    for name, turn in (("B'", -1j), ("C'", -1j), ("C2", -1j)):
        back[name] = np.sqrt(z[name] * turn**2) / turn
    for name in ("A'", "B'", "C'"):
        signs = back[name] / z[name[0]]
        assert np.abs(signs - signs[0, 0]).max() < 1e-9, name
        assert abs(abs(signs[0, 0]) - 1) < 1e-9
    for name, grid in back.items():
        for axis in (0, 1):
            assert np.abs(np.diff(grid, 2, axis=axis)).max() < 1e-9, name
    assert np.abs(z["C3"] - z["C3"][::-1, ::-1]).max() < 1e-9 and abs(z["C3"][5, 5]) < 1e-12
    with pytest.raises(ValueError, match="cells = 9: an even number is wanted"):
        fig03.draw(cells=9)


CLOSED = {  # panels: functions that vanish on the surface and nowhere near it
    ("fig05", "mesh"): lambda x, y, z: np.hypot(x, y) - np.cosh(z),
    ("fig08", "net"): lambda x, y, z: np.hypot(x, y) - np.cosh(z),
    ("fig10", "sphere"): lambda x, y, z: x**2 + y**2 + z**2 - 1,
    ("fig10", "plane"): lambda x, y, z: z,
    ("fig11", "net"): lambda *p: np.ptp(np.hypot(p[0], p[1]).reshape(36, -1), axis=0),
} | {("fig06", f"net_{letter}"): lambda x, y, z: x**2 + y**2 + z**2 - 1 for letter in "ABCD"}


@pytest.mark.parametrize(("name", "net"), CLOSED)
def test_nets_lie_on_the_surfaces_of_their_titles(name, net):
    off = CLOSED[name, net](*drawn(name).data[net].T)
    assert off.size > 10 and np.abs(off).max() < 1e-12


@pytest.mark.notebook
@pytest.mark.parametrize("panel", [f"{letter}{column}" for letter in "ABCDE" for column in "13"])
def test_the_starts_of_fig_9_lie_on_the_surfaces_and_their_inversions(panel):
    V = drawn("fig09").data[f"net_{panel}"]
    V = back_on_surface(panel[0] + str(int(panel[1]) + 1), V)
    assert len(V) == (fig09.ROWS + 1) * (fig09.COLUMNS + 1)
    assert np.abs(DEFECTS[panel[0]](*V.T)).max() < 1e-9


def test_the_quads_of_fig_4_have_the_printed_ratios():
    data, claims = drawn("fig04").data, drawn("fig04").claims
    for letter, angles in (("A", (80, 55)), ("B", (60, 60))):
        v1, v2, v3, v4 = data[letter]
        across, along = v3 + v4 - v1 - v2, v4 + v1 - v2 - v3
        assert angle(v3 - v1, v4 - v2) == pytest.approx(angles[0])
        assert angle(across, along) == pytest.approx(angles[1])
        d, m = (np.linalg.norm(x) for x in (v4 - v2, across))
        assert d / np.linalg.norm(v3 - v1) == pytest.approx(claims[f"lam_{letter}"])
        assert m / np.linalg.norm(along) == pytest.approx(claims[f"mu_{letter}"])
    assert claims["lam_B"] == claims["mu_B"] == pytest.approx((1 + 5**0.5) / 2)


@pytest.mark.notebook
def test_bending_makes_no_chord_of_fig_7_longer_and_the_cylinder_closes():
    data, claims = drawn("fig07").data, drawn("fig07").claims
    flat = np.linalg.norm(data["domain"][:, None] - data["domain"], axis=2)
    for letter in "ABCDEFGH":
        V = data[f"net_{letter}"]
        assert (np.linalg.norm(V[:, None] - V, axis=2) <= flat + 1e-6).all(), letter
        assert claims[f"stretch_{letter}"] < 1e-6
    rolled, plane = (data[f"net_{letter}"].reshape(13, 13, 3) for letter in "EA")
    assert np.abs(rolled[0] - rolled[-1]).max() < 1e-9
    assert np.linalg.norm(plane[0] - plane[-1], axis=1) == pytest.approx(2 * np.pi)


def test_the_plane_of_fig_10_is_seen_from_the_north_pole():
    x, y, z = drawn("fig10").data["sphere"].T
    seen = np.stack([x / (1 - z), y / (1 - z), 0 * z], axis=1)
    np.testing.assert_allclose(drawn("fig10").data["plane"], seen, atol=1e-12)


@pytest.mark.parametrize("right", range(4))
def test_what_is_enlarged_is_the_nets_own_parallelogram_and_fills_its_room(right):
    V, Q = surfaces.freeform_patch(6, 6)
    corners = enlarged.flat(V, Q, 17, right)
    flat, whole = np.column_stack([corners, 0 * corners[:, 0]]), np.arange(4)[None]
    for judge in (measure.ratios, measure.angles):
        np.testing.assert_allclose(judge(flat, whole), np.array(judge(V, Q))[:, [17]], rtol=1e-12)
    way = measure.vectors(flat, whole)[right][0]
    assert way[0] > 0 and np.abs(way[1:]).max() < 1e-12
    assert np.max(np.abs(corners) / [enlarged.WIDE, enlarged.HIGH]) == pytest.approx(1)
    theta, theta0 = (np.degrees(x[17]) for x in measure.angles(V, Q))
    assert (
        enlarged.words(V, Q, 17)
        == f"$\\theta={theta:.1f}\\degree$\n$\\theta_0={theta0:.1f}\\degree$"
    )


def test_sampled_nets_of_half_the_size_are_four_times_as_good():
    claims = drawn("fig05").claims
    names = "sampled_net_max_deviation_deg", "sampled_net_half_size_max_deviation_deg"
    assert 3 < claims[names[0]] / claims[names[1]] < 5
    assert drawn("fig08").claims["lam_squared"] == pytest.approx(5)
    assert drawn("fig08").claims["mu_squared"] == pytest.approx(2)


BEYOND = {
    "beyond_freedom": beyond_freedom.draw,
    "beyond_labels": beyond_labels.draw,
    "beyond_planar": beyond_planar.draw,
    "beyond_rho": beyond_rho.draw,
    "beyond_star": beyond_star.draw,
}


@pytest.mark.parametrize("name", BEYOND)
def test_figures_beyond_the_paper_show_nets_without_flips_and_say_what_is_refused(name):
    assert drawn(name).function == f"{BEYOND[name].__module__}.draw"
    nets, claims = drawn(name).nets, drawn(name).claims
    assert nets and max(publish.deviations(nets)) < 1e-12
    for V, Q, *_ in nets:
        assert len(Q) == 1 or measure.quality(V, Q).flips == 0
    if name == "beyond_freedom":
        assert [claims[f"{k} converged"] for k in "ABCDEF"] == [True] * 5 + [False]
    if name == "beyond_labels":
        refused = [k for k, text in claims.items() if k[0] in "ABC" and text != "labelled"]
        assert [k[:2] for k in sorted(refused)] == ["A0", "A2", "A4", "B0", "B2", "B4", "C3", "C5"]
    if name == "beyond_rho":
        assert claims["cross ratio"] == -1


def test_the_leaf_is_as_near_its_outline_as_it_says():
    drawing = drawn("beyond_planar")
    V, Q, *_ = drawing.nets[0]
    rim = V[mesh.boundary_loops(Q)[0]] @ [1, 1j, 0]
    start = drawing.data["outline"]
    along = np.roll(start, -1) - start
    foot = np.real((rim[:, None] - start) / along).clip(0, 1)
    off = np.abs(rim[:, None] - start - foot * along).min(axis=1)
    claim = drawing.claims["leaf: largest distance from the outline"]
    assert off.max() == pytest.approx(claim, abs=1e-6)


def test_each_strong_energy_is_the_best_at_its_own():
    with patch.object(raster, "render", coarse):
        figure, lines = optimisation.energies()
    plt.close(figure)
    titles = [ax.get_title(loc="left") for ax in figure.axes if ax.get_title(loc="left")]
    assert titles == [line[0] for line in lines] == ["start", *optimisation.ENERGIES]
    steps, area, unfair, surface, rim = np.array([line[1:] for line in lines], dtype=float).T
    assert steps[0] == surface[0] == rim[0] == 0 and (steps[1:] > 0).all()
    only, fair, _, near, glide = range(1, 6)
    assert np.argmin(unfair) == fair and area[fair] > area[only]
    assert surface[near] < surface[only] / 2 and surface[glide] < surface[only] / 2
    assert rim[glide] < 0.8 * rim[near]


def test_convergence_is_drawn_step_by_step_with_dots_for_steps_of_shape():
    V, Q = surfaces.freeform_patch(6, 6)
    found = {"a": solver.optimize(V, Q, 1.2), "b": solver.optimize(V, Q, 1.2, shape_steps=0)}
    figure = optimisation.convergence(found)
    plt.close(figure)
    left, right = figure.axes
    assert [text.get_text() for text in left.get_legend().get_texts()] == ["a", "b"]
    for k, result in enumerate(found.values()):
        for ax, least in ((left, 1e-24), (right, 1e-12)):
            line, dots = ax.lines[2 * k : 2 * k + 2]
            assert len(line.get_ydata()) == len(result.history) and line.get_ydata().min() >= least
            shape = [j for j, step in enumerate(result.history) if step.kind == "shape"]
            assert dots.get_xdata().tolist() == shape and bool(shape) is (k == 0)
        off = np.degrees(measure.deviations(result.V, Q, 1.2, result.theta0).max())
        assert right.lines[2 * k].get_ydata()[-1] == pytest.approx(max(off, 1e-12), abs=1e-9)


def test_panels_show_every_quad_and_motif_and_the_range_of_planarity():
    lifted = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]], dtype=float)
    normal = np.array([1, 1, -4]) / 18**0.5  # of both diagonals, (2, 2, 1) / 2 and (-1, 1, 0)
    wanted = 2 * abs(normal[0]) / (1.5 + 2**0.5)
    assert own_surface.warps(lifted, np.array([[0, 1, 2, 3]])) == pytest.approx([wanted])
    V, Q = surfaces.freeform_patch(5, 4)
    curves = motif.place(V, Q, motif.weave(1.0, 1.2), 1.0, 1.2)
    with patch.object(raster, "render", coarse):
        figure = own_surface.panels(V, Q, curves)
    plt.close(figure)
    shown = [ax for ax in figure.axes if ax.get_title(loc="left")]
    assert [len(ax.images) for ax in shown] == [1, 1, 1]
    starts = np.count_nonzero(shown[2].patches[0].get_path().codes == 1)
    assert 20 * len(curves) <= starts < 22 * len(curves)  # each curve in each quad; some are cut
    sizes, planar = (ax.child_axes[0].get_xlim() for ax in figure.axes[:2])
    warps = own_surface.warps(V, Q)
    assert planar == pytest.approx((warps.min(), warps.max()))
    assert sizes[0] < 1 < sizes[1]


def test_table_1_is_the_stored_one(tmp_path):
    """The printed rows and those of our own formulation; the others take the paper's steps."""
    lines = table1.rows({"ratios": table1.results("ratios")})
    table1.save(lines, tmp_path)
    for name in ("table1.md", "table1.csv"):
        stored, made = (
            [line for line in (folder / name).read_text().splitlines() if "paper's" not in line]
            for folder in (FIGURES, tmp_path)
        )
        assert same.text("\n".join(stored), "\n".join(made)), name
    assert len(made) == 1 + 2 * 7 and all(len(line.split(",")) >= 13 for line in made)


@pytest.mark.notebook
@pytest.mark.parametrize("name", CAST)
def test_no_hidden_part_of_a_curve_is_drawn_in_front(name):
    rng, found = np.random.default_rng(1), []
    drawn(name)
    every = SCENES[name]
    for view, layers, scene, lines in every:
        points, count = [], -(-500 // len(every))
        for line in (lines[k] for k in rng.integers(len(lines), size=count)):
            k, part = rng.integers(len(line) - 1), rng.random()
            points.append(line[k] + part * (line[k + 1] - line[k]))
        points = np.array(points)
        ends = np.cumsum([0, *(len(V) for V, _, _ in layers)])
        V = np.concatenate([V for V, _, _ in layers]).astype(float)
        faces = [F + start for (_, F, _), start in zip(layers, ends, strict=False)]
        T = np.concatenate([F[:, [0, i, i + 1]] for F in faces for i in range(1, F.shape[1] - 1)])
        tree = igl.AABB()
        tree.init(V, T)
        way = np.tile(view(np.eye(3))[1], (len(points), 1))
        step = len(layers) * scene.lift / scene.scale  # so much nearer a curve counts
        hits = [
            tree.intersect_ray_first(V, T, points + k * step * way, way)[0] >= 0 for k in (1, 2)
        ]
        seen = raster.visible(scene, view, points, len(layers))
        found.append((np.sum(seen & hits[1]), np.sum(~seen & ~hits[0]), np.sum(hits[1]), len(seen)))
    shown, missed, hidden, count = np.sum(found, axis=0)
    assert count >= 500 and hidden > 50
    assert shown <= 2 and missed <= 0.02 * count  # at outlines, where a pixel decides
