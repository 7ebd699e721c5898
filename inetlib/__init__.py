"""inetlib: discrete isogonal nets with similar parallelograms.

A net is two plain arrays: vertices `V` (n, 3) float64 and quads `Q` (f, 4) int64,
counter-clockwise with v1 at the top left (see `inetlib.mesh`).  Angles are radians.

Paper: Wang, Li, Li, Wang, "Discrete isogonal nets with similar parallelograms".
"""

from importlib.metadata import version

from . import (
    adjacency,
    conformal,
    constraints,
    curves,
    developable,
    exactness,
    forms,
    freedom,
    goals,
    grids,
    guided,
    kinematic,
    linear,
    loxodrome,
    matrixfree,
    measure,
    mesh,
    moebius,
    nearest,
    outline,
    parallelogram,
    pencil,
    planar,
    problem,
    reference,
    rings,
    runs,
    singular,
    solver,
    steps,
    surfaces,
)

__all__ = [
    "NotConverged",
    "adjacency",
    "conformal",
    "constraints",
    "curves",
    "developable",
    "exactness",
    "forms",
    "freedom",
    "goals",
    "grids",
    "guided",
    "kinematic",
    "linear",
    "loxodrome",
    "matrixfree",
    "measure",
    "mesh",
    "moebius",
    "nearest",
    "outline",
    "parallelogram",
    "pencil",
    "planar",
    "problem",
    "reference",
    "rings",
    "runs",
    "singular",
    "solver",
    "steps",
    "surfaces",
]
NotConverged = solver.NotConverged
__version__ = version("inetlib")
