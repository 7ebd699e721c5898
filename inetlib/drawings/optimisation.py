"""Pictures of Sec. 6 that the paper does not have: what each energy does, how fast it goes."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

from .. import measure, mesh, plot, reference, solver, surfaces
from ..plot import DEGREE
from ..solver.problem import Weights
from . import patches

CAMERA = -62 * DEGREE, 42 * DEGREE
FLOOR = 1e-12  # below is rounding
LITTLE = Weights(fairness=0.002, closeness=0.001, approximation=0, boundary=0)
ENERGIES = {  # one energy after the other made strong, all with the same angles
    "angles only": None,
    "fairness": LITTLE._replace(fairness=0.05),
    "closeness": LITTLE._replace(closeness=0.1),
    "approximation": LITTLE._replace(approximation=1),
    "approximation, boundary gliding": LITTLE._replace(approximation=1, boundary=0.005),
}


def energies(theta=np.pi / 2):
    """The freeform patch optimised to theta with one shape energy at a time.

    Returns (figure, lines): a panel for the start and each of `ENERGIES`, and a table as
    lists [name, steps, area ratio, unfairness, distance from the surface, from its boundary],
    distances as fractions of the bounding box's diagonal."""
    V, Q = surfaces.freeform_patch()
    near = reference.mesh(V, Q)
    lines = [["start", 0, *_numbers(V, Q, near)]]
    figure, axes = plot.canvas([["start", *list(ENERGIES)[:2]], list(ENERGIES)[2:]], 7.4, 4.4)
    view = plot.camera(*CAMERA)
    nets = {"start": V}
    for name, weights in ENERGIES.items():
        more = {"shape_steps": 0} if weights is None else {"weights": weights, "shape_steps": 4}
        found = solver.optimize(V, Q, theta, reference=near, **more)
        nets[name] = found.V
        lines.append([name, len(found.history) - 1, *_numbers(found.V, Q, near)])
    for name, points in nets.items():
        patches.surface(axes[name], view, points, Q)
        axes[name].set_title(name, loc="left")
    return figure, lines


def _numbers(V, Q, near):
    """Area ratio, second differences (root mean square), mean distance from surface and rim."""
    left, middle, right = V[mesh.triples(Q).T]
    unfair = np.sqrt(np.mean(np.sum((2 * middle - left - right) ** 2, axis=1)))
    rim = mesh.boundary_loops(Q)[0]
    apart = V - near.closest(V)[0], V[rim] - near.boundary(V[rim])[0]
    means = (np.linalg.norm(d, axis=1).mean() / near.diagonal for d in apart)
    return measure.quality(V, Q).area_ratio, unfair / near.diagonal, *means


def convergence(results):
    """Residual and largest deviation of the angles, step by step; results: {name: `Result`}.

    Residuals of different formulations are different things; the angles are not.  Dots mark
    steps with shape energies.  Returns the figure."""
    plot.use_style()
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.4, 2.8))
    for name, result in results.items():
        shape = np.array([step.kind == "shape" for step in result.history])
        residual = np.maximum([step.residual for step in result.history], FLOOR**2)
        off = np.maximum(np.degrees([step.deviation for step in result.history]), FLOOR)
        for ax, y in ((left, residual), (right, off)):
            (line,) = ax.semilogy(y, label=name, lw=1.3)
            ax.plot(np.flatnonzero(shape), y[shape], "o", ms=3, color=line.get_color())
            ax.set_xlabel("step")
            ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    left.set_title("sum of squared residuals", loc="left")
    right.set_title("largest deviation of an angle, degrees", loc="left")
    right.axhline(1e-9, color="0.6", lw=0.7)
    left.legend()
    return figure
