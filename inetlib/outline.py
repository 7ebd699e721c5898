"""Points, handles and closed outlines in the plane as complex numbers: read, checked, measured.

Paper: Sec. 3.3 (beyond the paper: B7).
"""

import numpy as np

from . import adjacency, ties

SAMPLES = 1000  # of an outline given as a function


def points(given, name, count=None):
    """Points of the plane as complex (k,); (k, 2) and (k, 3) arrays are read without their z.

    ValueError that begins with `name` for other shapes, for numbers that are not finite and
    for another number of points than `count`.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    given = np.asarray(given)
    if given.dtype.kind not in "iufc":
        raise ValueError(f"{name} is of type {given.dtype}: numbers are wanted")
    if given.ndim == 2 and given.shape[1] in (2, 3) and given.dtype.kind != "c":
        given = given[:, 0] + 1j * given[:, 1]
    given = np.atleast_1d(given).astype(complex)
    if given.ndim != 1:
        raise ValueError(
            f"{name} has the shape {given.shape}: complex numbers, or rows of two or three "
            "coordinates are wanted"
        )
    if count is not None and len(given) != count:
        raise ValueError(f"{name}: {count} points are wanted, not {len(given)}")
    if not np.isfinite(given).all():
        raise ValueError(f"{name}: point {np.argmin(np.isfinite(given))} is not finite")
    return given


def closed(given, name="boundary"):
    """A closed outline without repeated points, counter-clockwise, complex (k,), k >= 3.

    given: points as for `points`, the first may be repeated at the end; or a function of an
    array of parameters in [0, 1].  ValueError for fewer than three points.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    z = points(given(np.arange(SAMPLES) / SAMPLES) if callable(given) else given, name)
    z = z[z != np.roll(z, -1)]
    if len(z) < 3:
        raise ValueError(f"{name} has {len(z)} different points: at least three are wanted")
    return z if np.sum((np.conj(z) * np.roll(z, -1)).imag) > 0 else z[::-1]


def handles(given, count):
    """Vertex numbers (k,) and complex points (k,) of handles, both empty for None.

    given: (vertex numbers, points); ValueError for numbers outside 0 ... count - 1, for one
    that stands twice, and as in `points`.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    if given is None:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=complex)
    if len(given) != 2:
        raise ValueError(f"handles has {len(given)} parts: (vertex numbers, points) is wanted")
    held = _check_vertices(given[0], "handles", count)
    return held, points(given[1], "handles", len(held))


def _check_vertices(numbers, name, count):
    numbers = np.atleast_1d(np.asarray(numbers))
    if numbers.ndim != 1 or numbers.dtype.kind not in "iu" or not numbers.size:
        raise ValueError(f"{name}: a list of vertex numbers is wanted")
    bad = numbers[(numbers < 0) | (numbers >= count)]
    if bad.size:
        raise ValueError(f"{name} name vertex {bad[0]}: 0 to {count - 1} are wanted")
    found, often = np.unique(numbers, return_counts=True)
    if (often > 1).any():
        raise ValueError(f"{name} name vertex {found[np.argmax(often)]} twice")
    return numbers.astype(np.int64)


def loops(boundary, Q, count):
    """The outlines as a list of (vertex numbers, closed polyline), empty for None.

    boundary: an outline as for `closed`, which goes to the longest boundary loop of the
    faces Q (f, 4); or a list of (vertex numbers, outline).

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    if boundary is None:
        return []
    if isinstance(boundary, list) and all(_is_pair(part) for part in boundary):
        return [
            (_check_vertices(numbers, "boundary", count), closed(curve))
            for numbers, curve in boundary
        ]
    found = adjacency.boundary_loops(Q)
    if not found:
        raise ValueError("the mesh has no boundary to lay along an outline")
    return [(max(found, key=len), closed(boundary))]


def _is_pair(part):
    """Whether this is (vertex numbers, outline) and not the two coordinates of a point."""
    return isinstance(part, tuple) and len(part) == 2 and np.ndim(part[0]) == 1


def closest(z, outline):
    """The points of a closed polyline closest to z, and its unit tangents there: complex (k,).

    At a corner the tangent is perpendicular to the way from the closest point to z.  Of points
    equally close the one on the first side is taken.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    step = np.roll(outline, -1) - outline
    feet, tangents = np.empty((2, len(z)), dtype=complex)
    size = np.abs(outline - outline[0]).max()
    for k, point in enumerate(z):
        part = np.clip(((point - outline) / step).real, 0, 1)
        found = outline + part * step
        near = _nearest(found, np.abs(found - point), size)
        off, corner = point - found[near], part[near] in (0, 1)
        if corner and abs(off) > ties.TIE * abs(step[near]):
            along = 1j * off
        else:  # at a corner itself that of the side that leaves it
            along = step[(near + (part[near] > 1 - ties.TIE)) % len(step)]
        feet[k], tangents[k] = found[near], along / abs(along)
    return feet, tangents


def _nearest(feet, away, size):
    """The index of the nearest foot; of feet apart that are equally near, that of the first."""
    first = ties.first_smallest(away, size)
    around = np.abs(feet - feet[first]) < 1e-4 * size  # on the same side, or the next one
    return np.argmin(np.where(around, away, np.inf))


def spread(outline, count):
    """`count` points at equal distances along a closed polyline, from its first point on.

    Paper: Sec. 3.3 (beyond the paper: B7).
    """
    ring = np.append(outline, outline[0])
    length = np.concatenate([[0], np.cumsum(np.abs(np.diff(ring)))])
    return np.interp(np.arange(count) / count * length[-1], length, ring)
