"""The explorer's page without a browser: tabs, the server's guard over HTTP, notebooks."""

import asyncio
import base64
import io as streams
import re
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import types
import warnings
from contextlib import asynccontextmanager
from dataclasses import asdict
from functools import partial
from itertools import product
from urllib.parse import parse_qsl, urlencode, urljoin, urlsplit
from urllib.request import ProxyHandler, build_opener

import numpy as np
import pytest
from matplotlib.image import imread
from test_explorer import built

from inetlib import design, examples, io, mesh, surfaces, view
from inetlib.explorer import choices, look, nets, notebook, plates
from inetlib.explorer.choices import Choice
from inetlib.explorer.session import Session

pytestmark = pytest.mark.program

HOST = "127.0.0.1"
LIMIT = 60  # seconds after which a test gives up: nothing here takes so long
SIDE = {"position": [3.0, -4.0, 5.0], "focalPoint": [0.0, 0.0, 0.0]}


@pytest.fixture(autouse=True)
def coarse(monkeypatch):
    """Saved pictures are coarse here, and quick."""
    monkeypatch.setattr(look, "PIXELS", 200)


@pytest.fixture(scope="module")
def serve():
    """The module `inetlib.explorer.serve`, where its packages are installed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of other people's packages
        for name in ("pyvista", "trame", "trame_vtk", "trame_vuetify", "aiohttp"):
            pytest.importorskip(name, reason=f"{name}, of the extra `view`, is not installed")
        from inetlib.explorer import serve
    return serve


@pytest.fixture(scope="module")
def app_module(serve):
    return sys.modules[serve.App.__module__]


@pytest.fixture(scope="module")
def run():
    """A function that runs a coroutine: one event loop for all, so that tabs can be shared."""
    with asyncio.Runner() as runner:
        yield runner.run


@pytest.fixture
def quick(app_module, monkeypatch):
    """Searches begin at once and do not wait to be seen."""
    monkeypatch.setattr(app_module, "REST", 0.01)
    monkeypatch.setattr(app_module, "PACE", 0.001)


@pytest.fixture
def gate(app_module, quick, monkeypatch):
    """Searches begin at once and wait after every step, until the event is set."""
    event = threading.Event()
    clock = types.SimpleNamespace(sleep=lambda _: event.wait(LIMIT))
    monkeypatch.setattr(app_module, "time", clock)
    yield event
    event.set()


async def until(condition):
    async with asyncio.timeout(LIMIT):
        while not condition():
            await asyncio.sleep(0.005)


@asynccontextmanager
async def opened(serve, name, **options):
    """The app of a tab that has no browser."""
    app = serve.App(name, **options)
    task = app.server.start(backend="generic", exec_mode="task")
    await app.server.ready
    try:
        yield app
    finally:
        app.close()
        await app.server.stop()
        await task


@pytest.fixture(scope="module")
def shared(serve, run):
    """The app that the fixture `tab` makes as new for every test."""
    opening = opened(serve, "shared")
    app = run(opening.__aenter__())
    yield app
    run(opening.__aexit__(None, None, None))


@pytest.fixture
def app(shared, run):
    """The app of a tab that nobody has used."""
    shared.session, shared.sight, shared.fitted = Session(), None, None

    async def fresh():
        shared.state.update({"numbers": {}, "alert": "", "progress": "", "searching": False})

    async def end():
        shared.stop()
        for task in (shared._task, shared._search):
            if task is not None:
                task.cancel()

    run(fresh())
    yield shared
    run(end())


async def arrived(app, query="", dark=False):
    """A browser has come, and the net is shown."""
    app.arrive(query, dark, 1.5)
    await until(lambda: app.state.numbers and not app.state.searching)


async def change(app, **values):
    """What the page does when values change."""
    with app.state:
        app.state.update(values)
    await asyncio.sleep(0)


def texts(session):
    return plates.numbers(session.report, session.V, session.Q)


def echo(choice):
    """A choice as the state holds it."""
    return {k: list(v) if isinstance(v, tuple) else v for k, v in asdict(choice).items()}


def shown(app):
    """The choice in the state."""
    return {name: app.state[name] for name in choices.NAMES}


async def test_a_tab_shows_the_net_of_its_link(app):
    await arrived(app, "?theta=50&map=exp&m=5&n=4&families=d1")
    alone = built(theta=50, map="exp", m=5, n=4, families="d1")
    assert np.array_equal(app.session.V, alone.V)
    assert app.state.numbers == texts(alone) and app.state.message == alone.message
    assert shown(app) == echo(alone.choice)
    assert app.state.link == choices.link(alone.choice) and app.state.code == alone.code()
    assert app.state.alert == app.state.problem == ""
    for words in (app.state.parallelogram_svg, app.state.histogram_svg, app.state.profile_svg):
        assert words.startswith("<svg")


CHANGES = [
    {"theta": 70},
    {"theta0": "70.25"},
    {"lock": True, "theta": 80.0},
    {"m": 7.0, "n": "3"},
    {"kind": "isothermal", "surface": "rolled", "bend": 200},
    {"kind": "isothermal", "moebius": True, "pz": 2.5},
    {"kind": "revolution", "radii": [0.9, "1.1", 1.2, 1.1, 1, 1, 0.8]},
    {"families": ["d2", "u"], "parallelograms": True, "shade": "size"},
]


@pytest.mark.parametrize("values", CHANGES, ids=lambda values: next(reversed(values)))
async def test_a_change_of_the_page_changes_net_numbers_code_and_link(app, values):
    await arrived(app, "?m=6&n=5")
    await change(app, **values)
    alone = built(**{"m": 6, "n": 5} | values)
    await until(lambda: app.state.link == choices.link(alone.choice))
    await until(lambda: app.state.numbers == texts(alone))
    assert np.array_equal(app.session.V, alone.V) and app.state.code == alone.code()
    assert shown(app) == echo(alone.choice) and app.state.alert == ""


REFUSED = {"theta": 180, "m": "2.5", "n": None, "families": ["u", "w"], "radii": [1.0, 1.0]}


@pytest.mark.parametrize("name", REFUSED)
async def test_a_refused_value_is_shown_back_as_the_former_one_with_a_sentence(app, name):
    await arrived(app, "?m=6&n=5&theta=50&radii=cone")
    before, V = shown(app), app.session.V
    await change(app, **{name: REFUSED[name]})
    await until(lambda: app.state.alert)
    assert shown(app) == before and app.session.V is V
    assert name in app.state.alert or "radi" in app.state.alert
    await change(app, theta=70)  # and the page goes on
    await until(lambda: app.state.numbers["theta"] == "70")
    assert shown(app) == before | {"theta": 70.0}


async def test_a_link_with_wrong_values_is_answered_with_sentences_and_a_net(app):
    await arrived(app, "?theta=<script>&kind=cube&n=5&" + "x" * 5000 + "=1")
    assert shown(app) == echo(Choice(n=5))
    assert all(word in app.state.alert for word in ("theta", "kind", "xxx"))
    assert len(app.state.alert) < 500 and app.state.numbers["theta"] == "60"


async def test_two_tabs_share_nothing(serve, run):
    async with opened(serve, "two") as two:
        async with opened(serve, "one") as one:
            for app in (one, two):
                await arrived(app, "?m=4&n=4")
            before, V = dict(two.state.to_dict()), two.session.V
            await change(one, theta=70, kind="revolution", families=["d1"], dark=True)
            await until(lambda: one.state.numbers["theta"] == "70")
            assert dict(two.state.to_dict()) == before and two.session.V is V
            assert (one.session.choice.theta, two.session.choice.theta) == (70, 60)
        await change(two, theta=80)  # it lives on without the other one
        await until(lambda: two.state.numbers["theta"] == "80")


@pytest.mark.parametrize(
    "values",
    [
        {"kind": "revolution", "theta": 179.5, "theta0": 90},
        {"kind": "cover", "source": "file"},  # none was named
    ],
)
async def test_a_choice_without_a_net_is_explained_and_the_former_net_stays(app, quick, values):
    await arrived(app, "?m=4&n=4")
    numbers, V = app.state.numbers, app.session.V
    await change(app, **values)
    await until(lambda: app.state.problem)
    assert app.state.problem.startswith("no net: ") and app.session.V is V
    assert ("no file" in app.state.problem) is ("source" in values)
    assert app.state.numbers == numbers and not app.state.searching
    await change(app, kind="plane", theta=70)
    await until(lambda: app.state.numbers["theta"] == "70")
    assert app.state.problem == ""


async def test_what_is_only_shown_is_not_made_again(app):
    await arrived(app, "?m=4&n=3")
    V = app.session.V
    for families, parallelograms in product((["u", "v"], ["u", "d1"]), (False, True)):
        await change(app, families=families, parallelograms=parallelograms)
        want = {0: 12, 1: 60, 2: 48, 3: 60}[2 * ("d1" in families) + parallelograms]
        await until(lambda want=want: app.scene.faces.n_cells == want)
        assert app.session.V is V
    await change(app, dark=True)
    await until(lambda: app.state.colours == look.DARK.families)
    assert app.session.V is V


@pytest.mark.parametrize("kind", ["revolution", "freeform"])
async def test_what_goes_wrong_unexpectedly_is_said(app, quick, monkeypatch, capsys, kind):
    await arrived(app, "?m=4&n=4")
    monkeypatch.setattr(nets, "make", lambda *_: [][1])
    await change(app, kind=kind)
    await until(lambda: app.state.problem)
    assert "list index out of range" in app.state.problem and not app.state.searching
    monkeypatch.undo()
    await change(app, theta=80, kind="plane")
    await until(lambda: app.state.numbers["theta"] == "80")
    assert app.state.problem == "" and "IndexError" in capsys.readouterr().err


@pytest.mark.parametrize("values", [{"kind": "freeform", "m": 5, "n": 4}, {"kind": "cover"}])
async def test_a_search_runs_to_its_end(app, quick, values):
    values = {"quads": 60, "theta": 75} | values
    await arrived(app, "?m=4&n=4")
    assert not app.state.can_search
    await change(app, **values)
    await until(lambda: app.state.searching)
    await until(lambda: not app.state.searching)
    alone = built(**{"m": 4, "n": 4} | values)
    assert np.array_equal(app.session.V, alone.V)
    assert app.state.message == alone.message and app.state.can_search
    assert app.state.numbers == texts(alone)
    app.run()  # again
    await until(lambda: app.state.searching)
    await until(lambda: not app.state.searching)
    assert np.array_equal(app.session.V, alone.V)


async def test_the_steps_of_a_search_are_seen_and_stop_keeps_the_best_net(app, app_module, gate):
    app.arrive("?kind=freeform&m=5&n=5&theta=100", False, 1.0)
    await until(lambda: app.state.progress == app_module.BEGUN)
    start = surfaces.freeform_patch(5, 5)[0]
    assert np.array_equal(app.session.V, start) and app.state.searching
    assert app.state.numbers["quads"] == "25"
    app.stop()
    gate.set()
    await until(lambda: not app.state.searching)
    assert "stopped" in app.state.message and app.state.problem == ""
    assert np.array_equal(app.session.V, start)


async def test_stop_is_heard_before_the_first_step(app, app_module, quick, monkeypatch):
    monkeypatch.setattr(app_module, "REST", 0.2)  # while it waits for further changes
    await arrived(app, "?m=4&n=4")
    await change(app, kind="freeform")
    await until(lambda: app.state.searching)
    app.stop()
    await until(lambda: not app.state.searching)
    assert not app.session.message.startswith("converged") and app.state.can_search


async def test_a_change_ends_the_search_under_way_and_its_net_is_forgotten(app, app_module, gate):
    over, find = threading.Event(), app.session.find

    def found(*args):
        made = find(*args)
        over.set()
        return made

    app.session.find = found
    app.arrive("?kind=freeform&m=5&n=5&theta=100", False, 1.0)
    await until(lambda: app.state.progress == app_module.BEGUN)
    await change(app, kind="plane")
    await until(lambda: not app.state.searching)
    alone = built(m=5, n=5, theta=100)
    await until(lambda: app.state.numbers == texts(alone))
    assert not over.is_set()
    gate.set()
    await until(over.is_set)
    await asyncio.sleep(0.02)  # for what the thread may have left to do here
    assert np.array_equal(app.session.V, alone.V) and app.state.numbers == texts(alone)
    assert app.state.message == alone.message and not app.state.searching


async def test_closing_a_tab_ends_its_search(serve, run, app_module, gate):
    async with opened(serve, "closing") as app:
        app.arrive("?kind=freeform&m=5&n=5&theta=100", False, 1.0)
        await until(lambda: app.state.progress == app_module.BEGUN)
        search = app.session.run
        assert not search.stopped
    assert search.stopped
    gate.set()


async def test_a_closed_tab_leaves_its_scene_to_one_other_tab_which_shows_its_own_net(serve, run):
    async with opened(serve, "first") as first:
        await arrived(first, "?m=4&n=3&families=d1&parallelograms=1", True)
        left = first.scene
        first.close()  # and again at the end
        assert not left.faces.points.any() and left.faces.n_cells == left.curves.n_cells == 1
    async with opened(serve, "second") as second, opened(serve, "third") as third:
        assert second.scene is not third.scene
        assert left in (second.scene, third.scene)
        for app, size in ((second, 5), (third, 6)):
            await arrived(app, f"?m={size}&n=2&families=u,v&parallelograms=0")
        for app, size in ((second, 5), (third, 6)):
            assert np.allclose(app.scene.faces.points, built(m=size, n=2).V, atol=1e-6)
            assert app.scene.faces.n_cells == 2 * size
            assert app.scene.curves.n_cells == 3 * size + 2 * (size + 1)
            assert app.scene.plotter.background_color == look.LIGHT.background


async def test_a_file_is_covered_in_every_tab_and_named_in_the_code(serve, run, quick, tmp_path):
    path = tmp_path / "my roof.obj"
    io.write(path, *examples.wavy_roof(12))
    async with opened(serve, "own", surface=io.surface(path), path=path) as app:
        await arrived(app, "?quads=60")
        await until(lambda: app.state.message.startswith("converged"))
        assert (app.state.kind, app.state.source) == ("cover", "file")
        assert str(path) in app.state.code


async def test_a_surface_is_made_ready_once_while_others_work_and_whoever_waits_can_stop(
    serve, run, quick, monkeypatch
):
    made, free, ready = [], threading.Event(), design.ready

    def slow(*args):
        made.append(args)
        free.wait(LIMIT)
        return ready(*args)

    monkeypatch.setattr(design, "ready", slow)
    surface = io.Surface(*examples.wavy_roof(12), [])
    async with (
        opened(serve, "one", surface=surface) as one,
        opened(serve, "two", surface=surface) as two,
    ):
        one.arrive("?quads=60", False, 1.0)
        await until(lambda: one.state.progress.startswith("flattening"))
        await arrived(two, "?kind=plane&m=4&n=4")  # it is not kept waiting
        one.stop()
        await until(lambda: not one.state.searching)
        assert "stopped" in one.state.problem and one.session.V is None
        assert one.state.remedies == []  # there is nothing wrong with the choice
        for theta in (61, 62, 63):  # nobody waits for a run that is over
            await change(one, theta=theta)
            await until(lambda: one.state.progress.startswith("flattening"))
        free.set()
        await until(lambda: not one.state.searching)
        assert one.state.numbers["theta"] == "63" and one.state.problem == ""
        await change(two, kind="cover", source="file", quads=80)
        await until(lambda: two.state.message.startswith("converged"))
        assert len(made) == 1


async def test_a_given_net_is_shown_and_never_changed(serve, run):
    V, Q = surfaces.freeform_patch(5, 4)
    async with opened(serve, "own", net=(V, Q)) as app:
        await arrived(app, "?families=d1,d2&kind=freeform&theta=20")
        assert app.state.numbers == texts(Session(net=(V, Q)))
        await change(app, shade="size", m=9)
        await until(lambda: app.scene.faces.n_cells == 4 * len(Q))
        app.run()
        await asyncio.sleep(0.05)
        assert np.array_equal(app.session.V, V) and not app.state.searching
        assert not app.state.can_search and list(app.state.families) == ["d1", "d2"]


BAD_SAVES = [(s, SIDE) for s in ("", ".exe", "../x.obj", None, ["a"], ".step")] + [
    (".svg", camera)
    for camera in (None, {}, [], "up", {"position": [1, 2, 3]}, SIDE | {"position": [1, 2]})
]


async def test_saving_gives_the_bytes_of_the_session_seen_as_on_the_page_or_a_sentence(app):
    await arrived(app, "?kind=isothermal&m=4&n=3&families=d1")
    away = np.array(SIDE["position"])
    sight = np.arctan2(away[1], away[0]), np.arcsin(away[2] / np.linalg.norm(away))
    above = {"position": [1, 2, 9.0], "focalPoint": [1, 2, 0]}
    for suffix in (".obj", ".off", ".svg", ".png"):
        assert bytes(app.save(suffix, SIDE)) == app.session.save(suffix, *sight)
        assert bytes(app.save(suffix, above)) == app.session.save(suffix)
    app.play.keep()
    found, without = bytes(app.save(".png", SIDE)), app.session.save(".png", *sight)
    assert found == app.session.save(".png", *sight, ghost=app.play.ghost) != without
    assert app.state.alert == ""
    for suffix, camera in BAD_SAVES:
        app.state.alert = ""
        assert app.save(suffix, camera) is None
        assert app.state.alert.startswith("not saved: ")


def test_the_scene_has_the_cells_curves_and_colours_of_the_layout(serve):
    from inetlib.explorer.scene import Scene

    V, Q = surfaces.freeform_patch(5, 4)
    scene = Scene()
    for families, parallelograms, dark in product(((), ("u",), ("v", "d1", "d2")), (0, 1), (0, 1)):
        choice = Choice(families=families, parallelograms=bool(parallelograms))
        palette = look.DARK if dark else look.LIGHT
        scene.show(V, Q, choice, dark)
        plan = look.layout(Q, len(V), families, bool(parallelograms))
        assert np.allclose(scene.faces.points, look.points(V, plan), atol=1e-6)
        cells = [*plan.quads.tolist(), *plan.triangles.tolist()]
        assert [list(cell.point_ids) for cell in scene.faces.cell] == cells
        assert np.array_equal(scene.faces.cell_data["rgb"], look.fills(plan, palette))
        if not families:  # a line from a point to itself
            assert scene.curves.lines.tolist() == [2, 0, 0]
        else:
            lines = np.concatenate(list(plan.lines.values()))
            assert np.array_equal(scene.curves.lines.reshape(-1, 3)[:, 1:], lines)
            rgb = np.unique(scene.curves.cell_data["rgb"], axis=0)
            hexes = {"#{:02x}{:02x}{:02x}".format(*c) for c in rgb.tolist()}
            assert hexes == {palette.families[name] for name in families}
    cover = design.cover(*examples.wavy_roof(10), *np.radians([60, 60]), 40, trim=True)
    plain = Choice(parallelograms=False)
    scene.show(*cover[:2], plain, False, None, cover)
    plan = look.layout(cover.Q, len(cover.V), ("u", "v"), False, cover)
    cells = [*plan.quads.tolist(), *plan.cut.tolist()]
    assert [list(cell.point_ids) for cell in scene.faces.cell] == cells
    assert len(cells) > len(cover.Q) and scene.curves.n_cells == sum(map(len, plan.lines.values()))
    scene.show(*cover[:2], plain)
    assert scene.faces.n_cells == len(cover.Q)  # on the way they are not there
    looks = []
    for theta in (60, 0.1, 60):  # the same quads, and slender ones
        scene.show(V, Q, Choice(parallelograms=False, theta=theta), False, None)
        light = scene.curves.cell_data["rgb"].mean()
        looks.append((scene.actor.prop.line_width, -light))
    assert looks[0] == looks[2] > looks[1] and looks[0][1] > looks[1][1]
    shade = np.arange(3 * len(Q), dtype=np.uint8).reshape(-1, 3)
    scene.show(V, Q, plain, False, shade)
    assert np.array_equal(scene.faces.cell_data["rgb"], shade)
    scene.show(V, Q, plain, False, None)  # the shading goes when it is switched off
    assert len(np.unique(scene.faces.cell_data["rgb"], axis=0)) == 1
    scene.plotter.close()


@pytest.mark.parametrize("aspect", [0.4, 1.0, 2.5])
@pytest.mark.parametrize("call", ["fit", "from_above", "from_side"])
async def test_every_view_shows_the_whole_net_and_not_much_else(app, call, aspect):
    await arrived(app, "?kind=revolution&m=7&n=5")
    app.look(call, aspect)
    camera = app.scene.plotter.camera
    towards = np.array(camera.position) - camera.focal_point
    towards /= np.linalg.norm(towards)
    right = np.cross(camera.up, towards)
    V = app.session.V - np.array(camera.focal_point)
    high, wide = np.abs(V @ camera.up).max(), np.abs(V @ right).max()
    scale = camera.parallel_scale  # half the height of the window
    assert camera.parallel_projection
    assert 0.85 < max(high / scale, wide / (scale * aspect)) < 1
    assert np.all(V @ towards < np.linalg.norm(np.array(camera.position) - camera.focal_point))
    assert call != "from_above" or np.allclose(towards, [0, 0, 1])
    assert call == "from_above" or (0 < towards[2] < 0.8 and camera.up[2] > 0.5)


async def test_a_planar_net_is_seen_from_above_and_a_grown_one_is_fitted_again(app):
    await arrived(app, "?m=4&n=4&map=identity")
    camera = app.scene.plotter.camera
    towards = np.subtract(camera.position, camera.focal_point)
    assert np.allclose(towards / np.linalg.norm(towards), [0, 0, 1])
    scale = camera.parallel_scale
    await change(app, theta=62)
    await until(lambda: app.state.numbers["theta"] == "62")
    assert camera.parallel_scale == scale  # a small change does not move the view
    await change(app, map="exp")
    await until(lambda: camera.parallel_scale > 1.5 * scale)


async def test_a_net_that_grows_out_of_the_view_is_fitted_again_from_where_it_was_seen(app):
    await arrived(app, "?kind=revolution&m=12&n=2")
    app.look("from_side")
    camera = app.scene.plotter.camera

    def seen():
        towards = np.subtract(camera.position, camera.focal_point)
        return towards / np.linalg.norm(towards), camera.parallel_scale

    (direction, scale), before = seen(), app.state.numbers["quads"]
    await change(app, n=12)
    await until(lambda: app.state.numbers["quads"] != before)
    there, wider = seen()
    assert np.allclose(there, direction) and wider > 1.5 * scale
    V = app.session.V - np.array(camera.focal_point)
    assert np.abs(V @ camera.up).max() < wider


@asynccontextmanager
async def visited(serve, **options):
    """(a door that is open, a client whose addresses are its)."""
    import aiohttp

    door = serve.Door(**options)
    port = await door.open(0)
    try:
        assert urlsplit(door.root).port == port
        async with aiohttp.ClientSession(door.root) as client:
            yield door, client
    finally:
        await door.close()


@pytest.fixture(scope="module")
def house(serve, run):
    """A door and a client for all tests that leave it as it is."""
    visiting = visited(serve)
    yield run(visiting.__aenter__())
    run(visiting.__aexit__(None, None, None))


async def raw(door, target, **headers):
    """(status, body) of a request below the token that no client has tidied up."""
    return await stranger(door.port, f"/{door.token}{target}", **headers)


async def stranger(port, target, **headers):
    """(status, body) of a request that no client has tidied up."""
    reader, writer = await asyncio.open_connection(HOST, port)
    headers = {"Host": f"{HOST}:{port}", "Connection": "close"} | headers
    lines = [f"GET {target} HTTP/1.1", *(f"{k}: {v}" for k, v in headers.items()), "", ""]
    writer.write("\r\n".join(lines).encode())
    head, _, body = (await reader.read()).partition(b"\r\n\r\n")
    writer.close()
    await writer.wait_closed()
    return int(head.split()[1]), body


QUERIES = (
    [("theta", "50"), ("families", "u,v")],
    [("a", "1+1"), ("b", "&c=d"), ("c", "\u03b8 %"), ("d", "")],
)


async def test_the_address_alone_leads_to_the_page_with_its_query(house):
    door, client = house
    async with client.get(".") as answer:
        assert answer.status == 200 and answer.url.path == f"/{door.token}/index.html"
        assert answer.content_type == "text/html" and "<html" in (await answer.text()).lower()
    for pairs in QUERIES:
        async with client.get(f"?{urlencode(pairs)}", allow_redirects=False) as answer:
            assert answer.status == 302
            there = urlsplit(urljoin(str(answer.url), answer.headers["Location"]))
        assert (there.netloc, there.path) == (f"{HOST}:{door.port}", f"/{door.token}/index.html")
        assert parse_qsl(there.query, keep_blank_values=True) == pairs


async def linked(client, page):
    """{address: bytes} of all that a page loads."""
    async with client.get(page) as answer:
        assert answer.status == 200
        text, base = await answer.text(), str(answer.url)
    found = {}
    for name in re.findall(r'<(?:script|link)[^>]* (?:src|href)="([^"]+)"', text):
        async with client.get(urljoin(base, name)) as answer:
            assert answer.status == 200, name
            found[name] = await answer.read()
    return text, found


async def test_all_that_a_page_loads_is_there_for_a_given_net_too(house):
    door, client = house
    door.nets["abc"] = surfaces.freeform_patch(3, 3)
    page = await linked(client, "index.html")
    assert any(name.endswith(".js") for name in page[1]) and min(map(len, page[1].values())) > 0
    assert await linked(client, "net/abc/index.html?families=u") == page
    async with client.get("net/abd/index.html") as answer:
        assert answer.status == 404 and "run the cell" in await answer.text()
    del door.nets["abc"]
    async with client.get("net/abc/index.html") as answer:
        assert answer.status == 404


HOSTS = """
evil.example evil.example:{port} 127.0.0.1.evil.example localhost.evil.example:{port} 127.0.0.2
0.0.0.0:{port}
"""
SITES = """
http://evil.example null http://127.0.0.1:1 http://localhost:{port}
http://127.0.0.1:{port}.evil.example http://evil.example/127.0.0.1:{port}
"""
BROKEN = "[", "http://[", "[::1", "http://[x]:y", "]"
OTHERS = [{"Host": ""}, {"Host": "evil.example", "Origin": "http://evil.example"}]
OTHERS += [{"Host": host} for host in (*HOSTS.split(), *BROKEN)]
OTHERS += [{"Origin": site} for site in (*SITES.split(), *BROKEN)]
OURS = [
    {},
    {"Host": "localhost:{port}"},
    {"Host": "127.0.0.1"},
    {"Origin": "http://127.0.0.1:{port}"},
    {"Host": "localhost:{port}", "Origin": "http://localhost:{port}"},
]


async def test_other_hosts_and_other_sites_are_refused_and_ours_are_not(house):
    door, _ = house
    door.nets["abc"] = surfaces.freeform_patch(3, 3)
    for target in ("/", "/index.html", "/net/abc/index.html", "/ws", "/net/abc/ws", "/none"):
        for headers in OTHERS:
            sent = {k: v.format(port=door.port) for k, v in headers.items()}
            status, body = await raw(door, target, **sent)
            allowed = {403, 400} if {*BROKEN} & {*sent.values()} else {403}
            assert status in allowed and b"<html" not in body, (target, headers)
    for headers in OURS:
        sent = {k: v.format(port=door.port) for k, v in headers.items()}
        assert (await raw(door, "/index.html", **sent))[0] == 200, headers


async def test_only_who_knows_the_token_is_served_and_no_other_site_frames_the_page(serve, run):
    import aiohttp

    for framed in (False, True):
        async with visited(serve, framed=framed) as (door, client):
            door.nets["abc"] = surfaces.freeform_patch(3, 3)
            other = serve.Door().token
            assert other != door.token and len(other) == 22
            for start in ("", f"/{other}", f"/{door.token}x", "//", f"/x/{door.token}"):
                for target in ("/", "/index.html", "/ws", "/net/abc/index.html", "/net/abc/ws"):
                    status, body = await stranger(door.port, start + target)
                    assert (status, body.decode()) == (403, serve.STRANGER), (start, target)
            with pytest.raises(aiohttp.WSServerHandshakeError):
                await client.ws_connect(f"http://{HOST}:{door.port}/{other}/ws")
            assert await stranger(door.port, "/favicon.ico") == (204, b"")
            for target in ("", "net/abc/index.html", "nothing"):
                async with client.get(target) as answer:
                    found = answer.headers.get("Content-Security-Policy")
                    assert found == (None if framed else "frame-ancestors 'self'")


async def test_behind_the_guard_of_a_hub_other_hosts_are_served(serve, run):
    headers = {"Host": "hub.example", "Origin": "https://hub.example"}
    async with visited(serve, guarded=False) as (door, _):
        assert (await raw(door, "/index.html", **headers))[0] == 200


UPWARDS = "../", "%2e%2e/", "..%2f", "%2e%2e%2f", "..\\", "..%5c", "....//", "%252e%252e/"


async def test_no_file_but_those_of_the_page_is_read(serve, run, tmp_path):
    secret = tmp_path / "secret.obj"
    io.write(secret, *examples.wavy_roof(4))
    content, name = secret.read_bytes(), secret.as_posix().lstrip("/")
    async with visited(serve, surface=io.surface(secret), path=secret) as (door, client):
        assert (await raw(door, "/index.html"))[0] == 200
        async with client.get("index.html") as answer:
            script = re.search(r'src="\.?/?([^"]+\.js)"', await answer.text())[1]
        folder = script.rpartition("/")[0]
        for up, start in product(UPWARDS, ("/", f"/{folder}/", "/index.html/", "/net/abc/")):
            status, body = await raw(door, start + up * 30 + name)
            assert content[:20] not in body, (start, up)
            assert status in (400, 403, 404) or (start == "/net/abc/" and status == 302)
        absolute = f"//{name}", f"/%2f{name}", f"/{name}"
        for target in (*absolute, "/secret.obj", f"/{folder}/", "/net/"):
            status, body = await raw(door, target)
            assert status in (400, 403, 404) and content[:20] not in body, target


async def test_only_this_machine_can_connect(house):
    door, _ = house
    others = {"127.0.0.2", "::1"}
    others |= {a[4][0] for a in socket.getaddrinfo(socket.gethostname(), None)} - {HOST}
    for address in others:
        with pytest.raises(OSError):
            await asyncio.open_connection(address, door.port)
    assert (await raw(door, "/index.html"))[0] == 200


async def test_a_port_that_is_taken_is_an_error_and_a_free_one_is_used(serve, run, monkeypatch):
    with socket.socket() as held:
        held.bind((HOST, 0))
        held.listen()
        taken = held.getsockname()[1]
        door = serve.Door()
        with pytest.raises(OSError):
            await door.open(taken)
        monkeypatch.setattr(serve, "PORT", taken)
        for more in (2, 1):  # without a port the usual one, the next one, or any
            monkeypatch.setattr(serve, "MORE", more)
            port = await door.open()
            assert port != taken and (await raw(door, "/index.html"))[0] == 200
            await door.close()
    assert await door.open(port) == door.port == port  # it is free again
    assert (await raw(door, "/index.html"))[0] == 200
    await door.close()
    with pytest.raises(OSError):
        await asyncio.open_connection(HOST, port)


async def test_every_connection_has_an_app_of_its_own_that_ends_with_it(serve, run):
    import aiohttp
    from trame.app.core import AVAILABLE_SERVERS

    before = set(AVAILABLE_SERVERS)
    async with visited(serve) as (door, client):
        door.nets["abc"] = surfaces.freeform_patch(3, 3)
        sockets = [await client.ws_connect(path) for path in ("ws", "ws", "net/abc/ws")]
        await until(lambda: len(door.tabs) == 3)
        apps = [app for app, _ in door.tabs]
        assert len({id(a.session) for a in apps}) == len({a.server.name for a in apps}) == 3
        assert sorted(a.session.given for a in apps) == [False, False, True]
        assert len(set(AVAILABLE_SERVERS) - before) == 3
        await sockets[0].close()
        await until(lambda: len(door.tabs) == 2)
        for path, headers in (("ws", {"Origin": "http://evil.example"}), ("net/abd/ws", {})):
            with pytest.raises(aiohttp.WSServerHandshakeError):
                await client.ws_connect(path, headers=headers)
        await door.close()
        await until(lambda: not door.tabs and set(AVAILABLE_SERVERS) == before)
        for one in sockets[1:]:
            await one.receive()
            assert one.closed


def packed(number, method, *args):
    """A call as trame's page sends it: a header (message, offset, size) before it."""
    import msgpack  # comes with trame

    call = {"wslink": "1.0", "id": number, "method": method, "args": list(args), "kwargs": {}}
    body = msgpack.packb(call)
    return struct.pack("<III", 1, 0, len(body)) + body


