"""Where there is no net: which changes of the choice make one.  All are tried, none is guessed."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..design import report
from ..design.report import Report
from . import choices, nets
from .choices import Choice

SECONDS = 2.0  # for all trials
HALVINGS = 5  # of the way to right angles
MOST = 4  # changes that are offered
LARGE = 20_000  # triangles: to fill or open the hole of such a surface takes too long
CLOSE = np.radians(1e-6)  # of an angle: what an optimisation must reach
TIMES = {
    "m": (1.5, 2, 3, 5, 7, 0.5),
    "n": (0.5, 0.25),
    "quads": (2, 4, 0.5),
    "bend": (0.5, 0.25, 0),
}
NAMES = {
    "theta": "\u03b8",
    "theta0": "\u03b8\u2080",
    "bend": "bending",
    "moebius": "M\u00f6bius image",
    "trim": "panels to the edge",
}
NAMES |= choices.WORDS | {"source": "surface", "openings": "hole"}


def is_good(about: Report, kind: str) -> bool:
    """Whether a net has no flips and no darts, and the angles that an optimisation was to reach."""
    exact = kind not in nets.FOUND or about.max_deviation < CLOSE
    return exact and about.flips == about.darts == 0


def remedies(choice: Choice, surface: Any = None, going: Callable = lambda: True) -> list[dict]:
    """Changes {name: value} of a choice, at most 4, each of which makes a good net.

    surface: as of `nets.make`; going(): whether to go on, for `SECONDS` at most, and as long once
    more where nothing was found."""
    if (choice.kind, choice.source) != ("cover", "file"):
        surface = None
    end = time.monotonic() + SECONDS
    ways, found = list(_ways(choice, surface)), list[dict]()
    for k, way in enumerate(ways):
        now = time.monotonic()
        until = now + (end - now) / min(2, len(ways) - k)

        def works(values, until=until):
            return _works(choice, values, surface, lambda: going() and time.monotonic() < until)

        if len(found) < MOST and (values := way(works)):
            change = {k: x for k, x in values.items() if x != getattr(choice, k)}
            found += [change] if change not in found else []
    plain = {"theta": 90.0, "theta0": 90.0}  # where one change is not enough
    plain |= {name: getattr(Choice(), name) for name in TIMES if name in choices.USES[choice.kind]}
    end += SECONDS
    if not found and _works(choice, plain, surface, lambda: going() and time.monotonic() < end):
        return [{k: x for k, x in plain.items() if x != getattr(choice, k)}]
    return found


def _works(choice, values, surface, going):
    new, problems = choices.changed(choice, **values)
    if problems or new == choice or not going():
        return False
    try:
        V, Q, _, cover = nets.make(new, surface, lambda *_: going(), lambda _: going())
        theta, theta0 = np.radians([new.theta, new.theta0])
        about = cover.report if cover else report.report(V, Q, theta=theta, theta0=theta0)
        return is_good(about, new.kind)
    except (ValueError, ArithmeticError, MemoryError):
        return False


def _ways(choice, surface) -> Iterator[Callable]:
    """Functions of works(values) -> bool: the least of some changes that works, or None."""
    if choice.kind == "cover" and choice.source == "file" and surface is None:
        yield lambda works: next(filter(works, [{"source": "roof"}]), None)
        return
    if choice.kind == "cover" and nets.trims(choice):
        yield lambda works: next(filter(works, [{"trim": False}]), None)
    angles = (
        [("theta", "theta0")] if choice.lock else [("theta", "theta0"), ("theta",), ("theta0",)]
    )
    for names in angles:
        yield lambda works, names=names: _nearest(choice, names, works)
    used = choices.USES[choice.kind]
    rungs: list[list[dict]] = []
    for name in (name for name in TIMES if name in used):
        number = float if name == "bend" else round
        rungs.append([{name: number(x * getattr(choice, name))} for x in TIMES[name]])
    if choice.moebius and "moebius" in used:
        rungs.append([{"moebius": False}])
    if (choice.kind, choice.map) == ("plane", "moebius"):
        length = np.hypot(choice.px, choice.py) or 1.0
        away = choice.px / length or -1.0, choice.py / length
        rungs.append(
            [{"px": round(r * away[0], 2), "py": round(r * away[1], 2)} for r in (1.2, 1.5, 2, 3)]
        )
    if choice.kind == "cover" and (surface is None or len(surface[1]) < LARGE):
        rungs.append([{"openings": "ring" if choice.openings == "fill" else "fill"}])
    for some in rungs:
        yield lambda works, some=some: next(filter(works, some), None)


def _nearest(choice, names, works):
    """The angles nearest to those of the choice, on the way to right angles, for which it works."""

    def at(part):
        turned = {name: getattr(choice, name) for name in names}
        return {name: float(round(x + part * (90 - x))) for name, x in turned.items()}

    if not works(at(1)):
        return None
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if works(at(middle)) else (middle, high)
    return at(high)


def words(values: dict) -> str:
    """A change as a button says it."""
    return ", ".join(f"{NAMES.get(name, name)} = {_said(name, x)}" for name, x in values.items())


def _said(name, value):
    if name in choices.OPTIONS:
        return choices.OPTIONS[name][value]
    if isinstance(value, bool):
        return "on" if value else "off"
    allowed = choices.ALLOWED[name]
    return f"{value:g}{allowed.unit}".replace("-", "\u2212")
