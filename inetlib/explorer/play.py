"""What one does with the net that is shown: touch a face, take a choice back, compare."""

import asyncio
import time
from typing import Any

import numpy as np

from .. import measure
from . import look, plates, probe, remedy, scene
from .choices import NAMES, SHOWN
from .history import History, differing

REST = 0.3  # seconds without a change before others are tried
MARKED = 200  # faces at most


class Play:
    """One tab's hand on its net; app: its `app.App`, which shows what changes."""

    def __init__(self, app: Any):
        self.app, self.history = app, History(app.session.choice)
        self.face = None  # the number of the face that is touched
        self.ghost = None  # V, Q of a net that is kept
        self._trial = self._asked = None  # changes that make a net: looked for, for what values
        off = dict.fromkeys(("can_undo", "can_redo", "marking"), False)
        app.state.update(off | {"drag": 0, "face": {}, "ghost": {}, "remedies": [], "marks": []})
        app.state.change("marking")(lambda **_: self.mark())
        for call in (self.touch, self.undo, self.redo, self.keep, self.forget, self.change):
            app.server.trigger(call.__name__)(call)

    def begin(self):
        """The tab has opened with a choice: there is nothing to take back."""
        self.history = History(self.app.session.choice)
        self._offer()

    def changed(self):
        """The choice is another one."""
        self.history.take(self.app.session.choice, time.monotonic(), self.app.state.drag)
        self._offer()

    def _offer(self):
        past, following = len(self.history.past) > 1, bool(self.history.next)
        self.app.state.update({"can_undo": past, "can_redo": following})

    def undo(self):
        """The choice before the last change."""
        self._go(self.history.undo())

    def redo(self):
        """The choice that was taken back."""
        self._go(self.history.redo())

    def change(self, values: dict):
        """Take values that are offered."""
        before = self.app.session.choice
        self.app.session.change(**values)
        self.changed()
        self.app.follow(differing(before, self.app.session.choice))

    def mend(self):
        """Look for changes that make a net, where there is none or a faulty one, and offer them."""
        session, choice = self.app.session, self.app.session.choice
        faulty = session.run is None and session.is_faulty
        asked = faulty and tuple(vars(choice)[k] for k in NAMES if k not in SHOWN)
        if asked != self._asked:
            self.end()
            self._asked, self.app.state.remedies = asked, []
            if faulty:
                self._trial = asyncio.create_task(self._try(choice))

    def end(self):
        """Try no further changes."""
        if self._trial is not None:
            self._trial.cancel()
        self._trial = self._asked = None

    async def _try(self, choice):
        await asyncio.sleep(REST)
        session, trial = self.app.session, self._trial

        def going():
            return trial is self._trial

        found = await asyncio.to_thread(remedy.remedies, choice, session.surface, going)
        if found and session.V is None:
            session.stand_in(await asyncio.to_thread(session.other, **found[0]))
            self.app.follow(set())
        if going():
            offers = [{"words": remedy.words(values), "values": values} for values in found]
            with self.app.state:
                self.app.state.remedies = offers

    def mark(self):
        """Mark the faces that are flipped or darts, if it is wanted."""
        session, state = self.app.session, self.app.state
        if not state.marking or session.V is None:
            state.marks = []
            return
        quality = measure.quality(session.V, session.Q)
        bad = np.union1d(quality.flipped, quality.nonconvex)[:MARKED]
        corners = session.V[session.Q[bad]] - self.app.scene.origin
        state.marks = corners.round(9).tolist()

    def _go(self, choice):
        names = differing(self.app.session.choice, choice)
        self.app.session.choice = choice
        self.app.follow(names)
        self._offer()

    def keep(self):
        """Keep the net as a ghost beside those that follow."""
        if self.app.session.V is not None:
            self.ghost = self.app.session.V, self.app.session.Q
            self.app.state.ghost = dict(self.app.state.numbers)
            self.app.follow(set())

    def forget(self):
        """Remove the ghost."""
        self.ghost, self.app.state.ghost = None, {}
        self.app.follow(set())

    def compare(self):
        """Put the surface that is covered, and the ghost, into the scene."""
        app, palette = self.app, look.DARK if self.app.state.dark else look.LIGHT
        app.scene.plotter.set_background(palette.background)
        app.scene.behind.show(app.session.beneath, self.ghost, app.scene.origin, palette)

    def alone(self):
        """Where there is no net yet, show the surface."""
        app, surface = self.app, self.app.session.target
        if surface is not None:
            self.compare()
            app.send()
            sight = scene.sight("cover", None)
            app.view.push_camera(app.scene.camera(surface.points, *sight, app.aspect))

    def extent(self):
        """The points that shall be seen: of the net, and of the surface below it."""
        surface, V = self.app.session.beneath, self.app.session.V
        return V if surface is None else np.concatenate([V, surface.points])

    def touch(self, how: str, camera: dict | None = None, x: float = 0, y: float = 0):
        """Show a face: the one "at" x, y of the camera (`probe.seen`), in the "middle" of it, the
        "next" or "previous" one; "none": the whole net again.  Returns whether there is a face."""
        session, before = self.app.session, self.face
        if session.V is None:
            return False
        V = session.V - self.app.scene.origin
        if how == "none":
            self.face = None
        elif how == "at":
            self.face = probe.hit(V, session.Q, camera, x, y)
        elif how == "middle" or before is None:
            self.face = probe.middle(V, session.Q, camera)
        else:
            self.face = (before + (1 if how == "next" else -1)) % len(session.Q)
        if self.face != before:
            self.show()
            if self.face is None:
                self.app.state.parallelogram_svg = plates.parallelogram(*self.app.session.angles)
        return self.face is not None

    def show(self):
        """Say what there is to say of the face that is touched."""
        session, state = self.app.session, self.app.state
        if self.face is None or session.V is None or self.face >= len(session.Q):
            self.face, state.face = None, {}
            return
        shown = session.shown
        corners = session.V[session.Q[self.face]]
        state.face = probe.about(session.V, session.Q, self.face, (shown.theta, shown.theta0))
        state.face |= {"quad": (corners - self.app.scene.origin).round(9).tolist()}
        state.parallelogram_svg = plates.face(corners)

    def shown(self):
        """The net in the view is another one: so are its face and its marks."""
        self.show()
        self.mark()
