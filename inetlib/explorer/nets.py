"""The nets of the explorer: constructed ones, those found by optimisation, and their code."""

import cmath
from math import radians
from typing import NamedTuple

import numpy as np

from .. import (
    conformal,
    design,
    developable,
    examples,
    loxodrome,
    mesh,
    moebius,
    parallelogram,
    reference,
    solver,
    surfaces,
)
from .choices import HEIGHTS

FOUND = "freeform", "cover"  # by optimisation; all others are constructed
DISKS = {  # centre and radius of the disk that the grid fills, in the plane of the parameters
    "identity": (0j, 1.0),
    "square": (1.2 + 0.5j, 1.0),
    "inverse": (1.5 + 0j, 1.0),
    "exp": (0j, 1.5),
    "moebius": (0j, 1.0),
    "minimal": (0j, 2.6),
    "sphere": (0j, 2.4),
    "rolled": (0j, 1.0),
}
KAPPA = {"exp": 1}
EXAMPLES = {
    "roof": "wavy_roof",
    "saddle": "saddle_with_hole",
    "shell": "hanging_shell",
}


class Made(NamedTuple):
    """A net: V (n, 3), Q (f, 4), and a sentence on it."""

    V: np.ndarray
    Q: np.ndarray
    message: str


def construct(choice):
    """The net of a choice that needs no optimisation; ValueError where there is none."""
    makers = {"plane": _plane, "isothermal": _isothermal, "revolution": _revolution}
    return makers[choice.kind](choice)


def find(choice, surface=None, callback=None):
    """The net of a choice that needs an optimisation; callback(step, V, Q) may return False.

    surface: `io.Surface`, that of the file.  The callback's first step is None: the start.
    """
    angles = radians(choice.theta), radians(choice.theta0)
    if choice.kind == "freeform":
        V, Q = surfaces.freeform_patch(choice.m, choice.n)
        if callback is not None and callback(None, V, Q) is False:
            return Made(V, Q, "stopped before the first step")
        near = reference.mesh(V, Q)
        after = None if callback is None else lambda step, V: callback(step, V, Q)
        found = solver.optimize(V, Q, *angles, reference=near, callback=after)
        return Made(found.V, Q, found.message)
    V, F = _surface(choice, surface)
    options = {"count": choice.quads, "direction": radians(choice.direction)}
    found = design.cover(V, F, *angles, **options, callback=callback)
    return Made(found.V, found.Q, "; ".join([found.report.message, *found.report.repairs]))


def _surface(choice, surface):
    if choice.source != "file":
        return getattr(examples, EXAMPLES[choice.source])()
    if surface is None:
        raise ValueError("no file was named on the command line: choose one of the examples")
    return surface.V, surface.F


# --- constructions --------------------------------------------------------------------------


def grid(choice, name):
    """(origin, edge) of the sheared grid that fills the disk of a map or surface.

    Both are rounded, so that the code is short and makes the same net.
    """
    centre, radius = DISKS[name]
    lam, mu = parallelogram.ratios(radians(choice.theta), radians(choice.theta0))
    along, across = choice.m, choice.n * parallelogram.rho(lam, mu)
    edge = _digits(2 * radius / max(abs(along + across), abs(along - across)), 5)
    middle = complex(edge * (along + across) / 2)
    return complex(_digits(centre.real - middle.real), _digits(centre.imag - middle.imag)), edge


def _digits(number, digits=6):
    return float(f"{number:.{digits}g}")


def _sheared(choice, name):
    origin, edge = grid(choice, name)
    angles = radians(choice.theta), radians(choice.theta0)
    options = {"kappa": KAPPA[name]} if name in KAPPA else {}
    return conformal.sheared_grid(*angles, choice.m, choice.n, origin, edge, **options)


def _plane(choice):
    z = _sheared(choice, choice.map)
    maps = {
        "identity": lambda z: z,
        "square": lambda z: z**2,
        "inverse": lambda z: 1 / z,
        "exp": np.exp,
        "moebius": lambda z: conformal.moebius([[0, 1], [1, -complex(choice.px, choice.py)]], z),
    }
    with np.errstate(all="ignore"):
        return Made(*conformal.quads(maps[choice.map](z)), _exact(choice.map))


def _exact(name):
    if name in ("inverse", "moebius"):
        return "conformal image: the angles are those of a smooth net, up to the square of the edge"
    return "exact: this map keeps both angles of finite quads (B6)"


def _isothermal(choice):
    if choice.surface == "rolled":
        V, words = _rolled(choice)
    else:
        z = _sheared(choice, choice.surface)
        sphere = choice.surface == "sphere"
        shape = surfaces.SPHERE if sphere else surfaces.conjugate(radians(choice.bend))
        V = shape.point(z.real, z.imag)
        words = "sampled from a smooth net: off by about the square of the edge"
    if choice.moebius:
        V = moebius.apply(moebius.inversion((choice.px, choice.py, choice.pz)), V)
        words = "sampled from a smooth net, then inverted in a sphere around the pole"
    return Made(V.reshape(-1, 3), mesh.grid_quads(choice.m, choice.n), words)


