"""Nets that turn: the scenes that `viewer.js` shows, one script file each.

Every net is made by the library as its figure makes it, stored as float32, and then judged by
`measure`: the numbers beside a net are those of what is shown."""

import base64
import functools
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

from inetlib import (
    conformal,
    developable,
    loxodrome,
    measure,
    mesh,
    moebius,
    reference,
    solver,
    surfaces,
)
from inetlib.drawings import fig09, fig11, fig13, isothermal, patches
from inetlib.plot import DEGREE

SCENES = {  # {name: (title, words)}
    "web": (
        "Fig. 5: a web on a catenoid, in finer and finer quads",
        "A part of a catenoid with a net of quads, and its four families of curves.",
    ),
    "bending": (
        "Fig. 7: from the plane to the cylinder",
        "A slanted net that lies in the plane, is bent, and at last closes as a cylinder.",
    ),
    "squares": (
        "Fig. 8: an I-net made of the squares of a catenoid",
        "A catenoid with parallels and slanted curves, from its isothermal net.",
    ),
    "associate": (
        "Fig. 9: from the catenoid to the helicoid",
        "A net on a minimal surface that turns from a catenoid into a helicoid.",
    ),
    "stereographic": (
        "Fig. 10: from the sphere to the plane",
        "A net on a ring of the sphere that is opened into the plane by inversions.",
    ),
    "vase": (
        "Fig. 11: loxodromes on a vase",
        "A vase with parallels and loxodromes that meet at one angle everywhere.",
    ),
    "sphere": (
        "Fig. 11: loxodromes on a sphere",
        "A sphere with parallels and loxodromes that meet at one angle everywhere.",
    ),
    "patch": (
        "Fig. 12: a roof, from squares to 60 degrees",
        "A freeform roof with a net whose parallelograms change from squares to 60 degrees.",
    ),
    "hexagon": (
        "Fig. 13: a net around a hexagon",
        "A dome with eight rings of quads around a hexagon, and six waves at its boundary.",
    ),
    "inversion": (
        "Fig. 13: its Moebius image",
        "The dome of the net around a hexagon, turned inside out by an inversion.",
    ),
}
SOLVED = "Found by the solver, all angles met to a billionth of a degree; stored with 7 digits."
EXACT = "All angles are exact up to rounding; stored with 7 digits."
SAMPLED = "Sampled from a smooth surface: its angles are near those of the smooth web, not equal."
IMAGE = "The image of a net that meets its angles: near to them, the nearer the smaller the quads."
LENS = 26  # the angle of view, degrees
ROOM = 1.08  # around a net


class State(NamedTuple):
    """A net that a slider stops at, and the angles that it is made for (radians)."""

    label: str
    V: np.ndarray
    Q: np.ndarray
    theta: float
    theta0: float


class Scene(NamedTuple):
    """What one slider goes through."""

    states: list
    parameter: str  # what the slider changes
    note: str  # how true the angles are
    view: tuple  # azimuth and elevation of the camera, degrees
    first: int = 0  # the state shown first
    follow: bool = False  # whether the camera follows nets that change in size
    polygon: tuple = ()  # corners of a face that is no quad


def web(asked=(75 * DEGREE, 65 * DEGREE), size=1.45):
    """A patch of a catenoid, sampled ever finer.  Paper: Fig. 5."""
    states = []
    for cells in (3, 4, 6, 8, 12, 16, 24, 32):
        z = conformal.sheared_grid(*asked, cells, cells, edge=size / cells)
        V, Q = isothermal.sample(surfaces.CATENOID, z - z.mean())
        states.append(State(f"{cells}", V, Q, *asked))
    return Scene(states, "quads each way", SAMPLED, (5, 22), 3)