async def answer(socket):
    """What comes back to a call: other messages (the state, the pictures) are passed over."""
    import msgpack

    whole = b""
    while True:
        message = await socket.receive_bytes(timeout=LIMIT)
        offset, size = struct.unpack("<II", message[4:12])
        whole = (whole if offset else b"") + message[12:]
        found = msgpack.unpackb(whole) if len(whole) == size else {}
        if not found.get("id", "publish:").startswith("publish:"):
            return found


async def test_a_page_that_says_hello_is_answered_and_nobody_else(house):
    _, client = house
    async with client.ws_connect("ws") as socket:
        await socket.send_bytes(packed("rpc:c0:0", "trame.state.get"))
        assert "Unauthorized" in (await answer(socket))["error"]["message"]
        await socket.send_bytes(packed("system:c0:0", "wslink.hello", {"secret": "guessed"}))
        assert "Authentication failed" in (await answer(socket))["error"]["message"]
        await socket.send_bytes(packed("system:c0:1", "wslink.hello", {"secret": "wslink-secret"}))
        found = await answer(socket)
        assert found["id"] == "system:c0:1" and found["result"]["clientID"]
        await socket.send_bytes(packed("rpc:c0:1", "trame.state.get"))
        assert (await answer(socket))["result"]["state"]["kind"] == Choice().kind
        await socket.send_bytes(packed("rpc:c0:2", "trame.trigger", "look", [], {}, "too many"))
        wrong = (await answer(socket))["error"]  # without a trace and its paths
        assert wrong == {"code": -32001, "message": "Exception raised"}


