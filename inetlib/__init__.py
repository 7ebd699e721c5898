"""inetlib: discrete isogonal nets with similar parallelograms.

A net is two plain arrays: vertices `V` (n, 3) float64 and quads `Q` (f, 4) int64,
counter-clockwise with v1 at the top left (see `inetlib.mesh`).  Angles are radians.

Paper: Wang, Li, Li, Wang, "Discrete isogonal nets with similar parallelograms".
"""

from importlib import import_module

__all__ = [
    "NotConverged",
    "adjacency",
    "clean",
    "conformal",
    "constraints",
    "curves",
    "design",
    "developable",
    "exactness",
    "examples",
    "flatten",
    "forms",
    "freedom",
    "goals",
    "grids",
    "guided",
    "io",
    "kinematic",
    "linear",
    "loxodrome",
    "matrixfree",
    "measure",
    "mesh",
    "moebius",
    "nearest",
    "outline",
    "overlay",
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
    "survey",
]


def __getattr__(name):
    """Modules are loaded when they are first used."""
    if name == "NotConverged":
        return import_module(".solver", __name__).NotConverged
    if name == "__version__":
        return import_module("importlib.metadata").version(__name__)
    if name in __all__:
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__} has no attribute {name}")


def __dir__():
    return [*globals(), *__all__, "__version__"]
