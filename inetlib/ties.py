"""Comparisons of computed numbers that may tie: equal ones are decided by index.

The last digits of floating point differ between processors, so numbers that are equal by
symmetry come out equal on one machine and not on the next.  Here they count as equal.
"""

import numpy as np

TIE = 1e-9  # relative: far above rounding, far below what anybody draws


def at_most(a, b):
    """Whether a <= b, with b a little larger than it is: lengths that tie are at most equal.

    a, b: numbers or arrays, not negative.
    """
    return a <= b * (1 + TIE)


def first_largest(values, scale=0.0):
    """The index of the first of the largest numbers; values (k,), not negative.

    scale: a size beside which the numbers are rounded, where they may all be zero.

    >>> first_largest([1.0, 3.0 - 1e-15, 3.0])
    1
    """
    values = np.asarray(values)
    return int(np.argmax(at_most(values.max(), values + TIE * scale)))


def first_smallest(values, scale=0.0):
    """The index of the first of the smallest numbers; values (k,), not negative.

    scale: a size beside which the numbers are rounded, where they may be zero.
    """
    values = np.asarray(values)
    return int(np.argmax(at_most(values, values.min() + TIE * scale)))


def nearest_whole(x):
    """The nearest whole number, int64; halves go down, and so do numbers within 1e-9 of one.

    >>> int(nearest_whole(1.5)), int(nearest_whole(2.5 + 1e-12)), int(nearest_whole(-0.4))
    (1, 2, 0)
    """
    return np.ceil(np.asarray(x) - 0.5 - TIE).astype(np.int64)


def next_multiple(x, step):
    """The next multiple of a step, which x itself is when it is one up to 1e-9 of the step.

    >>> next_multiple(30 + 1e-12, 5), next_multiple(31, 5)
    (30.0, 35.0)
    """
    return float(np.ceil(x / step - TIE) * step)


def ranks(values, tolerance):
    """0 for the smallest numbers, 1 for the next ones, ...: int64 (k,).

    Numbers that follow each other by at most `tolerance` share a rank.
    """
    values = np.asarray(values)
    order = np.argsort(values, kind="stable")
    found = np.empty(len(values), dtype=np.int64)
    found[order] = np.cumsum(np.diff(values[order], prepend=values[order[:1]]) > tolerance)
    return found
