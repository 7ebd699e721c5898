"""The nets of the explorer: for each kind three lines of Python, run and printed alike."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from math import cos, radians
from typing import NamedTuple

import numpy as np

from .. import design, examples, parallelogram
from .choices import HEIGHTS, Choice

FOUND = "freeform", "cover"  # by optimisation; all others are constructed
DISKS = {  # centre and radius of the disk that the grid fills, if it is not the unit disk
    "square": (1.2 + 0.5j, 1.0),
    "inverse": (1.5, 1.0),
    "exp": (0, 1.5),
    "minimal": (0, 2.6),
    "sphere": (0, 2.4),
}
IN_DEGREES = "theta", "theta0", "bend", "direction"  # the angles of a choice
SLIVER = 5.0  # degrees from 0 and 180: at smaller angles no panels are cut
PATIENCE = 0.05  # seconds between two questions whether to go on waiting for a surface
_makers = ThreadPoolExecutor(2, "surfaces")
_grounds: dict[tuple, tuple] = {}  # {(what surface, whether filled): (it, its `Future`)}


class Recipe(NamedTuple):
    """Three lines of Python with {names} in the place of values, and a sentence on the net.

    Some `rooms` are imported, `start` is done, `net` makes the net, `take` finds V and Q in it."""

    rooms: str
    start: str
    net: str
    message: str
    take: str = "V, Q = {net}"


WHOLE = "; whole quads only: at such angles panels at the edge would be slivers"
SAMPLED = "sampled from a smooth net: faces of half the size are off by a quarter as much"
GRID = "z = conformal.sheared_grid({theta}, {theta0}, {m}, {n}, {origin}, {edge})"
ROLLED = "z = developable.rolled_grid({theta}, {theta0}, {m}, {n}, {curvature}, {origin}, {edge})"
MAPS = {
    "identity": "z",
    "square": "z**2",
    "inverse": "1 / z",
    "exp": "np.exp(z)",
    "moebius": "conformal.moebius([[0, 1], [1, {pole}]], z)",
}
POINTS = {
    "minimal": "surfaces.conjugate({bend}).point(z.real, z.imag)",
    "sphere": "surfaces.SPHERE.point(z.real, z.imag)",
    "rolled": "developable.roll(z, {curvature})",
}
RECIPES = {
    "revolution": Recipe(
        "loxodrome, surfaces",
        "profile = surfaces.spline_profile({points})",
        "loxodrome.web(profile, {theta}, {theta0}, {m}, {n})",
        "exact: {0.message}",
        "V, Q = {net}[:2]",
    ),
    "freeform": Recipe(
        "reference, solver, surfaces",
        "V, Q = surfaces.freeform_patch({m}, {n})",
        "solver.optimize(V, Q, {theta}, {theta0}, reference=reference.mesh(V, Q){callback})",
        "{0.message}",
        "V = {net}.V",
    ),
    "cover": Recipe(
        "design, io",
        "surface = io.surface({path})",
        "design.cover(*surface[:2], {theta}, {theta0}, "
        "count={quads}, direction={direction}{callback})",
        "{0.report.message}",
        "V, Q = {net}[:2]",
    ),
}


def _recipe(choice):
    if choice.kind == "plane":
        return _plane(choice.map)
    if choice.kind == "isothermal":
        return _isothermal(choice.surface, choice.moebius)
    recipe = RECIPES[choice.kind]
    if choice.kind == "cover" and choice.source != "file":
        example = f"surface = examples.{examples.SURFACES[choice.source].__name__}()"
        recipe = recipe._replace(rooms="design, examples", start=example)
    if choice.kind == "cover":
        more = ', openings="fill"' * (choice.openings == "fill") + ", trim=True" * trims(choice)
        take = "V, Q, _, polygons = {net}[:4]" if trims(choice) else recipe.take
        words = recipe.message + WHOLE * (choice.trim and not trims(choice))
        net = recipe.net.replace("{callback}", more + "{callback}")
        recipe = recipe._replace(net=net, take=take, message=words)
    return recipe


def trims(choice: Choice) -> bool:
    """Whether panels fill the edge of a cover, as they shall where they are no slivers."""
    return choice.trim and all(SLIVER <= x <= 180 - SLIVER for x in (choice.theta, choice.theta0))


def _plane(name):
    start, message = GRID, "exact: with this map faces of any size have both angles"
    if name == "exp":
        start = GRID.replace("{edge}", "{edge}, kappa=1")
    if name in ("inverse", "moebius"):
        message = SAMPLED
    return Recipe("conformal", start, f"conformal.quads({MAPS[name]})", message)


def _isothermal(name, inverted):
    rooms, start, points = "mesh, conformal, surfaces", GRID, POINTS[name]
    message = SAMPLED
    if name == "rolled":
        rooms, start = "mesh, developable", ROLLED
        message = "exact: both angles hold on the bent sheet"
    if inverted:
        rooms += ", moebius"
        points = "moebius.apply(moebius.inversion(({px}, {py}, {pz})), " + points + ")"
        message = SAMPLED + "; then inverted in a sphere around the pole"
    return Recipe(rooms, start, points + ".reshape(-1, 3), mesh.grid_quads({m}, {n})", message)


def ground(choice: Choice, surface=None) -> Future:
    """The `design.Ground` of the surface of a cover, made once for all tabs; as of `make`.

    A thread of its own makes it: nobody who waits has to, and nobody who stops wastes it."""
    filled = choice.openings == "fill"
    key = id(surface) if choice.source == "file" else choice.source, filled
    if key not in _grounds:
        V, F = (surface if choice.source == "file" else examples.SURFACES[choice.source]())[:2]
        made = _makers.submit(design.ready, V, F, "fill" if filled else None)
        _grounds.setdefault(key, (surface, made))  # kept, so that no other has its id
    return _grounds[key][1]


def _known(choice, surface, stage):
    """The `Ground`, when it is there."""
    future = ground(choice, surface)
    while not future.done():
        if stage("flatten") is False:
            raise design.Stopped("stopped while the surface was flattened: run again")
        with suppress(TimeoutError):
            future.exception(PATIENCE)
    return future.result()


def make(
    choice: Choice,
    surface=None,
    callback: Callable = lambda *_: None,
    stage: Callable = lambda _: None,
) -> tuple:
    """V (n, 3), Q (f, 4) of a choice, a sentence on the net, and its `design.Cover`, or None where
    it covers no surface; ValueError where there is none.

    surface: `io.Surface` of the file; callback(step, V, Q) sees the start of an optimisation
    (step None) and every step, stage(name) those of `design.cover`; they may return False to end
    it."""
    recipe, values = _recipe(choice), _values(choice)
    names = {k: np.radians(x) if k in IN_DEGREES else x for k, x in values.items()}
    names |= {"np": np, "callback": callback, "surface": (None, None), "stage": stage}
    # What runs is the recipe's own text with these names: no value becomes a part of it.
    words = {name: name for name in values} | {"callback": ", callback=callback", "net": "net"}
    exec(f"from inetlib import {recipe.rooms}", names)
    if choice.kind != "cover":
        exec(recipe.start.format_map(words), names)
    elif choice.source == "file" and surface is None:
        raise ValueError("no file was named on the command line: choose one of the examples")
    else:
        names["known"] = _known(choice, surface, stage)
        words["callback"] += ", stage=stage, known=known"
    if choice.kind == "freeform":
        V, Q = names["V"], names["Q"]
        if callback(None, V, Q) is False:
            return V, Q, "stopped before the first step", None
        names["callback"] = lambda step, V: callback(step, V, Q)
    net = names["net"] = eval(recipe.net.format_map(words), names)
    exec(recipe.take.format_map(words), names)
    covers = choice.kind == "cover"
    more = (*net.report.notes, *net.report.repairs) if covers else ()
    words = "; ".join([recipe.message.format(net), *more])
    return names["V"], names["Q"], words, net if covers else None


def target(choice: Choice, surface=None) -> tuple | None:
    """V, F of the surface that a cover covers, None where there is none; surface: of `make`."""
    if choice.source == "file":
        return surface and surface[:2]
    return examples.SURFACES[choice.source]()[:2]


def has_one_hole(choice: Choice, surface=None) -> bool:
    """Whether the surface of a cover has one hole, and its net can be a ring: where it is known,
    as it is when its net was searched for; as of `make`."""
    if choice.kind != "cover" or (choice.source == "file" and surface is None):
        return False
    found = ground(choice, surface)
    return found.done() and not found.exception() and len(found.result().surface.loops) == 2


def code(choice: Choice, path: object = "surface.obj") -> str:
    """Three lines of Python that make the net, V and Q; path: of the surface's file."""
    recipe = _recipe(choice)
    words = {name: _said(name, x) for name, x in _values(choice, path).items()} | {"callback": ""}
    words["net"] = recipe.net.format_map(words)
    lines = recipe.start.format_map(words), recipe.take.format_map(words)
    return "\n".join([f"import numpy as np; from inetlib import {recipe.rooms}", *lines])


