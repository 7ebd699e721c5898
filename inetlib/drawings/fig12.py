"""Fig. 12: one freeform patch, optimised to five isogonal nets."""

import numpy as np
from matplotlib.colors import Normalize

from .. import plot, reference, solver, surfaces
from ..plot import DEGREE
from . import drawn, patches

RIGHT, SIXTY = 90 * DEGREE, 60 * DEGREE
SETTINGS = {"A": {}, "B": {"theta": RIGHT}, "C": {"theta0": RIGHT}}  # what is not given is found
SETTINGS |= {"D": {"theta": RIGHT, "theta0": RIGHT}, "E": {"theta": SIXTY, "theta0": SIXTY}}
ITERATIONS = {"A": 12, "B": 17, "C": 17, "D": 17, "E": 17}  # of the paper's formulation
TITLES = {
    "A": "general, with its 4-web",
    "B": r"rectangles, $\mu=1$",
    "C": r"rhombuses, $\lambda=1$",
    "D": r"squares, $\lambda=\mu=1$",
    "E": r"parallelograms, $\lambda=\mu$",
}


def nets(formulation="ratio", m=20, n=20, weights=patches.WEIGHTS):
    """The start and the five nets: (V, Q, {"A": `solver.Result`, ... "E"}).

    formulation: of `solver.optimize`; "paper" takes the printed numbers of iterations and
    goes to the angles at once.  m, n: quads each way.  Paper: Fig. 12, Table 1."""
    V, Q = surfaces.freeform_patch(m, n)
    same = {"reference": reference.mesh(V, Q), "weights": weights, "formulation": formulation}
    found = {}
    for letter, angles in SETTINGS.items():
        way = {"iterations": ITERATIONS[letter], "via": "jump"} if formulation != "ratio" else {}
        found[letter] = solver.optimize(V, Q, **angles, **same, **way)
    return V, Q, found


@drawn("azimuth", "elevation")
def draw(m=20, n=20, azimuth=-62 * DEGREE, elevation=42 * DEGREE):
    """A patch and the five isogonal nets it is optimised to, with their parallelograms.

    m, n: quads each way; azimuth, elevation: the camera, radians.  The start is coloured by
    the larger deviation of theta and theta0 from their means.  Each panel shows four faces
    enlarged.  Paper: Fig. 12."""
    V, Q, found = nets(m=m, n=n)
    figure, axes = plot.canvas([["start", "A", "B"], ["C", "D", "E"]], 7.4, 5.8)
    view = plot.camera(azimuth, elevation)
    data = {"start": V} | {f"net_{letter}": r.V for letter, r in found.items()}
    off = {"start": patches.deviation(V, Q)}
    off |= {k: patches.deviation(r.V, Q, r.theta, r.theta0) for k, r in found.items()}
    scale = Normalize(0, patches.next_multiple(off["start"].max(), 5))
    i, j = np.meshgrid(m // 2 - np.arange(2), n // 2 - np.arange(2), indexing="ij")
    four = (i * n + j).ravel()  # faces in the middle
    for (name, ax), W in zip(axes.items(), data.values(), strict=True):
        colours = patches.tints(scale, off[name])
        lines = [patches.outline(W, Q[four])]
        if name == "A":
            lines += plot.families(W, Q, {"d1": 0.4, "d2": 0.4})
        patches.surface(ax, view, W, Q, colours, lines)
        patches.enlarged(ax, [0, 0, 0.42, 0.33], W, Q, four, colours[four])
    axes["start"].set_title("the start", loc="left")
    patches.bar(axes["start"], scale, [0.5, 0.13, 0.46, 0.035])
    claims = {}
    for letter, result in found.items():
        plot.panel(axes[letter], letter, TITLES[letter])
        _words(axes[letter], letter, result)
        claims |= patches.claims(letter, result, Q)
    patches.align(list(axes.values()), 0.42)
    claims["start_max_deviation_deg"] = round(off["start"].max(), 6)
    return figure, data, [(r.V, Q, r.theta, r.theta0) for r in found.values()], claims


def _words(ax, letter, result):
    texts = []
    for name, symbol in (("theta", r"\theta"), ("theta0", r"\theta_0")):
        digits = 0 if name in SETTINGS[letter] else 2
        texts.append(rf"${symbol}={np.degrees(getattr(result, name)):.{digits}f}\degree$")
    texts.append(f"{len(result.history) - 1} steps")
    ax.text(0.5, 0.15, "\n".join(texts), transform=ax.transAxes, va="center", linespacing=1.4)
