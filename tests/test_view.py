"""`view`: pictures where pyvista and OpenGL are at hand, clear sentences where they are not."""

import io
import os
import subprocess
import sys
import types
import warnings
from functools import cache

import numpy as np
import pytest
from matplotlib.colors import rgb_to_hsv, to_rgb
from matplotlib.image import imread

from inetlib import explorer, mesh, plot, view
from inetlib.explorer import notebook

pytestmark = pytest.mark.program

V = np.array([[i + 0.3 * j, j, 0.2 * i * j] for i in range(4) for j in range(4)], dtype=float)
Q = mesh.grid_quads(3, 3)
ABOVE = (-np.pi / 2, np.pi / 2)  # x to the right, y up


@pytest.fixture
def fresh(monkeypatch):
    """A pyvista that does nothing, on which `available` has made no trial yet."""
    monkeypatch.setattr(view, "available", cache(view.available.__wrapped__))
    monkeypatch.setitem(sys.modules, "pyvista", types.ModuleType("pyvista"))


@pytest.fixture
def pyvista():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of other people's packages
        try:
            return view.pyvista_module()
        except ImportError as error:
            pytest.skip(str(error))


@pytest.fixture
def opengl(pyvista):
    works, sentence = view.available()
    if not works:
        pytest.skip(sentence)


def test_without_pyvista_the_message_names_the_extra(monkeypatch, fresh):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    works, sentence = view.available()
    assert not works
    with pytest.raises(ImportError, match="install the extra `view`") as caught:
        view.scene(V, Q)
    assert str(caught.value) == sentence


@pytest.mark.parametrize("end", ["raise SystemExit(1)", "import os; os.abort()", "1 / 0"])
def test_a_trial_that_fails_or_dies_becomes_a_sentence(monkeypatch, fresh, end):
    monkeypatch.setattr(view, "PROBE", end)
    works, sentence = view.available()
    assert not works and "libegl1 and libgl1-mesa-dri" in sentence and "inetlib.plot" in sentence
    with pytest.raises(RuntimeError, match="cannot draw off screen here"):
        view.scene(V, Q)


def test_a_trial_that_hangs_becomes_a_sentence_and_a_good_one_is_made_once(monkeypatch, fresh):
    calls = []

    def run(command, timeout, **_):
        calls.append(command)
        if len(calls) == 1:
            raise subprocess.TimeoutExpired(command, timeout)
        return types.SimpleNamespace(returncode=0)

    monkeypatch.setattr(subprocess, "run", run)
    works, sentence = view.available()
    assert not works and "two minutes" in sentence
    view.available.cache_clear()
    assert view.available() == view.available() == (True, "pyvista draws off screen here")
    assert len(calls) == 2


@pytest.mark.parametrize(
    ("platform", "display", "before", "after"),
    [
        ("linux", None, None, "vtkEGLRenderWindow"),
        ("linux", "", None, "vtkEGLRenderWindow"),
        ("linux", None, "vtkOSOpenGLRenderWindow", "vtkOSOpenGLRenderWindow"),
        ("linux", ":0", None, None),
        ("darwin", None, None, None),
        ("win32", None, None, None),
    ],
)
def test_egl_is_asked_for_on_linux_without_a_display(
    monkeypatch, fresh, platform, display, before, after
):
    name = "VTK_DEFAULT_OPENGL_WINDOW"
    monkeypatch.setattr(sys, "platform", platform)
    for key, value in (("DISPLAY", display), (name, before)):
        monkeypatch.setenv(key, value or "")  # so that monkeypatch restores it
        if value is None:
            monkeypatch.delenv(key)
    view.pyvista_module()
    assert os.environ.get(name) == after


@pytest.mark.parametrize(
    ("kernel", "session", "display", "live"),
    [
        (True, True, True, "page"),
        (True, True, False, "page"),  # the browser draws: no display is needed here
        (True, False, True, "still"),  # nbclient, nbmake
        (False, False, True, "window"),
        (False, False, False, "still"),
    ],
)
def test_a_net_is_live_for_a_person(monkeypatch, kernel, session, display, live):
    window = types.SimpleNamespace(show=lambda: "window")
    monkeypatch.setattr(view, "scene", lambda *_, live=False: window if live else None)
    still = np.full((view.SIZE[1], view.SIZE[0], 3), 77, dtype=np.uint8)
    monkeypatch.setattr(view, "picture", lambda _: still)
    monkeypatch.setattr(view, "available", lambda: (True, ""))
    monkeypatch.setattr(view, "headless", lambda: not display)
    door = types.SimpleNamespace(port=1, nets={}, root="http://127.0.0.1:1/abc/")
    monkeypatch.setattr(notebook, "_open_door", lambda: door)
    monkeypatch.setenv("JPY_SESSION_NAME", "a.ipynb")
    if not session:
        monkeypatch.delenv("JPY_SESSION_NAME")
    monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    if not kernel:
        monkeypatch.delitem(sys.modules, "ipykernel")
    shown = explorer.show(m=3, n=1)
    assert isinstance(shown, notebook.Live) is (live == "page")
    kinds = {str: "window", notebook.Live: "page"}
    result, forced, fixed = (explorer.turn(V, Q, live=x) for x in (None, True, False))
    assert kinds.get(type(result), "still") == live
    assert kinds[type(forced)] == ("page" if kernel else "window")
    decoded = imread(io.BytesIO(fixed.data), format="png")
    np.testing.assert_allclose(decoded[..., :3] * 255, still, atol=1e-4)
    if live == "page":
        assert result.picture == fixed.data
        np.testing.assert_array_equal([W[0] for W in door.nets.values()], [V, V])


