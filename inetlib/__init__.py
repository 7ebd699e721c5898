"""inetlib: discrete isogonal nets with similar parallelograms.

A net is two plain arrays: vertices `V` (n, 3) float64 and quads `Q` (f, 4) int64,
counter-clockwise with v1 at the top left (see `inetlib.mesh`).  Angles are radians.

Paper: Wang, Li, Li, Wang, "Discrete isogonal nets with similar parallelograms"."""

from importlib import import_module

__all__ = [
    "NotConverged", "conformal", "design", "developable", "examples", "exercises", "io",
    "loxodrome", "measure", "mesh", "moebius", "motif", "panels", "parallelogram", "planar",
    "reference", "repair", "schedule", "solver", "surfaces",
]  # fmt: skip


def __getattr__(name):
    """Modules are loaded when they are first used: `import inetlib` takes no time."""
    if name == "NotConverged":
        value = import_module(".solver", __name__).NotConverged
    elif name == "__version__":
        value = import_module("importlib.metadata").version("inetlib")
    elif name in __all__:
        value = import_module(f".{name}", __name__)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *__all__, "__version__"})
