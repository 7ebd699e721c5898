"""One explorer without a page: a choice, its net, what there is to say and to save."""

import tempfile
from contextlib import suppress
from math import radians
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from .. import io, measure, mesh, plot
from ..design import STAGES, report
from . import behind, choices, look, nets, remedy

SAVED = (".svg", ".png", *io.WRITERS)  # what `save` writes


NET = "V", "Q", "cover", "shown", "_words", "_report"  # what belongs to the net that is shown


class Session:
    """A `choices.Choice` and the net that belongs to it.

    surface, path: `io.Surface` of the file on the command line and its name; net: V, Q of a net
    that is given and not made here, and its further faces, if any.  V, Q, report, message: the
    net that is shown, of the choice `shown`; cover: its `design.Cover` where it has cut panels,
    or None; problem: why there is no net of the choice, or ""; run: the search under way."""

    def __init__(self, surface=None, path=None, net=None):
        self.surface, self.path, self.given = surface, path, net is not None
        self.choice = self.shown = choices.Choice()
        self.V = self.Q = self.cover = self.run = self._report = None
        self._words = self.problem = ""
        self.steps = 0
        self._targets = {}  # surfaces by name: what is shown of them
        if surface is not None:
            self.change(kind="cover", source="file")
        if self.given:
            V, Q = mesh.check_arrays(*net[:2])
            cover = look.with_panels(V, Q, *net[2:]) if net[2:] else None
            theta, theta0 = np.degrees([x.mean() for x in measure.angles(V, Q)])
            self.change(theta=theta, theta0=theta0, parallelograms=False)
            name = Path(path).name if path else "a net from Python"
            words = f"{name}; deviations are from its mean angles"

            def make():
                measure.quality(V, Q)  # refuses faces that are not oriented alike
                return V, Q, words, cover

            self.take(None, _made(make))
            if self.problem:
                raise ValueError(self.problem)

    def change(self, **values):
        """Take new values; the sentences on those that are refused."""
        self.choice, problems = choices.changed(self.choice, **values)
        return problems

    @property
    def name(self):
        """What the net is called: a name for files, without angles."""
        given = self.given or (self.choice.kind, self.choice.source) == ("cover", "file")
        return (
            (Path(self.path).stem if self.path else "net") if given else choices.name(self.choice)
        )

    @property
    def unit(self):
        """What lengths are measured in, a sentence."""
        of_file = self.given or (self.choice.kind, self.choice.source) == ("cover", "file")
        if of_file and self.path:
            return f"Lengths are in the unit of {Path(self.path).name}."
        return "Lengths have no unit."

    @property
    def report(self):
        """The `Report` of the net that is shown, made when it is asked for; None without a net."""
        if self._report is None and self.V is not None:
            theta, theta0 = np.radians([self.shown.theta, self.shown.theta0])
            self._report = report.report(self.V, self.Q, theta=theta, theta0=theta0)
        return self._report

    @property
    def message(self):
        """How the net that is shown was found, and whether it has faults, a sentence."""
        if self.V is None or (self.shown.kind in nets.FOUND and not self.given):
            return self._words
        faults, quads = self.report.flips + self.report.darts, len(self.Q)
        many = f"; but {faults} of {quads} faces are flipped or not convex"
        return self._words + many * (faults > 0)

    @property
    def must_search(self):
        """Whether the net of the choice is found by optimisation."""
        return self.choice.kind in nets.FOUND and not self.given

    @property
    def can_search(self):
        """Whether a search can be run again: not where one has found that there is no net."""
        return self.must_search and (not self.problem or "stopped" in self.problem)

    @property
    def is_faulty(self):
        """Whether there is no net of the choice, or one that is not as it was asked for."""
        stopped = self.run is not None or self.given or "stopped" in self.message
        good = self.report is None or remedy.is_good(self.report, self.shown.kind)
        if self.problem:
            return "stopped" not in self.problem
        return not (stopped or good)

    @property
    def has_one_hole(self):
        """Whether the surface of the choice may be a ring or have an opening, once it is known."""
        return nets.has_one_hole(self.choice, self.surface)

    def construct(self):
        """Make the net of the choice, where no optimisation is needed."""
        self.stop()
        self.run = None
        if not self.given:
            self.take(None, _made(nets.make, self.choice))

    def take(self, run, made, then=None):
        """Show what was found in a run, or say why there is no net; False for a run that is over.

        then: the run under way after it."""
        if run is not self.run:
            return False
        self.run, (net, self.problem) = then, made
        if net is not None:
            self.V, self.Q, self._words, cover = net
            self.shown = run.choice if run else self.choice
            self.cover = cover if cover and cover.polygons else None
            self._report = cover and cover.report
        return True

    def begin(self):
        """A new run, for `search`: its choice, and whether it shall stop, as an older one must."""
        self.stop()
        self.run, self.steps = SimpleNamespace(choice=self.choice, stopped=False, stage=None), 0
        return self.run

    def stop(self):
        """Ask the search under way to stop; the best net it has is taken."""
        if self.run is not None:
            self.run.stopped = True

    def search(self, run, seen=None, told=None):
        """Find the net of a run by optimisation, as `find`, and show it."""
        return self.take(run, self.find(run, seen, told))

    def find(self, run, seen=None, told=None):
        """What the optimisation of a run finds, for `take`; nothing is shown, so that a thread of
        its own may do it.

        seen(V, Q, steps) sees the start and each step, told(words) hears of the stages before."""

        def stage(name):
            if run is not self.run or run.stopped:
                return False
            if told is not None and name != run.stage:
                told(STAGES[name])
            run.stage = name
            return True

        def after(step, V, Q):
            if run is not self.run or run.stopped:
                return False
            self.steps += step is not None
            if seen is not None:
                seen(V, Q, self.steps)
            return not run.stopped

        self._see(run.choice)
        return _made(nets.make, run.choice, self.surface, after, stage)

    def other(self, **values):
        """The session of another choice and its net, without progress."""
        other = Session(self.surface, self.path)
        other.choice, _ = choices.changed(self.choice, **values)
        other.take(None, _made(nets.make, other.choice, self.surface))
        return other

    def stand_in(self, other):
        """Where there is no net yet, show that of another session; the problem stays."""
        if self.V is None:
            vars(self).update({name: vars(other)[name] for name in NET})

    def on_the_way(self, run, V, Q):
        """Show a net that a run has on its way; False when the run is over."""
        return self.take(run, _made(lambda: (V, Q, f"step {self.steps}", None)), run)

    @property
    def target(self):
        """The surface that the choice covers, as `behind.few` has it; None before a search."""
        return self._targets.get(self.choice.kind == "cover" and self.choice.source)

    @property
    def beneath(self):
        """The `target` where it is shown, and the net is on it; else None."""
        one, two = ((x.kind, x.source) for x in (self.choice, self.shown))
        old = self.V is not None and one != two  # the net before, on something else
        return self.target if self.choice.target and not old else None

    def _see(self, choice):
        if choice.kind == "cover" and choice.source not in self._targets:
            with suppress(ValueError):  # the search says what is wrong
                surface = nets.target(choice, self.surface)
                self._targets[choice.source] = surface and behind.few(*surface)

    @property
    def angles(self):
        """theta and theta0 of the choice, radians."""
        return radians(self.choice.theta), radians(self.choice.theta0)

    def deviations(self):
        """theta and theta0 of every face less those asked for, degrees, (2, f)."""
        asked = np.array([[self.shown.theta], [self.shown.theta0]])
        return np.degrees(measure.angles(self.V, self.Q)) - asked

    def shading(self):
        """RGB bytes a face (f, 3), or None, and the legend: `look.shading` as chosen."""
        return look.shading(self.choice.shade, self.V, self.Q, self.deviations)

    def code(self):
        """Three lines of Python that make the net of the choice: V, Q."""
        if self.given and self.path:
            return f"from inetlib import io\n\nV, Q, others = io.net({str(self.path)!r})"
        if self.given:
            return "# this net came from Python: V, Q"
        return nets.code(self.choice, self.path or "surface.obj")

    def save(self, suffix, azimuth=-np.pi / 2, elevation=np.pi / 2, ghost=None):
        """The net as the bytes of a file: `.svg` or `.png`, a picture, else a mesh of `io`.

        azimuth, elevation: of the viewer, radians; ghost: V, Q of another net that is shown, or
        None: for pictures.  ValueError for other suffixes and where there is no net."""
        if suffix not in SAVED:
            raise ValueError(f"{suffix}: one of {' '.join(SAVED)} is wanted")
        if self.V is None:
            raise ValueError("there is no net to save")
        if suffix in (".svg", ".png"):
            fill, camera, below = self.shading()[0], plot.camera(azimuth, elevation), self.beneath
            more = self.cover, below and (below.points, below.regular_faces), ghost
            return look.picture(self.V, self.Q, self.choice, fill, camera, suffix[1:], *more)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"net{suffix}"
            polygons, edges = (self.cover.polygons, self.cover.edges) if self.cover else ((), None)
            has_curves = suffix in io.WITH_CURVES and mesh.is_labelled(self.Q)
            curves = mesh.polylines(self.Q, edges) if has_curves else None
            io.write(path, self.V, self.Q, curves, polygons)
            return path.read_bytes()


def _made(make, *args):
    """What make(*args) returns, as of `nets.make`, and "", or None and why there is no net."""
    try:
        V, Q, words, cover = make(*args)
        measure.planarity(V, Q)  # refuses faces that have collapsed
    except (ValueError, ArithmeticError, MemoryError) as error:
        return None, f"no net: {error or type(error).__name__}"
    return (V, Q, words, cover), ""