async def test_an_answer_to_a_tab_that_is_just_closing_is_dropped_in_silence(
    house, monkeypatch, caplog
):
    _, client = house
    tried = []

    async def gone(*words):
        tried.append(words)
        raise ConnectionResetError("Cannot write to closing transport")

    monkeypatch.setattr("aiohttp.web.WebSocketResponse.send_bytes", gone)
    async with client.ws_connect("ws") as socket:
        await socket.send_bytes(packed("system:c0:0", "wslink.hello", {"secret": "wslink-secret"}))
        await until(lambda: tried)
        await asyncio.sleep(0.05)
    assert "Traceback" not in caplog.text


async def test_of_many_moves_of_a_slider_only_the_latest_are_computed(house):
    door, client = house
    async with client.ws_connect("ws") as socket:
        await socket.send_bytes(packed("system:c0:0", "wslink.hello", {"secret": "wslink-secret"}))
        await answer(socket)
        await until(lambda: len(door.tabs) == 1)
        ((app, _),) = door.tabs
        await arrived(app, "?m=4&n=4")
        construct, made = app.session.construct, []

        def slow():
            time.sleep(0.02)  # as long as nothing else is heard
            construct()
            made.append(app.session.choice.theta)

        app.session.construct = slow
        moves = [float(theta) for theta in range(61, 101)]
        for k, theta in enumerate(moves):
            change = [{"key": "theta", "value": theta}]
            await socket.send_bytes(packed(f"rpc:c0:{k}", "trame.state.update", change))
        await until(lambda: made and made[-1] == moves[-1])
        assert made == sorted(made) and len(made) < len(moves) / 4