def test_in_the_round_shows_two_families_or_says_what_is_missing(monkeypatch):
    asked = []
    monkeypatch.setattr(notebook, "turn", lambda *net, **look: asked.append((net, look)))
    monkeypatch.setattr(view, "available", lambda: (False, "no OpenGL"))
    monkeypatch.setattr(notebook, "person", lambda: False)
    assert explorer.in_the_round(V, Q) == "no OpenGL" and not asked
    monkeypatch.setattr(notebook, "person", lambda: True)  # the browser draws
    explorer.in_the_round(V, Q, view=(1.0, 0.2))
    monkeypatch.setattr(view, "available", lambda: (True, ""))
    monkeypatch.setattr(notebook, "person", lambda: False)
    explorer.in_the_round(V, Q)
    assert [look["view"] for _, look in asked] == [(1.0, 0.2), (-0.9, 0.35)]
    for (_, _, families), _ in asked:
        assert [len(lines) > 0 for lines in families] == [True, True, False, False]


def drawn(*options, **more):
    """The picture of a scene."""
    return view.picture(view.scene(*options, **more))


def share(image, colour):
    """The part of the pixels with the hue of a saturated colour, however shaded."""
    hsv = rgb_to_hsv(image / 255)
    near = np.abs(hsv[..., 0] - rgb_to_hsv(to_rgb(colour))[0]) < 0.02
    return np.mean(near & (hsv[..., 1] > 0.5))


def test_a_picture_is_white_around_a_net_in_four_colours_or_those_that_are_chosen(opengl):
    image = drawn(V, Q)
    assert image.shape == (view.SIZE[1], view.SIZE[0], 3) and image.dtype == np.uint8
    np.testing.assert_array_equal(image[[0, 0, -1, -1], [0, -1, 0, -1]], 255)
    assert all(share(image, colour) > 0.002 for colour in plot.COLOURS.values())
    np.testing.assert_array_equal(drawn(V, Q), image)
    indices = mesh.polylines(Q)  # curves may be points as well as vertex indices
    points = mesh.Families(*([V[line] for line in lines] for lines in indices))
    np.testing.assert_array_equal(drawn(V, Q, points), drawn(V, Q, indices))
    families = mesh.polylines(Q)._replace(d1=[], v=[])
    image = drawn(V, Q, families, {"u": "#ff00ff"}, width=0.01)
    assert share(image, "#ff00ff") > 0.01 and share(image, plot.COLOURS["d2"]) > 0.01
    for name in ("u", "v", "d1"):
        assert share(image, plot.COLOURS[name]) < 0.0005  # blends of the others


@pytest.mark.parametrize("stretch", [1, 3])
def test_the_net_fills_the_picture_in_its_proportions_and_the_right_way_round(opengl, stretch):
    flat = V * [stretch, 1, 0]
    corner = mesh.Families([flat[[15, 11]]], [], [], [])  # right end, uppermost edge
    image = drawn(flat, Q, corner, {"face": "black"}, width=0.01, view=ABOVE)
    y, x = np.nonzero((image < 250).any(axis=-1))
    wide, high = np.ptp(x) + 1, np.ptp(y) + 1
    assert wide / high == pytest.approx(3.9 * stretch / 3, rel=0.03)
    assert 0.9 < max(wide / view.SIZE[0], high / view.SIZE[1]) < 0.97
    hue = rgb_to_hsv(image / 255)
    row, column = np.argwhere((hue[..., 1] > 0.5) & (hue[..., 2] > 0.2)).mean(axis=0)
    # From (3.9, 3) to (2.9, 3), of a net of width 3.9 and height 3 from (0, 0).
    assert (row - y.min()) / high < 0.05
    assert (column - x.min()) / wide == pytest.approx((3.9 + 2.9) / 7.8, abs=0.02)


def test_a_scene_is_a_plotter_with_one_actor_a_family_and_the_faces_of_a_mesh(opengl, pyvista):
    plotter = view.scene(V, Q)
    assert isinstance(plotter, pyvista.Plotter) and len(plotter.actors) == 5
    plotter.close()
    with pytest.raises(ValueError, match="face 8 names vertex 15"):
        view.scene(V[:15], Q)
