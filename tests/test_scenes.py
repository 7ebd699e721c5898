"""The scenes of the book: what their files hold, read as a browser reads them."""

import base64
import json
import re
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from inetlib import measure, mesh, plot
from inetlib.drawings import patches

pytestmark = pytest.mark.book
BOOK = Path(__file__).resolve().parent.parent / "book"
sys.path.insert(0, str(BOOK))
import scenes  # noqa: E402

SOLVED = {"bending", "associate", "vase", "sphere", "patch", "hexagon"}
CLOSE = {"web": 0.4, "squares": 0.8, "stereographic": 0.2, "inversion": 1.2}  # degrees


def array(text, kind):
    return np.frombuffer(base64.b64decode(text), dtype=kind)


def read(file):
    """What the script hands over, and its nets (V, Q)."""
    name, text = re.fullmatch(r'inetScene\("(\w+)", (.*)\);\n', file.read_text("ascii")).groups()
    scene = json.loads(text)
    assert name == file.stem
    nets = []
    for state in scene["states"]:
        Q = array(state.get("Q") or scene["Q"], "<u2").reshape(-1, 4).astype(int)
        V = array(state["V"], "<f4").reshape(-1, 3).astype(float)
        nets.append((V, Q[: state["faces"]]))
    return scene, nets


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("book") / "scenes"
    scenes.write(found)
    return found


def test_all_scenes_and_the_viewer_are_small(folder):
    assert sorted(file.stem for file in folder.iterdir()) == sorted(scenes.SCENES)
    sizes = [file.stat().st_size for file in folder.iterdir()]
    assert max(sizes) <= 400_000
    parts = [("trame_client", "module/vue3-www/vue.global.js")]
    parts.append(("trame_vtk", "modules/common/serve/trame-vtk.js"))
    both = [(resources.files(package) / file).stat().st_size for package, file in parts]
    assert sum(sizes) + sum(both) + (BOOK / "viewer.js").stat().st_size <= 5_000_000


def test_eight_figures_have_scenes_and_words():
    figures = {title.partition(":")[0] for title, _ in scenes.SCENES.values()}
    assert figures == {f"Fig. {k}" for k in (5, 7, 8, 9, 10, 11, 12, 13)}
    assert all(words.endswith(".") for _, words in scenes.SCENES.values())


@pytest.mark.parametrize("name", scenes.SCENES)
def test_the_numbers_of_a_state_are_those_of_the_stored_net(folder, name):
    scene, nets = read(folder / f"{name}.js")
    made = scenes.made(name).states
    for state, made_state, (V, Q) in zip(scene["states"], made, nets, strict=True):
        assert len(V) == Q.max() + 1 and mesh.is_labelled(Q)
        theta, theta0 = (np.degrees(x) for x in measure.angles(V, Q))
        lam, mu = measure.ratios(V, Q)
        for key, values in {"theta": theta, "theta0": theta0, "lam": lam, "mu": mu}.items():
            assert state[key] == pytest.approx(values.mean(), abs=1e-6)
        quality = measure.quality(V, Q)
        assert (quality.flips, quality.darts) == (state["flips"], state["darts"]) == (0, 0)
        limit = 0.001 if name in SOLVED else CLOSE[name]
        assert 0 <= state["off"] < limit
        asked = np.degrees([made_state.theta, made_state.theta0])
        off = np.abs(np.stack([theta, theta0]) - asked[:, None]).max()
        assert state["off"] == pytest.approx(off, abs=1e-6)


@pytest.mark.parametrize("name", sorted(SOLVED))
def test_nets_said_to_be_exact_are_it_before_they_are_stored(name):
    scene = scenes.made(name)
    for s in scene.states:
        assert np.degrees(measure.deviations(s.V, s.Q, s.theta, s.theta0).max()) < 1e-9
    assert scene.note in (scenes.EXACT, scenes.SOLVED)


def test_sampled_nets_say_so_and_come_nearer():
    for scene in map(scenes.made, ("web", "squares")):
        off = [scenes.numbers(state)["off"] for state in scene.states]
        assert scene.note == scenes.SAMPLED
        assert off[0] > 5 * off[-1] and np.all(np.diff(off) < 0)