def bending(theta=60 * DEGREE, theta0=45 * DEGREE, m=24, n=20, steps=24):
    """A net that is exact on cylinders of every curvature.  Paper: Fig. 7."""
    states, Q = [], mesh.grid_quads(m, n)
    for k in np.arange(steps + 1) / steps:
        z = developable.rolled_grid(theta, theta0, m, n, k, edge=2 * np.pi / m)
        x, y, height = np.moveaxis(developable.roll(z - z.mean(), k), -1, 0)
        V = np.stack([x, -height, y], axis=-1).reshape(-1, 3)  # rulings upright
        states.append(State(f"{k:.2f}", V, Q, theta, theta0))
    return Scene(states, "curvature", EXACT, (78, 22), steps // 2, True)


def squares():
    """The net of two edges and two diagonals of squares, sampled.  Paper: Fig. 8."""
    states = []
    for around in (18, 24, 36, 48, 60):
        step, rows = 2 * np.pi / around, around * 7 // 18
        z = isothermal.domain(rows, around, step, 1j * step * rows / 2)
        V, Q = isothermal.sample(surfaces.CATENOID, z)
        states.append(State(f"{around}", V, Q, *isothermal.ANGLES))
    return Scene(states, "squares around", SAMPLED, (-80, 22), 2)


def associate(rows=14, columns=36, turn=3):
    """Nets on the minimal surfaces between two, glided to the angles.  Paper: Fig. 9."""
    step = 2 * np.pi / columns
    z = isothermal.domain(rows, columns, step, step * (rows / 2 * (1j - 1) - columns / 2))
    u, v = ((x.min() - fig09.MARGIN, x.max() + fig09.MARGIN) for x in (z.real, z.imag))
    options = {"on_surface": True, "weights": fig09.WEIGHTS, "tolerance": 1e-12, "strict": True}
    states = []
    for degrees in range(0, 91, turn):
        surface = surfaces.conjugate(degrees * DEGREE)
        V, Q = isothermal.sample(surface, z)
        smooth = reference.parametric(surface.point, u, v)
        found = solver.optimize(V, Q, *isothermal.ANGLES, reference=smooth, **options)
        states.append(State(f"{degrees}\u00b0", found.V, Q, *isothermal.ANGLES))
    return Scene(states, "turn in the family", SOLVED, (-75, 28), 10, True)


def stereographic(around=48, rows=16, top=5, steps=16):
    """A ring of the sphere and its images that keep the equator.  Paper: Fig. 10."""
    step = 2 * np.pi / around
    z = isothermal.domain(rows, around, step, 1j * top * step)
    V, Q = isothermal.sample(surfaces.SPHERE, z)
    states = [State("the sphere", V, Q, *isothermal.ANGLES)]
    for k in np.arange(1, steps + 1) / steps:
        height = 1 / np.tan(k * np.pi / 4)  # of the centre; at 1 it is the north pole
        inversion = moebius.inversion((0, 0, height), np.sqrt(height**2 + 1))
        upright = moebius.apply(inversion, V) * [1, 1, -1]
        label = "the plane" if k == 1 else f"{100 * k:.0f} %"
        states.append(State(label, upright, Q, *isothermal.ANGLES))
    return Scene(states, "on the way to the plane", SAMPLED, (-90, 32), 0, True)


def _loxodromes(profile, m, view):
    """The webs of a surface of revolution, theta0 from 30 to 150 degrees."""
    theta, states = fig11.ANGLES[0], []
    for degrees in range(30, 151, 10):
        net = loxodrome.web(profile, theta, degrees * DEGREE, m)
        rings = np.arange(len(net.V)).reshape(m, -1).T  # ring by ring: shorter webs are parts
        place = np.argsort(rings.ravel())
        Q = place[net.Q.reshape(m, net.rows, 4).swapaxes(0, 1).reshape(-1, 4)]
        states.append(State(f"{degrees}\u00b0", net.V[rings.ravel()], Q, theta, net.theta0))
    return Scene(states, "\u03b8\u2080, asked for", EXACT, view, 3)


def vase():
    """Exact webs on the vase.  Paper: Fig. 11."""
    return _loxodromes(surfaces.vase_profile(), 32, (54, 20))


def sphere():
    """Exact webs on a sphere between two parallels.  Paper: Fig. 11."""
    return _loxodromes(surfaces.sphere_profile(), 36, (54, 24))


def patch(m=20):
    """A freeform patch, optimised to theta = theta0 from 90 to 60 degrees.  Paper: Fig. 12."""
    V, Q = surfaces.freeform_patch(m, m)
    options = {"reference": reference.mesh(V, Q), "weights": patches.WEIGHTS, "strict": True}
    states = []
    for degrees in range(90, 59, -1):
        angles = 2 * [degrees * DEGREE]
        found = solver.optimize(V, Q, *angles, **options)
        states.append(State(f"{degrees}\u00b0", found.V, Q, *angles))
    return Scene(states, "\u03b8 = \u03b8\u2080, asked for", SOLVED, (-62, 42), len(states) - 1)


def hexagon():
    """A net around a hexagon, theta = 60, theta0 from 60 to 45 degrees.  Paper: Fig. 13."""
    V, Q, polygon = fig13.start()
    options = {"reference": reference.mesh(V, Q), "weights": patches.WEIGHTS, "strict": True}
    states = []
    for degrees in range(60, 44, -1):
        angles = fig13.SIXTY, degrees * DEGREE
        found = solver.optimize(V, Q, *angles, polygons=[polygon], **options)
        states.append(State(f"{degrees}\u00b0", found.V, Q, *angles))
    parameter = "\u03b8\u2080, asked for"
    return Scene(states, parameter, SOLVED, (-75, 50), 0, False, polygon)


def inversion():
    """The images of the nets around a hexagon.  Paper: Fig. 13."""
    turned, scene = moebius.inversion(fig13.CENTRE, fig13.RADIUS), made("hexagon")
    states = [s._replace(V=moebius.apply(turned, s.V)) for s in scene.states]
    return scene._replace(states=states, note=IMAGE, follow=True)


MADE = {f.__name__: f for f in (web, bending, squares, associate, stereographic, vase, sphere)}
MADE |= {f.__name__: f for f in (patch, hexagon, inversion)}


@functools.cache
def made(name):
    """The `Scene` of a name, made once."""
    return MADE[name]()


def stored(V):
    """The vertices as a scene keeps them: float32 of 8 digits after the point."""
    return (np.round(V, 8) + 0.0).astype("<f4")


def numbers(state):
    """What is shown beside a net, as `measure` finds it on the stored vertices; degrees."""
    V = stored(state.V).astype(float)
    lam, mu, theta, theta0 = measure.faces(V, state.Q)
    quality = measure.quality(V, state.Q)
    off = measure.deviations(V, state.Q, state.theta, state.theta0).max()
    found = {"theta": np.degrees(theta).mean(), "theta0": np.degrees(theta0).mean()}
    found |= {"lam": lam.mean(), "mu": mu.mean(), "off": np.degrees(off)}
    found = {name: round(float(value), 6) for name, value in found.items()}
    return found | {"faces": len(state.Q), "flips": quality.flips, "darts": quality.darts}


def _text(values, kind):
    """An array as base64, little-endian."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


def _seen(V, view):
    """The camera that looks at the vertices from azimuth and elevation, and shows all of them."""
    (ca, ce), (sa, se) = (f(np.radians(view)) for f in (np.cos, np.sin))
    axes = np.array([[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])
    seen = V @ axes.T
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    aside, near = np.abs(seen - middle)[:, :2].max(axis=1), (seen - middle)[:, 2]
    away = (ROOM * aside / np.tan(np.radians(LENS / 2)) + near).max()
    focus, position = middle @ axes, (middle + np.array([0, 0, away])) @ axes
    position, focus = (np.round(x, 4).tolist() for x in (position, focus))
    return {"position": position, "focalPoint": focus, "viewUp": [0, 0, 1], "viewAngle": LENS}


def script(name):
    """The text of a scene's file, which calls inetScene(name, {...})."""
    title, words = SCENES[name]
    scene = made(name)
    whole = _seen(np.concatenate([state.V for state in scene.states]), scene.view)
    states = []
    for s in scene.states:
        camera = _seen(s.V, scene.view) if scene.follow else whole
        V = _text(stored(s.V), "<f4")
        states.append({"label": s.label, **numbers(s), "camera": camera, "V": V})
    longest = max((s.Q for s in scene.states), key=len)
    parts = all(np.array_equal(s.Q, longest[: len(s.Q)]) for s in scene.states)
    for state, s in zip(states, scene.states, strict=True):
        state |= {} if parts else {"Q": _text(s.Q, "<u2")}
    told = {"title": title, "words": words, "note": scene.note, "parameter": scene.parameter}
    told |= {"first": scene.first, "polygon": np.asarray(scene.polygon, dtype=int).tolist()}
    told |= {"Q": _text(longest, "<u2")} if parts else {}
    data = json.dumps(told | {"states": states}, separators=(",", ":"), allow_nan=False)
    return f'inetScene("{name}", {data});\n'


def write(folder: Path):
    """Write all scenes into a folder."""
    folder.mkdir()
    for name in SCENES:
        (folder / f"{name}.js").write_text(script(name), encoding="ascii", newline="\n")