TABS = """
import sys
import inetlib.explorer.session
if {"vtkmodules", "pyvista", "trame", "aiohttp"} & {m.split(".")[0] for m in sys.modules}:
    sys.exit("the explorer needs the packages of its page before there is one")

import asyncio, gc, os
import aiohttp
from inetlib.explorer import serve
from inetlib.explorer.app import App

serve.SWEEP = 0.02

def held():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") >> 20

async def tab(door, client, changes):
    async with client.ws_connect("ws"):
        while not door.tabs:
            await asyncio.sleep(0.005)
        ((app, _),) = door.tabs
        app.arrive("?m=8&n=8&families=", False, 1.0)
        for k in range(changes):
            with app.state:
                app.state.update({"theta": 60 + k, "families": ["u"]})
            await app._task
    while door.tabs:
        await asyncio.sleep(0.005)

async def tabs():
    door = serve.Door()
    await door.open(0)
    async with aiohttp.ClientSession(door.root) as client:
        few, many, changes = map(int, sys.argv[1:])
        for count in (few, many - few):
            for _ in range(count):
                await tab(door, client, changes)
            await asyncio.sleep(0.3)  # collected
            apps = sum(type(x) is App for x in gc.get_objects())
            if os.path.exists("/proc/self/task"):
                print(held(), len(os.listdir("/proc/self/task")), apps)
    await door.close()

asyncio.run(tabs())
gc.collect()
print("alive")
"""