@pytest.mark.parametrize("name", ["vase", "sphere"])
def test_loxodromes_from_30_to_150_degrees(folder, name):
    scene, nets = read(folder / f"{name}.js")
    shown = [round(state["theta0"]) for state in scene["states"]]
    assert shown == list(range(30, 151, 10))
    assert [state["label"] for state in scene["states"]] == [f"{k}\u00b0" for k in shown]
    assert all(round(state["theta"]) == 75 for state in scene["states"])
    longest = max((Q for _, Q in nets), key=len)
    assert all(np.array_equal(Q, longest[: len(Q)]) for _, Q in nets)
    if name == "sphere":
        for V, _ in nets:
            np.testing.assert_allclose(np.linalg.norm(V, axis=1), 1, atol=1e-6)


def test_the_plane_is_bent_into_a_closed_cylinder(folder):
    _, nets = read(folder / "bending.js")
    (flat, Q), (round_, _) = nets[0], nets[-1]
    assert np.ptp(flat[:, 1]) < 1e-6
    rows = round_.reshape(25, -1, 3)
    np.testing.assert_allclose(rows[0], rows[-1], atol=1e-6)
    np.testing.assert_allclose(np.hypot(round_[:, 0], round_[:, 1] + 1), 1, atol=1e-6)
    edges = [V[Q[:, 2]] - V[Q[:, 1]] for V, _ in (nets[0], nets[-1])]  # chords of equal arcs
    long, short = (np.linalg.norm(edge, axis=1) for edge in edges)
    np.testing.assert_allclose(short, 2 * np.sin(long / 2), atol=1e-6)


def test_from_the_catenoid_to_the_helicoid(folder):
    _, nets = read(folder / "associate.js")
    x, y, z = nets[0][0].T
    np.testing.assert_allclose(np.hypot(x, y), np.cosh(z), atol=1e-5)
    x, y, z = nets[-1][0].T
    np.testing.assert_allclose(x * np.cos(z) + y * np.sin(z), 0, atol=1e-5)


def test_from_the_sphere_to_the_plane_and_the_equator_stays(folder):
    _, nets = read(folder / "stereographic.js")
    (sphere, _), (plane, _) = nets[0], nets[-1]
    np.testing.assert_allclose(np.linalg.norm(sphere, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(plane[:, 2], 0, atol=1e-6)
    np.testing.assert_allclose(plane[:, :2] * (1 - sphere[:, 2:]), sphere[:, :2], atol=1e-6)
    equator = np.abs(sphere[:, 2]) < 1e-6
    assert equator.sum() > 40
    for V, _ in nets:
        np.testing.assert_allclose(V[equator], sphere[equator], atol=1e-6)


def test_the_roof_from_squares_to_60_degrees(folder):
    scene, _ = read(folder / "patch.js")
    for name in ("theta", "theta0"):
        found = [state[name] for state in scene["states"]]
        np.testing.assert_allclose(found, np.arange(90, 59, -1), atol=1e-3)
    assert abs(scene["states"][0]["lam"] - 1) < 1e-4
    assert abs(scene["states"][-1]["mu"] - (1 + np.sqrt(5)) / 2) < 1e-4


def test_two_writes_give_the_same_bytes(folder):
    scenes.made.cache_clear()
    for name in scenes.SCENES:
        assert scenes.script(name).encode("ascii") == (folder / f"{name}.js").read_bytes()


@pytest.mark.parametrize("name", scenes.SCENES)
def test_the_camera_sees_all_of_a_net(folder, name):
    scene, nets = read(folder / f"{name}.js")
    for state, (V, _) in zip(scene["states"], nets, strict=True):
        camera = state["camera"]
        place, focus, up = (np.array(camera[key]) for key in ("position", "focalPoint", "viewUp"))
        ahead = (focus - place) / np.linalg.norm(focus - place)
        right = np.cross(ahead, up) / np.linalg.norm(np.cross(ahead, up))
        depth = (V - place) @ ahead
        for axis in (right, np.cross(right, ahead)):
            seen = np.degrees(np.arctan(np.abs((V - place) @ axis) / depth)).max()
            assert depth.min() > 0 and seen < camera["viewAngle"] / 2


def test_the_colours_of_the_page_are_those_of_the_figures():
    css = (BOOK / "scenes.css").read_text(encoding="utf-8")
    light = dict(re.findall(r"--inet-(\w+): (#\w+);", css.partition("}")[0]))
    assert {name: light[name] for name in plot.COLOURS} == plot.COLOURS
    assert light["inner"] == patches.EXACT and light["singular"] == plot.SINGULAR
