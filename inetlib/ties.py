"""Comparisons of computed numbers that may tie: equal ones are decided by index.

Numbers that are equal by symmetry differ in their last digits, on each processor in others."""

import numpy as np
from numpy.typing import ArrayLike

TIE = 1e-9  # relative: far above rounding, far below what anybody draws


def at_most(a: ArrayLike, b: ArrayLike) -> ArrayLike:
    """Whether a <= b or they tie; not negative."""
    return a <= b * (1 + TIE)


def first_largest(values: ArrayLike, scale: float = 0.0) -> int:
    """The index of the first of the largest numbers, not negative.

    scale: a size beside which the numbers are rounded, where they may all be zero.

    >>> first_largest([1.0, 3.0 - 1e-15, 3.0])
    1"""
    values = np.asarray(values)
    return int(np.argmax(at_most(values.max(), values + TIE * scale)))


def first_smallest(values: ArrayLike, scale: float = 0.0) -> int:
    """The index of the first of the smallest numbers; as `first_largest`."""
    values = np.asarray(values)
    return int(np.argmax(at_most(values, values.min() + TIE * scale)))


def nearest_whole(x: ArrayLike) -> np.ndarray:
    """The nearest whole number, int64; halves go down, and so do numbers within 1e-9 of one."""
    return np.ceil(np.asarray(x) - 0.5 - TIE).astype(np.int64)


def ranks(values: ArrayLike, tolerance: float) -> np.ndarray:
    """0 for the smallest numbers, 1 for the next ones, ...; neighbours within it share a rank."""
    values = np.asarray(values)
    order = np.argsort(values, kind="stable")
    found = np.empty(len(values), dtype=np.int64)
    found[order] = np.cumsum(np.diff(values[order], prepend=values[order[:1]]) > tolerance)
    return found