def begun(*counts):
    """A process of its own for TABS, as an error in VTK's destructors ends it."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([sys.executable, "-c", TABS, *map(str, counts)], **options)


@pytest.fixture(scope="module", autouse=True)
def elsewhere():
    """Begun early."""
    with begun(3, 9, 3) as process:
        yield process
        process.kill()


def forgotten(process, patience=LIMIT):
    """What a process for TABS says: it lives on, and keeps no tab; a line to print."""
    out, errors = process.communicate(timeout=patience)
    *counts, last = out.splitlines()
    assert (process.returncode, last) == (0, "alive"), errors[-2000:]
    few, many, changes = process.args[-3:]
    words = f"\n{few} tabs with {changes} changes each opened and closed, then {many}: "
    if counts:  # where the system tells
        (mb, threads, apps), (more, others, left) = (map(int, line.split()) for line in counts)
        assert more < 1.2 * mb and others <= threads and left <= apps <= 1
        words += f"{mb} MB and {threads} threads, then {more} and {others}"
    return words


def test_the_process_outlives_its_tabs_and_forgets_them(serve, elsewhere, capsys):
    words = forgotten(elsewhere)
    with capsys.disabled():
        print(words)


@pytest.mark.long
def test_fifty_tabs_with_five_hundred_changes_are_forgotten(serve, capsys):
    with begun(10, 50, 10) as process:
        words = forgotten(process, 600)
    with capsys.disabled():
        print(words)


@pytest.mark.parametrize(
    ("name", "net", "page"),
    [("SIGTERM", None, ""), ("SIGINT", surfaces.freeform_patch(2, 2), "net/file/index.html")],
)
def test_serving_ends_with_a_signal_and_the_port_is_free_again(serve, name, net, page):
    number, addresses = getattr(signal, name), []

    def unheard(*_):
        raise AssertionError("the signal was not heard")

    def ready(address):
        addresses.append(address)
        signal.raise_signal(number)

    before = signal.signal(number, unheard)
    try:
        serve.serve(port=0, ready=ready, net=net)
    finally:
        signal.signal(number, before)
    (address,) = addresses
    assert re.fullmatch(rf"http://{HOST}:\d+/[\w-]{{22}}/{page}", address)
    with pytest.raises(OSError):
        socket.create_connection((HOST, urlsplit(address).port), timeout=LIMIT)


@pytest.fixture
def kernel(monkeypatch):
    """As in a notebook's kernel where no server has been started yet."""
    monkeypatch.setattr(notebook, "_door", None)
    monkeypatch.setattr(notebook, "_shown", {})
    monkeypatch.setattr(view, "available", lambda: (False, "no OpenGL"))
    monkeypatch.setitem(sys.modules, "ipykernel", types.ModuleType("ipykernel"))
    for name in ("JUPYTERHUB_SERVICE_PREFIX", "INETLIB_PROXY"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def door(kernel, monkeypatch):
    """Stands for the server of the process: none is started."""
    fake = types.SimpleNamespace(port=4321, nets={}, token="abc", root=f"http://{HOST}:4321/abc/")
    monkeypatch.setattr(notebook, "_open_door", lambda: fake)
    return fake


def decoded(data):
    return imread(streams.BytesIO(data), format="png")


def test_a_still_net_in_a_notebook_is_a_picture_of_the_same_net():
    for values in ({"m": 5, "n": 4}, {"kind": "freeform", "m": 4, "n": 4, "theta": 75}):
        still = notebook.show(live=False, **values)
        assert type(still).__name__ == "Image" and type(still).__module__.startswith("IPython")
        sight = notebook.TOP if "kind" not in values else notebook.ROUND
        assert still.data == built(**values).save(".png", *sight)
        assert decoded(still.data).std() > 0.01


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"theta": "steep", "m": 2}, "theta.*; m = '2'"),
        ({"kind": "cover", "source": "file"}, "no file"),
        ({"kind": "revolution", "m": 3, "theta": 179.9, "theta0": 90}, "no net"),
    ],
)
def test_a_notebook_that_asks_for_what_is_none_gets_a_value_error(door, values, words):
    for live in (True, False, None):
        with pytest.raises(ValueError, match=words):
            notebook.show(live=live, **values)


