"""Fig. 12: five freeform shapes, optimised to five isogonal nets."""

import numpy as np

from .. import measure, mesh, plot, reference, solver, surfaces
from ..plot import COLOURS, DEGREE
from . import drawn, enlarged, patches

RIGHT, SIXTY = 90 * DEGREE, 60 * DEGREE
SETTINGS = {"A": {}, "B": {"theta": RIGHT}, "C": {"theta0": RIGHT}}  # what is not given is found
SETTINGS |= {"D": {"theta": RIGHT, "theta0": RIGHT}, "E": {"theta": SIXTY, "theta0": SIXTY}}
ITERATIONS = {"A": 12, "B": 17, "C": 17, "D": 17, "E": 17}  # of the paper's formulation
TITLES = {
    "A": "a dome, free angles",
    "B": "a saddle, rectangles",
    "C": "a wave, rhombuses",
    "D": "an arch, squares",
    "E": r"a roof, $\lambda=\mu$",
}
WIDE, ROOM = 1.5, 0.38  # of the nets, over their heights, and below them
WEB = {"u": "$u$", "v": "$v$", "d1": "$d_1$", "d2": "$d_2$"}


def starts(m=20, n=20):
    """The five shapes as meshes of m x n quads: ({"A": V, ... "E"}, Q).

    Each V has a bounding box of diagonal 1 around 0; E is `surfaces.freeform_patch`; Q is
    `mesh.grid_quads`.  Paper: Fig. 12."""
    u, v = np.meshgrid(np.linspace(-1, 1, m + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    dome, wave = np.cos(0.8 * u + 0.1) * np.cos(0.9 * v - 0.15 * u), np.sin(2.7 * u + 0.5 * v)
    saddle, way = 0.42 * (u - 0.1) ** 2 - 0.46 * v**2 + 0.1 * u * v, 1.2 * u
    shapes = {
        "A": (u + 0.45 * v - 0.1 * u**2, v * (1 - 0.16 * u) + 0.1 * u, 1.1 * dome),
        "B": (1.15 * u + 0.5 * v, 0.9 * v - 0.1 * u**2, saddle),
        "C": (
            1.35 * u + 0.1 * v**2,
            0.8 * v * (1 + 0.12 * u) - 0.15 * np.sin(1.5 * u),
            0.38 * wave - 0.12 * v**2,
        ),
        "D": (
            (1 + 0.22 * v) * np.sin(way),
            1.05 * v + 0.25 * u**2,
            (1 - 0.12 * v) * np.cos(way) - 0.1 * v**2,
        ),
    }
    found = {letter: np.stack(x, axis=-1).reshape(-1, 3) for letter, x in shapes.items()}
    for V in found.values():
        V -= (V.min(axis=0) + V.max(axis=0)) / 2
        V /= np.linalg.norm(np.ptp(V, axis=0))
    return found | {"E": surfaces.freeform_patch(m, n)[0]}, mesh.grid_quads(m, n)


def nets(formulation="ratio", m=20, n=20, weights=patches.WEIGHTS):
    """The `starts` and the five nets: ({"A": V, ...}, Q, {"A": `solver.Result`, ... "E"}).

    formulation: of `solver.optimize`; "paper" takes the printed numbers of iterations and
    goes to the angles at once.  m, n: quads each way.  Paper: Fig. 12, Table 1."""
    first, Q = starts(m, n)
    same, found = {"weights": weights, "formulation": formulation}, {}
    for letter, angles in SETTINGS.items():
        way = {"iterations": ITERATIONS[letter], "via": "jump"} if formulation != "ratio" else {}
        near = reference.mesh(first[letter], Q)
        found[letter] = solver.optimize(first[letter], Q, **angles, reference=near, **same, **way)
    return first, Q, found


@drawn("azimuth", "elevation")
def draw(m=20, n=20, azimuth=-62 * DEGREE, elevation=46 * DEGREE):
    """Five freeform shapes with isogonal nets, the 4-web of the first, and their parallelograms.

    m, n: quads each way; azimuth, elevation: the camera, radians.  Grey: the boundaries of the
    meshes that the optimisation started from.  Below each net the marked quad is enlarged.
    Paper: Fig. 12."""
    first, Q, found = nets(m=m, n=n)
    figure, axes = plot.canvas([["A", "A'", "B"], ["C", "D", "E"]], 7.4, 5.6)
    view, face = plot.camera(azimuth, elevation), m // 2 * n + n // 2
    data, claims = {}, {}
    for letter, result in found.items():
        ax, V = axes[letter], result.V
        data |= {f"start_{letter}": first[letter], f"net_{letter}": V}
        lines = [patches.outline(first[letter], Q, plot.GREY, 0.8), patches.outline(V, Q[[face]])]
        patches.surface(ax, view, V, Q, lines=lines)
        plot.panel(ax, letter, TITLES[letter])
        claims |= patches.claims(letter, result, Q)
        wanted = SETTINGS[letter].get("theta"), SETTINGS[letter].get("theta0")
        off = np.degrees(measure.deviations(first[letter], Q, *wanted).max())
        claims[f"{letter}_start_off_deg"] = round(float(off), 6)
        steps = f"{len(result.history) - 1} steps"
        enlarged.draw(enlarged.below(ax, WIDE, ROOM), V, Q, face, reach=0.9, more=steps)
    _web(axes["A'"], view, found["A"].V, Q)
    return figure, data, [(r.V, Q, r.theta, r.theta0) for r in found.values()], claims


def _web(ax, view, V, Q):
    """The four families of a net, and their names below."""
    plot.scene(ax, view, [(V, Q, plot.PALE)], plot.families(V, Q, dict.fromkeys(WEB, 0.4)))
    plot.panel(ax, "A'", "its 4-web")
    enlarged.below(ax, WIDE, ROOM).set_axis_off()
    for k, (name, symbol) in enumerate(WEB.items()):
        x = 0.14 + 0.2 * k
        ax.plot([x, x + 0.06], [0.14, 0.14], color=COLOURS[name], lw=2, transform=ax.transAxes)
        ax.text(x + 0.075, 0.14, symbol, transform=ax.transAxes, va="center")
