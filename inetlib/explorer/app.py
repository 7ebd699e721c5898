"""One browser tab: the page's state, kept in step with a `session.Session`."""

import asyncio
import time
import traceback
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from math import atan2, hypot
from pathlib import Path

from trame.app import get_server
from trame.app.core import AVAILABLE_SERVERS
from trame_vtk.modules import vtk as vtk_module

from . import choices, look, page, plates, scene, welcome
from .history import differing
from .play import Play
from .session import Session

PACE = 0.12  # seconds that a step of an optimisation is seen at least
SENT = 0.001  # seconds that a picture is given to be sent, before there is more to say
REST = 0.2  # seconds without a change before an optimisation begins
NEW_PLACE = {"kind", "map", "surface", "source", "moebius"}  # the net is somewhere else
SIGHTS = {"from_above": scene.VIEWS["plane"], "from_side": (-60.0, 15.0)}
BEGUN = "optimising \u2026"
TEXTS = "alert", "problem", "message", "progress", "code", "link", "stem", "unit"
DRAWN = "parallelogram_svg", "histogram_svg", "profile_svg"
OFF = "dark", "searching", "can_search", "code_open", "help_open", "presets_open", "has_one_hole"


class App:
    """The explorer in one tab, a trame server without a port; arguments as of `Session`."""

    def __init__(self, name, surface=None, path=None, net=None):
        self.session = Session(surface, path, net)
        self.server = get_server(name, client_type="vue3")
        self.state = self.server.state
        self.scene = scene.borrow()
        self.aspect, self.sight, self.fitted = 1.0, None, None
        self.placed = []  # the camera of the link, until another one is asked for
        self._task = self._search = None
        self._asked, self._remake, self._whole = False, False, True
        self._worker = ThreadPoolExecutor(
            1, "search"
        )  # a new one waits until the old one has ended
        self.state.trame__title = "Isogonal nets"
        self.state.update(dict.fromkeys((*TEXTS, *DRAWN), "") | dict.fromkeys(OFF, False))
        self.state.numbers, self.state.legend = {}, []
        known = choices.OPTIONS["source"] | {"file": path and Path(path).name}
        items = [{"title": words, "value": key} for key, words in known.items() if words]
        self.state.source_items = items
        self._dress()
        self._echo()
        self.play = Play(self)
        self.view = page.build(self.server, self.scene.plotter, self.session.given)
        self.state.trame__template_error = self.state.trame__template_main  # see `ended` there
        self.state.change(*choices.NAMES)(self._changed)
        self.state.change("dark")(self._dressed)
        for call in (self.arrive, self.preset, self.save, self.run, self.stop):
            self.server.trigger(call.__name__)(call)
        for name in ("fit", "refit", "from_above", "from_side"):
            self.server.trigger(name)(partial(self.look, name))

    def close(self):
        """Forget the tab: end its search, free its memory, once."""
        self.session.stop()
        self.play.end()
        for task in (self._task, self._search):
            if task is not None:
                task.cancel()
        self._worker.shutdown(wait=False, cancel_futures=True)
        AVAILABLE_SERVERS.pop(self.server.name, None)
        vtk_module.HELPERS_PER_SERVER.pop(self.server.name, None)
        if self.scene is not None:
            scene.give_back(self.scene)
            self.scene = None

    def _echo(self, problems=()):
        """Show the choice as it is, whatever was typed, and what was wrong."""
        self.state.update(_listed(self.session.choice))
        if problems:
            self.state.alert = " \u00b7 ".join(problems[:4])

    def _dressed(self, **_):
        self._dress()
        self._soon(False)

    def _dress(self):
        palette = look.DARK if self.state.dark else look.LIGHT
        self.state.colours = palette.families
        self.state.palette = "; ".join(f"--ex-{k}: {v}" for k, v in palette.families.items())

    def arrive(self, query, dark, aspect):
        """A browser has opened the page: take the link's values, and show the net."""
        asked, self.placed = choices.seen(str(query))
        self.state.dark, self.aspect = bool(dark if asked is None else asked), float(aspect)
        self._dress()
        self.session.choice, problems = choices.parse(str(query), self.session.choice)
        self._echo(problems)
        self.play.begin()
        self._soon(True)

    def _changed(self, **_):
        before = self.session.choice
        values = {k: self.state[k] for k, x in _listed(before).items() if self.state[k] != x}
        if values:
            self._echo(self.session.change(**values))
        if self.session.choice != before:
            self.play.changed()
            self.follow(set(values))

    def follow(self, names):
        """Show the net of the choice, in which the values of these names are new."""
        self._echo()
        if NEW_PLACE & names:
            self.sight, self.fitted, self.placed = None, None, []
        self._soon(not names <= set(choices.SHOWN))

    def preset(self, name):
        """Open a net to begin with."""
        before = self.session.choice
        self.session.choice, _ = choices.parse(welcome.PRESETS[name].link)
        self.play.changed()
        self.follow(differing(before, self.session.choice))

    def run(self):
        """Begin the search again."""
        self._soon(True)

    def stop(self):
        """Stop the search: the best net so far is kept."""
        self.session.stop()
        self.state.progress = "stopping \u2026"
        if self.session.run is None and self._search is not None:  # it has not begun
            self._search.cancel()
            self.state.update({"searching": False, "can_search": True})

    def save(self, suffix, camera):
        """The bytes of a file, for the browser to keep; None, and a message, if there is none."""
        try:
            x, y, z = (a - b for a, b in zip(camera["position"], camera["focalPoint"], strict=True))
            sight = (atan2(y, x), atan2(z, hypot(x, y))) if hypot(x, y) > 1e-6 * abs(z) else ()
            data = self.session.save(suffix, *sight, ghost=self.play.ghost)
        except (ValueError, ImportError, KeyError, TypeError) as error:
            self.state.alert = f"not saved: {error}"
            return None
        return self.server.protocol.addAttachment(data)

    def look(self, name, aspect=None):
        """See the whole net: "from_above", "from_side", "fit": by default, "refit": as before."""
        self.aspect = float(aspect or self.aspect)
        if aspect and name != "refit":  # somebody pressed the button
            self.placed = []
        V, sight = self.session.V, SIGHTS.get(name, self.sight)
        if name == "fit":
            sight = scene.sight("cover" if self.session.given else self.session.choice.kind, V)
        if V is not None and sight is not None:
            grows = self.session.run is not None and self.session.choice.trim  # in the end
            self.sight, self.fitted = sight, None if grows else V
            fitting = partial(self.scene.camera, self.play.extent(), *sight, self.aspect)
            self.view.push_camera(self.scene.place(*self.placed) if self.placed else fitting())

    def _soon(self, remake):
        """Show the net when the changes that are waiting have come; remake: make it first."""
        self._asked, self._remake = True, self._remake or remake
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._safely(self._refresh()))

    async def _safely(self, work):
        """What nobody waits for must not fail in silence."""
        try:
            await work
        except Exception as error:
            traceback.print_exc()
            self.session.stop()
            self.session.run = None
            with self.state:
                self.state.searching = False
                self.state.problem = f"something went wrong: {error}"

    async def _refresh(self):
        await asyncio.sleep(0)
        while self._asked:
            self._asked, remake, self._remake = False, self._remake, False
            search = remake and self.session.must_search
            if remake:
                self.session.stop()
                if self._search is not None:
                    self._search.cancel()
                self.state.searching = search
            if search:
                self._search = asyncio.create_task(self._safely(self._find()))
                self.state.progress = "preparing \u2026"
            elif remake:
                self.session.construct()
            with self.state:
                (self._plates if search else self._draw)()
            if not search:
                await asyncio.sleep(SENT)
                with self.state:
                    self._say()

    async def _find(self):
        """Search for the net of the choice, when the changes have come to rest."""
        await asyncio.sleep(REST)
        run, loop = self.session.begin(), asyncio.get_running_loop()

        def seen(V, Q, steps):
            loop.call_soon_threadsafe(self._frame, run, V, Q, steps)
            time.sleep(PACE)

        def told(words):
            loop.call_soon_threadsafe(self._tell, run, words)

        made = await loop.run_in_executor(self._worker, self.session.find, run, seen, told)
        if self.session.take(run, made):
            with self.state:  # at once: to draw takes time
                self.state.searching = False
                self._say()
            await asyncio.sleep(SENT)
            with self.state:
                self._show()

    def _tell(self, run, words):
        if run is self.session.run and not run.stopped:
            with self.state:
                self.state.progress = f"{words} \u2026"

    def _frame(self, run, V, Q, steps):
        if not run.stopped and self.session.on_the_way(run, V, Q):
            with self.state:
                self.state.progress = f"optimising, step {steps}" if steps else BEGUN
                self._show()

    def _show(self):
        self._draw()
        self._say()

    def _draw(self):
        """The net in the view, as the session has it; without one, the surface."""
        session, state = self.session, self.state
        if session.V is None:
            self.play.alone()
            return
        shade, state.legend = session.shading()
        self.scene.show(session.V, session.Q, session.choice, state.dark, shade, session.cover)
        self.play.compare()
        self.send()
        if self.fitted is None:
            self.look("fit")
        elif scene.is_lost(session.V, self.fitted):
            self.placed = []
            self.look("refit")

    def _say(self):
        """What there is to say of the net: sentences, numbers and drawings."""
        session, state = self.session, self.state
        state.problem, state.message = session.problem, session.message
        state.can_search = session.can_search
        self._plates()
        self.play.mend()
        if session.V is None:
            return
        state.numbers = plates.numbers(session.report, session.V, session.Q)
        asked = session.shown.theta, session.shown.theta0
        state.histogram_svg = plates.histograms(session.deviations(), asked)
        self.play.shown()

    def send(self):
        """Send the browser what has changed in the scene: the first time all of it."""
        helper = vtk_module.get_helper(self.server)
        if self._whole or not self.server.protocol:
            self._whole = not self.server.protocol
            self.view.update()
        else:  # trame would make and send the whole scene each time, too
            delta = helper.scene(self.scene.plotter.render_window)
            self.server.protocol.publish("trame.vtk.delta", delta)

    def _plates(self):
        choice, state = self.session.choice, self.state
        state.parallelogram_svg = plates.parallelogram(*self.session.angles)
        state.profile_svg = plates.profile(choice.radii)
        angles = [f"{angle:.6g}" for angle in (choice.theta, choice.theta0)]
        state.stem, state.unit = "_".join([self.session.name, *angles]), self.session.unit
        state.trame__title = f"{state.stem.replace('_', ' ')} \u2013 isogonal nets"
        state.code, state.link = self.session.code(), choices.link(choice)
        state.has_one_hole = self.session.has_one_hole
        if self.server.protocol and not self.session.given:
            self.server.js_call("address", "exec", state.link)


def _listed(choice):
    """A choice as the state holds it: lists, no tuples."""
    return {name: list(x) if isinstance(x, tuple) else x for name, x in vars(choice).items()}
