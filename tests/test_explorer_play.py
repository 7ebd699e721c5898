"""What one does with a net in the explorer, without its page: shading, undo, touching, remedies."""

import numpy as np
import pytest

from inetlib import measure, mesh
from inetlib.explorer import look
from inetlib.explorer.session import Session


def built(**values):
    """A `Session` with the net of a choice."""
    found = Session()
    assert found.change(**values) == []
    found.construct()
    return found


def in_words(legend):
    return [float(words.split()[0]) for _, words in legend]


def test_faces_are_shaded_by_their_size_with_a_scale_in_the_units_of_the_net():
    i, j = np.array([0, 1, 3, 6, 10.0]), np.array([0, 2.0])
    V = np.stack([*map(np.ravel, np.meshgrid(i, j, indexing="ij")), np.zeros(10)], axis=1)
    Q = mesh.grid_quads(4, 1)
    rgb, legend = look.shading("size", V, Q, np.zeros(4))
    assert np.allclose(in_words(legend), np.linspace(2**0.5, 8**0.5, 5), atol=0.005)
    brightness = rgb.astype(int).sum(axis=1)
    assert np.all(np.diff(brightness) < -50)  # larger is darker
    for k, (colour, _) in ((0, legend[0]), (3, legend[-1])):
        assert colour == "rgb({},{},{})".format(*rgb[k])
    rgb, legend = look.shading("size", *mesh_of_squares(), np.zeros(9))
    assert len(legend) == 1 and legend[0][1] == "all 1" and len(np.unique(rgb, axis=0)) == 1


def mesh_of_squares():
    x = np.linspace(0.3, 3.3, 4)  # no two are equal to the last digit
    V = np.stack([*map(np.ravel, np.meshgrid(x, x, indexing="ij")), np.full(16, 0.1)], axis=1)
    return V, mesh.grid_quads(3, 3)


def test_faces_are_shaded_by_their_planarity_in_percent_and_flat_ones_are_alike():
    V, Q = mesh_of_squares()
    V[0, 2] += 0.2
    rgb, legend = look.shading("planarity", V, Q, np.zeros(9))
    off = 100 * measure.planarity(V, Q)
    d = np.array([1.0, 1, -0.2]), np.array([1.0, -1, 0])  # of the first face
    normal = np.cross(*d) / np.linalg.norm(np.cross(*d))
    apart = abs(normal @ [0, 1, -0.2]) / np.mean([np.linalg.norm(x) for x in d])
    assert off[0] == pytest.approx(100 * apart) and np.all(off[1:] < 1e-12)
    assert in_words(legend) == pytest.approx(np.linspace(0, off[0], 5), rel=0.05)
    assert all(words.endswith(" %") for _, words in legend)
    assert len(np.unique(rgb[1:], axis=0)) == 1 and rgb[0].sum() < rgb[1].sum() - 150
    assert measure.quality(V, Q).planarity == measure.planarity(V, Q).max()


def test_a_shaded_session_has_the_legend_of_its_choice_and_none_without():
    for name, ending in (("deviation", "\u00b0"), ("size", ""), ("planarity", " %")):
        rgb, legend = built(kind="isothermal", m=5, n=4, shade=name).shading()
        assert rgb.shape == (20, 3) and legend[-1][1].endswith(ending), name
    assert built(m=5, n=4).shading() == (None, [])
