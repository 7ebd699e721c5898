"""figNN.draw draws Fig. NN, the other modules what the paper does not have."""

import functools
import inspect
import json
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .. import measure


class Drawing(NamedTuple):
    """A finished figure and what stands behind it."""

    name: str  # of its files
    figure: Figure
    function: str  # that drew it, as a dotted name
    parameters: dict  # {name: number}, what the function was called with
    data: dict  # {name: array}, the geometry drawn
    nets: list  # (V, Q, theta, theta0) of each net shown, its angles in radians
    claims: dict  # {name: number or text}, what the figure states
    words: str = ""  # what it shows, for readers who do not see it


def deviations(nets) -> np.ndarray:
    """Largest deviations of theta and theta0 of (V, Q, theta, theta0) tuples, radians; or nan."""
    found = [measure.deviations(*net).max(axis=1) for net in nets]
    return np.max(found, axis=0) if nets else np.full(2, np.nan)


def darts(nets) -> int:
    """How many faces of (V, Q, ...) tuples are darts."""
    return sum(len(measure.nonconvex(V, Q)) for V, Q, *_ in nets)


def rounded(value):
    """What JSON makes of dicts, lists, numbers and words, floats rounded to 1e-9."""
    text = json.dumps(value, allow_nan=False)
    return json.loads(text, parse_float=lambda digits: round(float(digits), 9) + 0.0)


def drawn(*degrees):
    """A decorator for `draw` of a module: what it returns, (figure, data, nets, claims), as a
    `Drawing` of the module's name, with those arguments of the call that are numbers, the first
    paragraph of its docstring as its words, and one claim more, the darts in its nets.

    degrees: names of angles that are radians in the call, and noted in degrees."""

    def decorate(draw):
        signature, module = inspect.signature(draw), draw.__module__

        @functools.wraps(draw)
        def whole(*args, **named):
            figure, data, nets, claims = draw(*args, **named)
            given = signature.bind(*args, **named)
            given.apply_defaults()
            noted = {name: _noted(x, name in degrees) for name, x in given.arguments.items()}
            noted = {name: x for name, x in noted.items() if x is not None}
            name, function = module.rpartition(".")[2], f"{module}.{draw.__name__}"
            claims = rounded(claims | ({"darts": darts(nets)} if nets else {}))
            words = " ".join((inspect.getdoc(draw) or "").partition("\n\n")[0].split())
            return Drawing(name, figure, function, noted, data, nets, claims, words)

        return whole

    return decorate


def _noted(value, in_degrees=False):
    """A number or list of numbers for the manifest; None for what is none."""
    if in_degrees:
        angle = round(float(np.degrees(value)), 9)
        return int(angle) if angle.is_integer() else angle
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, (tuple, list, np.ndarray)) and not hasattr(value, "_fields"):
        return [_noted(x) for x in value]
    return value if np.isscalar(value) else None


def sampled(name, V, Q, angles):
    """Claims on a net that is not exact: the larger deviation from its two angles, and darts.

    angles: radians; the deviation over all faces is in degrees, with 6 decimals."""
    off = round(float(np.degrees(deviations([(V, Q, *angles)]).max())), 6)
    return {f"{name}_max_deviation_deg": off, f"{name}_darts": darts([(V, Q)])}
