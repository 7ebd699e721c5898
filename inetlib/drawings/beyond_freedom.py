"""What may still be chosen of an isogonal net: one curve, two opposite ones, a symmetry, ..."""

import numpy as np
from matplotlib.colors import Normalize

from .. import mesh, plot, reference, solver, surfaces
from ..plot import DEGREE
from ..solver.problem import Weights
from . import drawn, patches

CELLS = 12
TITLES = {
    "A": "one side stays",
    "B": "a curve in the middle stays",
    "C": "two opposite sides stay",
    "D": "near the boundary curve",
    "E": "half-turn symmetry",
    "F": "the whole boundary: no net",
}
SOFT = 0.03  # weight of the boundary


def curves(m=CELLS):
    """The vertices that stay, {panel: numbers}, in a grid of m x m quads.  Paper: B8."""
    index = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
    rim = mesh.boundary_loops(mesh.grid_quads(m, m))[0]
    none = index[0, :0]
    both = np.concatenate([index[0], index[-1]])
    return {"A": index[0], "B": index[m // 2], "C": both, "D": none, "E": none, "F": rim}


def vault(m=CELLS):
    """A roof that a half turn about the vertical axis takes to itself: (V, Q), m x m quads.

    Vertex k goes to vertex -1 - k.  The bounding box has the diagonal 1.  Paper: B8."""
    u, v = np.meshgrid(*2 * [np.linspace(-1, 1, m + 1)], indexing="ij")
    x, y = 1.1 * u + 0.3 * v, v - 0.15 * u + 0.1 * u**3
    z = 0.35 * np.cos(1.6 * u + 0.6 * v) - 0.25 * v**2
    V = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return V / np.linalg.norm(np.ptp(V, axis=0)), mesh.grid_quads(m, m)


def nets(theta=75 * DEGREE, theta0=75 * DEGREE, m=CELLS):
    """The starts and what became of them: {panel: (V, Q, `solver.Result`)}.

    A, B, C, F: the freeform roof with the vertices of `curves` fixed; D: with a heavy weight
    of the boundary; E: `vault`, without a reference surface.  theta, theta0: radians.  Paper: B8.
    """
    found = {}
    for letter, stay in curves(m).items():
        V, Q = vault(m) if letter == "E" else surfaces.freeform_patch(m, m)
        near = None if letter == "E" else reference.mesh(V, Q)
        weights = Weights(boundary=SOFT) if letter == "D" else None
        options = {"reference": near, "fixed": stay, "weights": weights, "tolerance": 1e-12}
        found[letter] = V, Q, solver.optimize(V, Q, theta, theta0, iterations=40, **options)
    return found


@drawn("azimuth", "elevation")
def draw(theta=75 * DEGREE, theta0=75 * DEGREE, azimuth=-65 * DEGREE, elevation=50 * DEGREE):
    """Six wishes at the same two angles: five are granted, the last one is not.

    theta, theta0: radians; azimuth, elevation: the camera, radians.  Black: the vertices
    that stay; grey: the boundary of the start.  The parallelograms of (F) have the colour
    of their deviation.  Paper: B8."""
    figure, axes = plot.canvas([list("ABC"), list("DEF")], 7.4, 4.4)
    view = plot.camera(azimuth, elevation)
    found, stay = nets(theta, theta0), curves()
    off = {k: patches.deviation(r.V, Q, theta, theta0) for k, (_, Q, r) in found.items()}
    scale = Normalize(0, patches.next_multiple(off["F"].max(), 5))
    data, exact, claims = {}, [], {f"{k} converged": x[2].converged for k, x in found.items()}
    for letter, (V, Q, result) in found.items():
        rim = np.append(stay[letter], stay[letter][:1])
        rows = [rim] if letter == "F" else stay[letter].reshape(-1, CELLS + 1)
        lines = [(result.V[row], plot.INK, 2.4) for row in rows]
        lines = [patches.outline(V, Q, plot.GREY, 0.9), *lines]
        colours = patches.tints(scale, off[letter])
        patches.surface(axes[letter], view, result.V, Q, colours, lines)
        plot.panel(axes[letter], letter, TITLES[letter])
        if result.converged:
            data[letter] = result.V
            exact.append((result.V, Q, result.theta, result.theta0))
            claims |= patches.claims(letter, result, Q)
    patches.align(list(axes.values()), 0.12)
    patches.bar(axes["F"], scale, [0.02, 0.06, 0.4, 0.035])
    return figure, data, exact, claims
