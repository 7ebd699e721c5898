"""Fig. 9, columns 1 and 3: one I-net on five isothermal surfaces, and its Moebius images."""

import numpy as np

from .. import moebius, plot, publish, surfaces
from . import _isothermal

NAMES = {"A": "cylinder", "B": "sphere", "C": "catenoid", "D": "helicoid", "E": "conjugate"}
# rows, quads along a row, the upper left corner (u, v) in steps, the line that is highlighted
PATCHES = {
    "A": (8, 20, 0, 4, 13),
    "B": (8, 20, 0, 4, 13),
    "C": (8, 20, 0, 4, 13),
    "D": (8, 20, -14, 4, 10),
    "E": (8, 20, -14, 4, 10),
}
CAMERAS = {"A": (-90, 18), "B": (-90, 18), "C": (-90, 25), "D": (15, 28), "E": (-15, 28)}
CENTRES = {
    "A": (2.9, 0, 0.7),
    "B": (2, -1, 1.1),
    "C": (0.5, -3.6, 0.6),
    "D": (2.9, 0, 0),
    "E": (0, 0, 4.8),
}
IMAGE_CAMERAS = {"A": (-35, 30), "B": (-45, 50), "C": (-45, 30), "D": (0, 20), "E": (-45, 50)}


def draw(around=20, t=45):
    """The (arccos 1/sqrt 5, 45 degree) net on five surfaces, and its images under inversions.

    around: steps of a full turn of u; t: of the conjugate minimal surface, degrees.  In each
    picture one loxodrome (u-curve) is highlighted.  Columns 2 and 4 of the paper's figure
    are optimised nets and belong to Sec. 6.  Returns a `publish.Drawing`.

    Paper: Fig. 9.
    """
    panels = [[f"{k}{row}" for k in NAMES] for row in (1, 3)]
    figure, axes = plot.canvas(panels, 7.2, 3.7)
    for ax in axes.values():
        ax.set_aspect("equal", adjustable="datalim")  # titles in one line
    step = 2 * np.pi / around
    nets, data, claims = [], {}, {}
    for letter, surface in _surfaces(np.radians(t)).items():
        m, n, left, top, marked = PATCHES[letter]
        z = _isothermal.domain(m, n, step, step * (left + 1j * top))
        line = _isothermal.refined(z[:, marked], 3)
        V, Q = _isothermal.sample(surface, z)
        curve = surface.point(line.real, line.imag)
        inversion = moebius.inversion(CENTRES[letter])
        W, image = moebius.apply(inversion, V), moebius.apply(inversion, curve)
        _panel(axes[f"{letter}1"], CAMERAS[letter], V, Q, curve)
        _panel(axes[f"{letter}3"], IMAGE_CAMERAS[letter], W, Q, image)
        plot.panel(axes[f"{letter}1"], f"{letter}_1", NAMES[letter])
        plot.panel(axes[f"{letter}3"], f"{letter}_3", "")
        nets.append((np.stack([z.real.ravel(), z.imag.ravel(), 0 * z.real.ravel()], 1), Q))
        data |= {f"net_{letter}1": V, f"net_{letter}3": W}
        for row, points in ((1, V), (3, W)):
            off = max(publish.deviations([(points, Q, *_isothermal.ANGLES)]))
            claims[f"sampled_net_{letter}{row}_max_deviation_deg"] = round(off, 6)
    nets = [(V, Q, *_isothermal.ANGLES) for V, Q in nets]
    return publish.Drawing(
        "fig09",
        figure,
        "inetlib.drawings.fig09.draw",
        {"around": around, "t": t},
        data,
        nets,
        claims,
    )


def _surfaces(t):
    found = surfaces.CYLINDER, surfaces.SPHERE, surfaces.CATENOID, surfaces.HELICOID
    return dict(zip(NAMES, (*found, surfaces.conjugate(t)), strict=True))


def _panel(ax, degrees, V, Q, curve):
    view = plot.camera(*np.radians(degrees))
    lines = _isothermal.coloured(V, Q, {"v": 0.6, "u": 0.6})
    lines.append((curve, plot.COLOURS["u"], 2.2))
    plot.scene(ax, view, V, Q, plot.shade(V, Q), lines).set_clip_on(False)  # a smaller file
