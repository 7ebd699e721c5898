"""Table 1: the printed statistics beside ours, in both formulations."""

import csv
import io

import numpy as np

from .. import publish
from ..design import report
from ..solver.problem import PAPER, Weights
from . import fig12, fig13, patches

# F, #var, #cons, residual, iterations, seconds per iteration
PRINTED = {
    "12A": (400, 3728, 3201, "1.2e-12", 12, 0.127),
    "12B": (400, 3728, 3601, "3.1e-12", 17, 0.121),
    "12C": (400, 3728, 3601, "2.9e-13", 17, 0.122),
    "12D": (400, 2126, 1602, "1.6e-12", 17, 0.107),
    "12E": (400, 2126, 1602, "1.1e-8", 17, 0.116),
    "13A": (433, 2323, 1730, "3.6e-12", 12, 0.17),
    "13B": (433, 4052, 4321, "3.8e-10", 12, 0.165),
}
HEADER = [
    *("Fig.", "formulation", "F", "#var", "#cons", "residual", "#iter"),
    *("max dtheta", "max dtheta0", "mean dtheta", "mean dtheta0", "flips, darts", "area ratio"),
]
# The authors' published programs multiply the residual of an energy by its weight, so that its
# square acts.  The caption of Table 1 names three weights; gliding, 0.01 for Fig. 12, is left out.
SQUARED = Weights(*(weight**2 for weight in PAPER[:3]), boundary=0.0)
VARIANTS = {  # formulation and weights
    "paper's, printed weights": ("paper, splu", PAPER),
    "paper's, squared weights": ("paper, splu", SQUARED),
    "paper's, small weights": ("paper, splu", patches.WEIGHTS),
    "ratios": ("ratio", patches.WEIGHTS),
}
NOISE = 1e-20  # residuals below are rounding errors


def results(name):
    """The seven optimised nets of one of `VARIANTS`: {row: (Q, `solver.Result`)}.

    Paper: Table 1."""
    formulation, weights = VARIANTS[name]
    found = {}
    for figure, module in (("12", fig12), ("13", fig13)):
        _, Q, *_, nets = module.nets(formulation, weights=weights)
        found |= {figure + letter: (Q, result) for letter, result in nets.items()}
    return found


def rows(variants):
    """The lines of the table as lists of strings; variants: {name: its `results`}.

    Deviations are degrees from the wanted (or found) angles, over all faces.
    Paper: Table 1, App. A.4."""
    lines = []
    for row, (F, variables, constraints, residual, steps, _) in PRINTED.items():
        printed = [F, variables, constraints, residual, steps]
        lines.append([row, "printed", *map(str, printed), *6 * ["-"]])
        lines += [[row, name, *_row(*nets[row])] for name, nets in variants.items()]
    return lines


def _row(Q, found):
    numbers = report.report(found.V, Q, theta=found.theta, theta0=found.theta0)
    spreads = numbers.theta, numbers.theta0
    off = [s.max_deviation for s in spreads] + [s.mean_deviation for s in spreads]
    residual = min(found.history, key=lambda step: step.key).residual  # of the net returned
    return [
        *map(str, (len(Q), *found.sizes)),
        f"{residual:.0e}" if residual > NOISE else "< 1e-20",
        str(len(found.history) - 1),
        *(f"{x:.2g}" if x > 1e-9 else "< 1e-9" for x in np.degrees(off)),
        f"{numbers.flips}, {numbers.darts}",
        f"{numbers.area_ratio:.3f}",
    ]


def markdown(lines):
    """The table as Markdown text.  Paper: Table 1."""
    table = [HEADER, ["---"] * len(HEADER), *lines]
    return "".join(f"| {' | '.join(line)} |\n" for line in table)


def save(lines, folder):
    """Write folder/table1.md and folder/table1.csv.  Paper: Table 1."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([HEADER, *lines])
    publish.save_text(markdown(lines), f"{folder}/table1.md")
    publish.save_text(text.getvalue(), f"{folder}/table1.csv")


def show(lines):
    """The table below a notebook's cell; written too where `publish.asked` says."""
    from IPython.display import Markdown  # only a notebook needs it

    if folder := publish.asked():
        save(lines, folder)
    return Markdown(markdown(lines))
