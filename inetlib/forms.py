"""The fundamental forms of a parametrised surface.

With sympy symbols everything is exact; with numbers or arrays central differences of order 6
are taken, for surfaces whose size and features are about 1 (`step` sets the scale).

Paper: Sec. 5.2.
"""

import numpy as np

from .parallelogram import _lib

STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60}  # of the first derivative, odd in the offset
STEP = 0.01


def tangents(surface, u, v, step=STEP):
    """(X_u, X_v): triples of expressions for symbols, arrays (3, ...) for numbers.

    Numbers: accurate to about 1e-13 where the surface is smooth on +-3 steps around (u, v).

    Paper: Sec. 5.2 (first form).
    """
    if _lib(u, v) is not np:
        X = surface.coordinates(u, v)
        return tuple(tuple(x.diff(t) for x in X) for t in (u, v))
    return _difference(_points(surface), u, v, step)


def _points(surface):
    return lambda u, v: np.moveaxis(surface.point(u, v), -1, 0)


def _difference(f, u, v, h):
    """Both first derivatives of an array-valued function."""
    u, v = np.asarray(u, dtype=float), np.asarray(v, dtype=float)
    along_u = sum(c * (f(u + k * h, v) - f(u - k * h, v)) for k, c in STENCIL.items()) / h
    along_v = sum(c * (f(u, v + k * h) - f(u, v - k * h)) for k, c in STENCIL.items()) / h
    return along_u, along_v


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def first_form(surface, u, v, step=STEP):
    """(E, F, G) = (X_u . X_u, X_u . X_v, X_v . X_v) at the parameters u, v.

    u, v: sympy symbols (exact, not simplified), or numbers or arrays (see `tangents`).

    Paper: Sec. 5.2 (first form).
    """
    a, b = tangents(surface, u, v, step)
    return _dot(a, a), _dot(a, b), _dot(b, b)


def second_form(surface, u, v, step=STEP):
    """(L, M, N), the products of X_uu, X_uv and X_vv with the unit normal X_u x X_v / |.|.

    u, v: sympy symbols (exact, not simplified), or numbers or arrays (about 1e-11).

    Paper: Sec. 5.2, Sec. 5.3 (principal nets).
    """
    a, b = tangents(surface, u, v, step)
    if _lib(u, v) is not np:
        uu, uv = (tuple(x.diff(t) for x in a) for t in (u, v))
        vv = tuple(x.diff(v) for x in b)
    else:
        (uu, uv), (_, vv) = (
            _difference(lambda *p, k=k: np.stack(tangents(surface, *p, step)[k]), u, v, step)
            for k in (0, 1)
        )
    E, F, G = _dot(a, a), _dot(a, b), _dot(b, b)
    normal = tuple(a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3))
    area = _lib(u, v).sqrt(E * G - F * F)
    return tuple(_dot(x, normal) / area for x in (uu, uv, vv))


def mean_curvature(surface, u, v, step=STEP):
    """The mean curvature (E N - 2 F M + G L) / (2 (E G - F^2)); zero on minimal surfaces.

    u, v as in `second_form`.

    Paper: Sec. 5.2 (minimal surfaces).
    """
    E, F, G = first_form(surface, u, v, step)
    L, M, N = second_form(surface, u, v, step)
    return (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F))
