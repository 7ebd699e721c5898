"""Fig. 9, columns 2 and 4: nets that glide on their surfaces, judged by closed forms."""

import io
from functools import cache

import numpy as np
import PIL.Image
import pytest
from matplotlib import pyplot as plt

from inetlib import measure, plot, publish
from inetlib.drawings import fig09

PANELS = [f"{letter}{column}" for letter in "ABCDE" for column in (2, 4)]
glides = cache(fig09.optimised)
T = np.radians(45)  # of the conjugate surface


def back_on_surface(panel, V):
    """The points V of a panel moved to the first surface of its row: x -> c + (x-c) / |x-c|^2."""
    if panel[1] == "2":
        return V
    away = V - fig09.CENTRES[panel[0]]
    return fig09.CENTRES[panel[0]] + away / np.sum(away**2, axis=1, keepdims=True)


DEFECTS = {  # functions of the points that vanish on the surface and nowhere near it
    "A": lambda x, y, z: x**2 + y**2 - 1,
    "B": lambda x, y, z: x**2 + y**2 + z**2 - 1,
    "C": lambda x, y, z: np.hypot(x, y) - np.cosh(z),
    "D": lambda x, y, z: x * np.cos(z) + y * np.sin(z),
    "E": lambda x, y, z: conjugate_defect(np.stack([x, y, z], axis=1)),
}


def conjugate_point(u, v):
    """The conjugate surface, X_u and X_v, written out; |X_u| = |X_v| = cosh v, X_u . X_v = 0."""
    c, s = np.cos(T), np.sin(T)
    cu, su, cv, sv = np.cos(u), np.sin(u), np.cosh(v), np.sinh(v)
    point = c * cv * cu + s * sv * su, c * cv * su - s * sv * cu, c * v + s * u
    along_u = -c * cv * su + s * sv * cu, c * cv * cu + s * sv * su, s + 0 * u
    along_v = c * sv * cu + s * cv * su, c * sv * su - s * cv * cu, c + 0 * u
    return tuple(np.stack(a, axis=1) for a in (point, along_u, along_v))


def conjugate_defect(V):
    """The distances of the points from the conjugate surface, by steps from many starts."""
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(-6, 5, 111), np.linspace(-3, 3, 61)))
    samples = conjugate_point(u, v)[0]
    first = np.array([np.argmin(np.sum((samples - p) ** 2, axis=1)) for p in V])
    u, v = u[first], v[first]
    for _ in range(30):
        point, along_u, along_v = conjugate_point(u, v)
        scale = np.cosh(v) ** 2
        u = u + np.sum((V - point) * along_u, axis=1) / scale
        v = v + np.sum((V - point) * along_v, axis=1) / scale
    return np.linalg.norm(V - conjugate_point(u, v)[0], axis=1)


@pytest.mark.parametrize("panel", PANELS)
def test_every_face_has_its_angles_by_the_textbook_formula(panel):
    g = glides()[panel]
    a, b, c, d = (g.result.V[k] for k in g.Q.T)
    wanted = {"2": (80, 45), "4": (50, 50)}[panel[1]]
    for one, two, angle in ((c - a, d - b, wanted[0]), (c + d - a - b, d + a - b - c, wanted[1])):
        lengths = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
        found = np.degrees(np.arccos(np.sum(one * two, axis=1) / lengths))
        assert np.abs(found - angle).max() < 1e-9
    assert g.result.converged and len(g.result.history) - 1 <= 12
    before, after = (measure.quality(V, g.Q) for V in (g.start, g.result.V))
    assert after.flips == before.flips == 0
    assert after.area_ratio > 0.05 * before.area_ratio


@pytest.mark.parametrize("panel", PANELS)
def test_nets_that_go_around_are_closed_and_no_face_is_turned_over(panel):
    g = glides()[panel]
    edges = np.sort(np.stack([g.Q, np.roll(g.Q, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    around = panel[0] in "ABC"
    assert np.count_nonzero(uses == 1) == (2 * 36 if around else 2 * (36 + 14))
    assert g.rows.shape == (15, 36 if around else 37)
    assert len(g.start) == len(g.result.V) == g.rows.size
    if panel[0] in "AB":
        corners = back_on_surface(panel, g.result.V)[g.Q]
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        outward = corners.mean(axis=1) * ([1, 1, 0] if panel[0] == "A" else [1, 1, 1])
        assert abs(np.sign(np.sum(normal * outward, axis=1)).sum()) == len(g.Q)


@pytest.mark.parametrize("panel", PANELS)
def test_all_vertices_lie_on_the_surface_by_its_closed_form(panel):
    g, defect = glides()[panel], DEFECTS[panel[0]]
    for V in (g.start, g.result.V):
        assert np.abs(defect(*back_on_surface(panel, V).T)).max() < 1e-9
    assert np.abs(defect(*1.01 * back_on_surface(panel, g.start).T)).max() > 1e-3
    moved = np.linalg.norm(g.result.V - g.start, axis=1).max() / g.diagonal
    assert moved > 0.01  # it did glide


def test_distances_are_fractions_in_both_directions():
    rows = fig09.distances(glides())
    assert [r.panel for r in rows] == PANELS
    assert [r.printed for r in rows[1::2]] == [1.959, 0.016, 38.593, 3.120, 9.464]
    assert all(r.printed is None for r in rows[::2])
    for r in rows:
        g = glides()[r.panel]
        swapped = measure.hausdorff(g.start, g.Q, g.result.V, g.Q)
        assert r[3:] == pytest.approx((swapped.back / g.diagonal, swapped.there / g.diagonal))
        moved = np.linalg.norm(g.result.V - g.start, axis=1).max() / g.diagonal
        assert 0 < r.there <= moved and 0 < r.back <= moved
        assert r.off == 0 and r.there < 0.2 and r.back < 0.2


def test_a_preview_is_a_small_picture_and_closes_the_figure():
    figure, _ = plot.canvas([["one"]], 3, 2)
    drawing = publish.Drawing("fig00", figure, "none", {}, {}, [], {})
    image = publish.show(drawing, colours=8)
    assert not plt.fignum_exists(figure.number)
    picture = PIL.Image.open(io.BytesIO(image.data))
    assert picture.size == (330, 220) and picture.mode == "P"