def test_a_live_net_is_a_page_with_the_picture_for_where_there_is_none(door):
    values = {"kind": "isothermal", "m": 4, "n": 3, "theta": 70, "lock": True}
    live = notebook.show(live=True, height=345, **values)
    bundle = live._repr_mimebundle_()
    page = re.fullmatch(
        r'<object type="text/html" data="([^"]+)" style="([^"]+)">'
        r'<img [^>]*src="data:image/png;base64,([^"]+)"[^>]*><p>(.+)</p></object>',
        bundle["text/html"],
    )
    assert page[1] == live.address == bundle["text/plain"] and "height: 345px" in page[2]
    assert f'run the cell again, or open <a href="{live.address}"' in page[4]
    assert base64.b64decode(page[3]) == base64.b64decode(bundle["image/png"])
    still = notebook.show(live=False, **values)
    assert base64.b64decode(bundle["image/png"]) == still.data
    address = urlsplit(live.address)
    assert (address.scheme, address.netloc) == ("http", f"{HOST}:{door.port}")
    assert address.path == "/abc/index.html" and door.nets == {}
    assert choices.parse(address.query) == (built(**values).choice, [])


PATCH = surfaces.freeform_patch(4, 3)


def test_a_given_net_has_a_page_of_its_own_with_the_families_that_have_curves(door):
    some = mesh.polylines(PATCH[1])._replace(u=[], d1=[])
    one = notebook.turn(*PATCH, some, live=True, view=(1.0, 0.2))
    two = notebook.turn(*PATCH, mesh.Families([], [], [], []), live=True)
    keys = [
        re.fullmatch(r"/abc/net/(\w+)/index.html", urlsplit(x.address).path)[1] for x in (one, two)
    ]
    assert list(door.nets) == keys and keys[0] != keys[1]
    for key in keys:
        assert all(map(np.array_equal, door.nets[key], PATCH))
    for live, families in ((one, ("v", "d2")), (two, ())):
        assert choices.parse(urlsplit(live.address).query)[0].families == families
    session = Session(net=PATCH)
    session.change(families=("v", "d2"))
    assert one.picture == session.save(".png", 1.0, 0.2)  # drawn without OpenGL
    with pytest.raises(ValueError, match="vertex"):
        notebook.turn(PATCH[0][:-1], PATCH[1], live=True)
    with pytest.raises(RuntimeError, match="no OpenGL"):
        notebook.turn(*PATCH, live=False)


