"""How far the image of a finite cell under a conformal map is from the cell's own ratios.

A cell with the centre z and the edges u, v has the corners z +- u/2 +- v/2 and the complex
ratios K0 = (u + v) / (u - v) and R0 = v / u; its image under f has K and R, the same to
first order.  This module says what the next order is.

Paper: Sec. 3.3 (beyond the paper: B6).
"""

import numpy as np

from . import conformal


def cell_errors(f, z, u, v):
    """(ln K/K0, ln R/R0) of the image of a cell under f, complex.

    f: a function of a complex array; z, u, v: complex numbers, u and v not parallel.

    Paper: Sec. 3.3 (beyond the paper: B6).
    """
    if not (np.imag(np.conj(u) * v) != 0 and np.isfinite([z, u, v]).all()):
        raise ValueError(f"u = {u}, v = {v}: finite edges that are not parallel are wanted")
    cell = z + np.array([[-u - v, v - u], [u - v, u + v]]) / 2
    K, R = (x[0, 0] for x in conformal.complex_ratios(np.asarray(f(cell))))
    return np.log(K * (u - v) / (u + v)), np.log(R * u / v)


def leading_errors(first, third, u, v):
    """What `cell_errors` are to second order: (S u v / 6, S (u^2 - v^2) / 12), S = third / first.

    first, third: f' and f''' at the centre of the cell, numbers, arrays or sympy symbols;
    ValueError where the number f' is 0.

    Paper: Sec. 3.3 (beyond the paper: B6).
    """
    if not hasattr(first, "free_symbols") and not np.all(first):
        raise ValueError("f' = 0: the map is not conformal there")
    return third / first * u * v / 6, third / first * (u**2 - v**2) / 12


def kappa(f, z):
    """f'''/f' of a sympy expression f in the symbol z, simplified.

    Where it is a constant, and only there, the ratios of all images of congruent cells agree
    at every mesh size: f is then a + b z + c z^2 or a + b exp(gz) + c exp(-gz), kappa = g^2.
    This is the number that `conformal.sheared_grid` takes.  ValueError for a constant f.

    Paper: Sec. 3.3 (beyond the paper: B6).
    """
    import sympy

    f = sympy.sympify(f)
    if sympy.simplify(f.diff(z)) == 0:
        raise ValueError(f"{f} does not depend on {z}")
    return sympy.simplify(f.diff(z, 3) / f.diff(z))
