"""One explorer without a page: a choice, its net, what there is to say and to save."""

import importlib.util
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .. import io, measure, mesh, parallelogram, plot
from . import choices, look, nets

SAVED = (".svg", ".png", *io.WRITERS)  # what `save` writes


class Numbers(NamedTuple):
    """What the page says of a net; angles in degrees, `off` from the angles asked for."""

    quads: int
    lam: float
    mu: float
    mean_theta: float
    mean_theta0: float
    theta_off: float
    theta0_off: float
    flips: int
    size_low: float
    size_high: float


class Run:
    """One search: the choice it is for, and whether somebody has asked it to stop."""

    def __init__(self, choice):
        self.choice, self.stopped = choice, False


class Session:
    """A `choices.Choice` and the net that belongs to it.

    surface: `io.Surface` of the file on the command line, path its name, or None; net: V, Q of
    a net that is given and not made here.

    V, Q       the net that is shown, `shown` the choice it belongs to
    message    a sentence on it; problem: why there is no net of the choice, or ""
    run        the search under way, or None; steps: how many it has made
    """

    def __init__(self, surface=None, path=None, net=None):
        self.surface, self.path, self.given = surface, path, net is not None
        start = {"kind": "cover", "source": "file"} if surface is not None else {}
        self.choice = self.shown = choices.changed(choices.Choice(), **start)[0]
        self.V = self.Q = self.run = None
        self.message, self.problem, self.steps = "", "", 0
        if self.given:
            V, Q = mesh.check_arrays(*net)
            theta, theta0 = (float(np.degrees(x.mean())) for x in measure.angles(V, Q))
            self.choice = choices.changed(self.choice, theta=theta, theta0=theta0)[0]
            words = "a net from Python; deviations are from its mean angles"
            self._settle(self.choice, nets.Made(V, Q, words), "")

    # --- choosing and making --------------------------------------------------------------

    def change(self, **values):
        """Take new values; the sentences on those that are refused."""
        self.choice, problems = choices.changed(self.choice, **values)
        return problems

    @property
    def must_search(self):
        """Whether the net of the choice is found by optimisation."""
        return self.choice.kind in nets.FOUND and not self.given

    def construct(self):
        """Make the net of the choice, where no optimisation is needed."""
        self.stop()
        self.run = None
        if not self.given:
            self._settle(self.choice, *_try(lambda: nets.make(self.choice)))

    def _settle(self, choice, made, problem):
        self.problem = problem
        if made is not None:
            self.V, self.Q, self.message = made
            self.shown = choice

    def begin(self):
        """The `Run` of a new search, for `search`; an older one is asked to stop."""
        self.stop()
        self.run, self.steps = Run(self.choice), 0
        return self.run

    def stop(self):
        """Ask the search under way to stop; the best net it has is taken."""
        if self.run is not None:
            self.run.stopped = True

    def search(self, run, seen=None):
        """Find the net of a run by optimisation; seen(V, Q, steps) sees the start and every step.

        What a run finds after a newer one has begun is forgotten.
        """

        def after(step, V, Q):
            if run is not self.run or run.stopped:
                return False
            self.steps += step is not None
            if seen is not None:
                seen(V, Q, self.steps)
            return not run.stopped

        found = _try(lambda: nets.make(run.choice, self.surface, after))
        if run is self.run:
            self._settle(run.choice, *found)
            self.run = None

    def on_the_way(self, run, V, Q):
        """Show a net that a run has on its way; False when the run is over."""
        if run is self.run:
            self._settle(run.choice, nets.Made(V, Q, f"step {self.steps}"), "")
        return run is self.run

    # --- saying ---------------------------------------------------------------------------

    def numbers(self):
        """`Numbers` of the net that is shown, None where there is none."""
        if self.V is None:
            return None
        off = self.deviations()
        lam, mu = parallelogram.ratios(*np.radians([self.shown.theta, self.shown.theta0]))
        means = [float(np.degrees(x.mean())) for x in measure.angles(self.V, self.Q)]
        _, _, one, two = measure.vectors(self.V, self.Q)
        edges = np.linalg.norm(np.stack([one, two]), axis=2)
        flips = len(measure.flipped(self.V, self.Q))
        sizes = float(edges.min()), float(edges.max())
        most = [float(np.abs(x).max()) for x in off]
        return Numbers(len(self.Q), float(lam), float(mu), *means, *most, flips, *sizes)

    def deviations(self):
        """theta and theta0 of every face less those asked for, degrees, each (f,)."""
        wanted = self.shown.theta, self.shown.theta0
        found = measure.angles(self.V, self.Q)
        return [np.degrees(x) - a for x, a in zip(found, wanted, strict=True)]

    def colours(self):
        """One RGB colour a face, by the larger deviation of its two angles; bytes (f, 3)."""
        return look.shades(np.abs(self.deviations()).max(axis=0))

    def code(self):
        """Three lines of Python that make the net of the choice: V, Q."""
        if self.given:
            return "# this net came from Python: V, Q"
        return nets.code(self.choice, self.path or "surface.obj")

    def link(self):
        """The choice as URL parameters."""
        return choices.link(self.choice)

    # --- saving ---------------------------------------------------------------------------

    def save(self, suffix, azimuth=-np.pi / 2, elevation=np.pi / 2):
        """The net as the bytes of a file: `.svg` or `.png`, a picture, else a mesh of `io`.

        azimuth, elevation: of the viewer, radians, for pictures.  Nothing stays on the disk.
        ValueError for other suffixes and where there is no net.
        """
        if suffix not in SAVED:
            raise ValueError(f"{suffix}: one of {' '.join(SAVED)} is wanted")
        if self.V is None:
            raise ValueError("there is no net to save")
        if suffix in (".svg", ".png"):
            fill = self.colours() if self.choice.shade else None
            form, camera = suffix[1:], plot.camera(azimuth, elevation)
            return look.picture(self.V, self.Q, self.choice, fill, camera, form)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"net{suffix}"
            curves = "all" if suffix in io.WITH_CURVES else None
            io.write(path, self.V, self.Q, curves)
            return path.read_bytes()


def _try(make):
    """(what it made, "") or (None, why there is nothing); collapsed faces are no net."""
    try:
        made = make()
        measure.angles(made.V, made.Q), measure.quality(made.V, made.Q)
        return made, ""
    except (ValueError, ArithmeticError, MemoryError) as error:
        return None, f"no net: {error or type(error).__name__}"


def missing(suffix):
    """The package that a file with this suffix needs and that is not installed, or ""."""
    package = io.PACKAGES.get(suffix, "")
    return package if package and importlib.util.find_spec(package) is None else ""