def _said(name, value):
    return f"np.radians({repr(value).removesuffix('.0')})" if name in IN_DEGREES else repr(value)


def _values(choice, path=None):
    """What a recipe may name: the choice, and what follows from it."""
    values = vars(choice) | {
        "pole": -complex(choice.px, choice.py),
        "points": list(zip(choice.radii, HEIGHTS, strict=True)),
        "path": str(path),
    }
    name = {"plane": choice.map, "isothermal": choice.surface}.get(choice.kind)
    return values | (_grid(choice, *DISKS.get(name, (0, 1.0))) if name else {})


def _grid(choice, centre, radius):
    """A grid that fills a disk, and the curvature that bends it as chosen, in short numbers."""
    angles = radians(choice.theta), radians(choice.theta0)
    lam, mu = parallelogram.ratios(*angles)
    along, across = choice.m, choice.n * parallelogram.rho(lam, mu)
    edge = _rounded(2 * radius / max(abs(along + across), abs(along - across)), 5)
    corner = centre - complex(edge * (along + across) / 2)
    width = edge * (choice.m + choice.n * abs(cos(angles[1])) / mu)
    return {
        "origin": complex(_rounded(corner.real), _rounded(corner.imag)),
        "edge": edge,
        "curvature": _rounded(radians(choice.bend) / width),
    }


def _rounded(number, digits=6):
    return float(f"{number:.{digits}g}")