def test_a_net_of_a_file_is_named_and_read_again_by_its_code(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    io.write("my net.obj", *PATCH)
    session, names = Session(net=PATCH, path="my net.obj"), {}
    assert session.message.startswith("my net.obj; ")
    exec(session.code(), names)
    assert np.array_equal(names["V"], PATCH[0]) and np.array_equal(names["Q"], PATCH[1])
    assert session.unit == "Lengths are in the unit of my net.obj." and session.cover is None
    V, Q, polygon = mesh.polygon_rings(5, 2)
    session = Session(net=(V, Q, [polygon]))
    assert session.report.polygons == (5,) and session.save(".obj").count(b"\nf ") == len(Q) + 1
    assert session.unit == "Lengths have no unit."
    said = plates.numbers(session.report, V, Q)
    assert (said["faces"], said["others"], said["cut"]) == ("quads", "other faces", "1")


def test_nets_are_released_with_their_cell_and_the_oldest_ones(door, monkeypatch):
    def run(cell, number, *gone):
        monkeypatch.setattr(notebook, "_cell", lambda: (cell, gone, number))
        notebook.turn(*PATCH, live=True)
        return list(door.nets)

    assert len(run("a", 1)) == 1 and len(run("a", 1)) == 2  # two nets of one cell
    two = run("b", 2)
    assert len(two) == 3
    again = run("a", 3)
    assert len(again) == 2 and again[0] == two[2]
    assert run("c", 4, "b")[0] == again[1] and len(door.nets) == 2
    monkeypatch.setattr(notebook, "KEPT", 5)
    for _ in range(9):  # nobody says which cell it is
        last = run(None, None)
    assert len(last) == 5 and set(notebook._shown) == set(last)


@pytest.mark.parametrize(
    ("name", "value", "prefix"),
    [
        ("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/", "/user/ada/proxy/"),
        ("JUPYTERHUB_SERVICE_PREFIX", "/hub/user/bob%40x/lab/", "/hub/user/bob%40x/lab/proxy/"),
        ("INETLIB_PROXY", "/proxy/", "/proxy/"),
        ("INETLIB_PROXY", "/base/proxy", "/base/proxy/"),
    ],
)
def test_behind_a_proxy_the_page_is_found_through_it(door, monkeypatch, name, value, prefix):
    monkeypatch.setenv(name, value)
    start = f"{prefix}{door.port}/abc/"
    live = notebook.show(live=True, m=4, n=4)
    assert live.address == f"{start}index.html?{choices.link(built(m=4, n=4).choice)}"
    given = notebook.turn(*PATCH, live=True)
    (key,) = door.nets
    assert given.address.startswith(f"{start}net/{key}/index.html?")


def test_a_live_page_answers_from_a_server_of_the_process(serve, kernel):
    page = notebook.show(live=True, m=4, n=4)
    given = notebook.turn(*PATCH, live=True)
    assert urlsplit(page.address).port == urlsplit(given.address).port  # one server for all
    direct = build_opener(ProxyHandler({}))
    for live in (page, given):
        with direct.open(live.address, timeout=LIMIT) as answer:
            assert answer.status == 200 and b"<html" in answer.read().lower()


@pytest.mark.parametrize("hub", ["JUPYTERHUB_SERVICE_PREFIX", "INETLIB_PROXY", ""])
def test_the_server_of_the_process_is_guarded_unless_a_proxy_is(serve, kernel, monkeypatch, hub):
    doors = []

    class Door:
        def __init__(self, guarded, framed):
            self.guarded, self.framed = guarded, framed
            doors.append(self)

        async def open(self, port):
            self.port = port

    monkeypatch.setattr(serve, "Door", Door)
    if hub:
        monkeypatch.setenv(hub, "/user/ada/")
    assert notebook._open_door() is notebook._open_door() is doors[0]
    assert len(doors) == 1 and doors[0].port == 0 and doors[0].guarded is not bool(hub)
    assert doors[0].framed


def test_without_the_packages_of_the_page_the_error_says_what_to_install(kernel, monkeypatch):
    monkeypatch.setitem(sys.modules, "inetlib.explorer.serve", None)
    monkeypatch.delattr("inetlib.explorer.serve", raising=False)
    with pytest.raises(ImportError, match=r"extra `view`.*pip install"):
        notebook.show(live=True, m=3, n=1)
    assert decoded(notebook.show(live=False, m=3, n=1).data).ndim == 3  # pictures need none


def test_every_attribute_of_the_page_reaches_the_browser(app_module, monkeypatch):
    from trame_client.widgets import core

    made, known = [], core.AbstractElement.__init__

    def init(self, *args, **attributes):
        known(self, *args, **attributes)
        made.append(self)

    monkeypatch.setattr(core.AbstractElement, "__init__", init)
    for net in (None, surfaces.freeform_patch(3, 3)):
        app_module.App(f"attributes {net is None}", net=net).close()
    assert len(made) > 200 and all(widget.html for widget in made)
    assert {w._elem_name: w.skipped_attributes for w in made if w.skipped_attributes} == {}


def test_a_person_without_these_packages_gets_a_still_picture_and_is_told_why(
    kernel, monkeypatch, capsys
):
    monkeypatch.setenv("JPY_SESSION_NAME", "a.ipynb")
    monkeypatch.setitem(sys.modules, "inetlib.explorer.serve", None)
    monkeypatch.delattr("inetlib.explorer.serve", raising=False)
    for shown in (partial(notebook.show, m=4, n=4), partial(notebook.turn, *PATCH)):
        assert decoded(shown().data).std() > 0.01
        out = capsys.readouterr().out
        assert out.startswith("a still picture: ") and "pip install" in out and out.count("\n") == 1
    with pytest.raises(ImportError, match="pip install"):
        notebook.show(m=4, n=4, live=True)


def test_who_runs_a_notebook_in_vs_code_is_a_person(kernel, monkeypatch):
    monkeypatch.delenv("JPY_SESSION_NAME", raising=False)
    assert not notebook.person()
    shell = types.SimpleNamespace(user_ns={"__vsc_ipynb_file__": "a.ipynb"})
    monkeypatch.setattr("IPython.get_ipython", lambda: shell)
    assert notebook.person()


def test_the_nets_to_begin_with_have_links_that_open_and_pictures(app_module):
    import presets  # tools/presets.py

    welcome = presets.welcome
    for name, preset in welcome.PRESETS.items():
        choice, problems = choices.parse(preset.link)
        assert problems == [] and choice.parallelograms
        drawn = imread(welcome.PICTURES / f"{name}.png")
        assert drawn.shape[:2] == presets.SIZE[::-1] and drawn.std() > 0.05
    assert len({preset.link for preset in welcome.PRESETS.values()}) == 12


@pytest.mark.long
def test_the_pictures_of_the_nets_to_begin_with_are_drawn_alike(app_module, monkeypatch):
    import presets

    from inetlib.drawings import same

    monkeypatch.setattr(look, "PIXELS", 1200)
    stored = {
        n: (presets.welcome.PICTURES / f"{n}.png").read_bytes() for n in presets.welcome.PRESETS
    }
    for name, preset in presets.welcome.PRESETS.items():
        assert same.picture(stored[name], presets.picture(preset), *same.FEW), name