def _rolled(choice):
    angles = radians(choice.theta), radians(choice.theta0)
    origin, edge = grid(choice, "rolled")
    curvature = bending(choice)
    z = developable.rolled_grid(*angles, choice.m, choice.n, curvature, origin, edge)
    return developable.roll(z, curvature), "exact: both angles hold on the bent sheet"


def bending(choice):
    """The curvature that bends the sheet by the chosen angle from one side to the other."""
    _, edge = grid(choice, "rolled")
    mu = parallelogram.ratios(radians(choice.theta), radians(choice.theta0))[1]
    width = edge * (choice.m + choice.n * abs(cmath.exp(1j * radians(choice.theta0)).real) / mu)
    return _digits(radians(choice.bend) / width)


def _revolution(choice):
    profile = surfaces.spline_profile(list(zip(choice.radii, HEIGHTS, strict=True)))
    angles = radians(choice.theta), radians(choice.theta0)
    net = loxodrome.web(profile, *angles, choice.m, choice.n)
    return Made(net.V, net.Q, f"exact: {net.message}")


# --- the same in Python -------------------------------------------------------------------


def code(choice, path="surface.obj"):
    """Three lines of Python that make the net: V and Q.

    path: of the surface's file.
    """
    angles = f"np.radians({_exact_text(choice.theta)}), np.radians({_exact_text(choice.theta0)})"
    writers = {
        "plane": _plane_code,
        "isothermal": _isothermal_code,
        "revolution": _revolution_code,
        "freeform": _freeform_code,
        "cover": _cover_code,
    }
    return "\n".join(writers[choice.kind](choice, angles, path))


def _exact_text(x):
    """A number with all its digits, whole ones without the point."""
    return repr(x).removesuffix(".0")


def _grid_code(choice, angles, name):
    origin, edge = grid(choice, name)
    kappa = f", kappa={KAPPA[name]}" if name in KAPPA else ""
    sizes = f"{choice.m}, {choice.n}, {origin}, {edge}"
    return f"z = conformal.sheared_grid({angles}, {sizes}{kappa})"


def _plane_code(choice, angles, path):
    pole = complex(choice.px, choice.py)
    image = {
        "identity": "z",
        "square": "z**2",
        "inverse": "1 / z",
        "exp": "np.exp(z)",
        "moebius": f"conformal.moebius([[0, 1], [1, {-pole}]], z)",
    }[choice.map]
    yield "import numpy as np; from inetlib import conformal"
    yield _grid_code(choice, angles, choice.map)
    yield f"V, Q = conformal.quads({image})"


def _isothermal_code(choice, angles, path):
    quads = f"mesh.grid_quads({choice.m}, {choice.n})"
    if choice.surface == "rolled":
        origin, edge = grid(choice, "rolled")
        curvature = bending(choice)
        rooms, points = "developable", f"developable.roll(z, {curvature})"
        sizes = f"{choice.m}, {choice.n}, {curvature}, {origin}, {edge}"
        line = f"z = developable.rolled_grid({angles}, {sizes})"
    else:
        line, rooms = _grid_code(choice, angles, choice.surface), "conformal, surfaces"
        bend = f"conjugate(np.radians({_exact_text(choice.bend)}))"
        shape = "SPHERE" if choice.surface == "sphere" else bend
        points = f"surfaces.{shape}.point(z.real, z.imag)"
    if choice.moebius:
        pole = f"{choice.px}, {choice.py}, {choice.pz}"
        points, rooms = f"moebius.apply(moebius.inversion(({pole})), {points})", rooms + ", moebius"
    yield f"import numpy as np; from inetlib import mesh, {rooms}"
    yield line
    yield f"V, Q = {points}.reshape(-1, 3), {quads}"


def _revolution_code(choice, angles, path):
    points = [(r, h) for r, h in zip(choice.radii, HEIGHTS, strict=True)]
    yield "import numpy as np; from inetlib import loxodrome, surfaces"
    yield f"profile = surfaces.spline_profile({points})"
    yield f"V, Q = loxodrome.web(profile, {angles}, {choice.m}, {choice.n})[:2]"


def _freeform_code(choice, angles, path):
    yield "import numpy as np; from inetlib import reference, solver, surfaces"
    yield f"V, Q = surfaces.freeform_patch({choice.m}, {choice.n})"
    yield f"V = solver.optimize(V, Q, {angles}, reference=reference.mesh(V, Q)).V"


def _cover_code(choice, angles, path):
    given = f"examples.{EXAMPLES[choice.source]}()" if choice.source != "file" else ""
    room = "examples" if given else "io"
    direction = f"np.radians({_exact_text(choice.direction)})"
    yield f"import numpy as np; from inetlib import design, {room}"
    yield f"surface = {given or f'io.surface({str(path)!r})'}"
    options = f"count={choice.quads}, direction={direction}"
    yield f"V, Q = design.cover(*surface[:2], {angles}, {options})[:2]"
