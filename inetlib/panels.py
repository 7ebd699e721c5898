"""Faces of any number of corners: shapes, bars between them, which are the same up to a tolerance.

Panels are index arrays into V (n, 3); lengths have the unit of V, angles are radians."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely
from scipy.spatial import cKDTree

from . import mesh, ties


class Shapes(NamedTuple):
    """Of p panels that have c corners in all, one panel after the other."""

    area: np.ndarray  # (p,) of the largest shadow: along the normal, of a quad d1 x d2
    planarity: np.ndarray  # (p,) thickness along the normal: of a quad, between the diagonals
    centre: np.ndarray  # (p, 3) mean of the corners
    angle: np.ndarray  # (c,) inside of the panel, in (0, 2 pi)
    height: np.ndarray  # (c,) of the corners along the normal, over the centre


def _groups(panels: Sequence) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """(numbers (g,), corners (g, k)) of the panels with k corners, for every k."""
    sizes = np.array([len(panel) for panel in panels])
    for size in np.unique(sizes):
        numbers = np.flatnonzero(sizes == size)
        yield numbers, np.array([panels[k] for k in numbers])


def area_vectors(P: np.ndarray) -> np.ndarray:
    """The vector areas (g, 3) of polygons P (g, k, 3): along the normal, as long as the shadow."""
    P = P - P[:, :1]
    return np.cross(P, np.roll(P, -1, axis=1)).sum(axis=1) / 2


def crossed(V: np.ndarray, panels: Sequence) -> np.ndarray:
    """The numbers of the panels whose sides cross or touch, seen along the normal; increasing."""
    found = [np.empty(0, dtype=np.int64)]
    for numbers, corners in _groups(panels):
        P = V[corners] - V[corners].mean(axis=1, keepdims=True)
        normal = area_vectors(P)
        axes = np.linalg.svd(normal[:, None])[2][:, 1:]  # two unit vectors across it
        shadows = np.einsum("gkx,gax->gka", P, axes)
        found.append(numbers[~shapely.is_valid(shapely.polygons(shadows))])
    return np.sort(np.concatenate(found))


def shapes(V: np.ndarray, panels: Sequence) -> Shapes:
    """The `Shapes` of panels; ValueError where one has no area."""
    first = np.cumsum([0, *map(len, panels)])
    area, planarity, centre = (np.empty((len(panels), *more)) for more in ((), (), (3,)))
    angle, height = np.empty((2, first[-1]))
    for numbers, corners in _groups(panels):
        P = V[corners]
        centre[numbers] = P.mean(axis=1)
        P = P - centre[numbers][:, None]
        out, back = np.roll(P, -1, axis=1) - P, np.roll(P, 1, axis=1) - P
        normal = area_vectors(P)
        area[numbers] = np.linalg.norm(normal, axis=1)
        flat = ~(area[numbers] > 1e-14 * np.sum(out**2, axis=(1, 2)))
        if flat.any():
            raise mesh.Fault("the panel {} has no area", corners[np.argmax(flat)], V)
        normal = normal / area[numbers][:, None]
        turn = np.cross(out, back)
        inside = np.arctan2(np.linalg.norm(turn, axis=2), np.sum(out * back, axis=2))
        hollow = np.einsum("gkx,gx->gk", turn, normal) < 0
        at = first[numbers][:, None] + np.arange(corners.shape[1])
        angle[at] = np.where(hollow, 2 * np.pi - inside, inside)
        height[at] = np.einsum("gkx,gx->gk", P, normal)
        planarity[numbers] = np.ptp(height[at], axis=1)
    return Shapes(area, planarity, centre, angle, height)


class Bars(NamedTuple):
    """The edges of panels with c corners in all, each once."""

    ends: np.ndarray  # (b, 2) nodes, the lower number first, in order
    panels: np.ndarray  # (b, 2) the panels there, -1 where there is no second one
    bar: np.ndarray  # (c,) from each corner to the next of its panel
    twin: np.ndarray  # (c,) the corner from which that bar runs the other way, or -1
    before: np.ndarray  # (c,) the corner before in its panel


def bars(corner: np.ndarray, first: np.ndarray) -> Bars:
    """The `Bars` of panels: corner (c,) the nodes, of panel k from first[k] to first[k + 1].

    ValueError for edges of more than two panels, and for panels oriented against each other."""
    after = np.arange(1, len(corner) + 1)
    after[first[1:] - 1] = first[:-1]
    ends, count = np.stack([corner, corner[after]]), corner.max() + 1
    owner = np.repeat(np.arange(len(first) - 1), np.diff(first))
    low, high = np.sort(ends, axis=0)
    key, bar, often = np.unique(low * count + high, return_inverse=True, return_counts=True)
    order, last = np.argsort(bar, kind="stable"), np.cumsum(often) - 1
    one, two, inner = order[last - often + 1], order[last], often == 2
    clash = inner & (ends[0][one] == ends[0][two])
    for bad, words in ((often > 2, "has more than two panels"), (clash, "has both on one side")):
        if bad.any():
            where = ends[:, one[np.argmax(bad)]]
            raise mesh.Fault(f"the edge {{}} {words}: the net is no oriented manifold", where)
    twin = np.full(len(corner), -1)
    twin[one[inner]], twin[two[inner]] = two[inner], one[inner]
    sides = np.stack([owner[one], np.where(inner, owner[two], -1)], axis=1)
    return Bars(np.stack(np.divmod(key, count), axis=1), sides, bar, twin, np.argsort(after))


def go_on(family: np.ndarray, known: Bars, corner: np.ndarray) -> np.ndarray:
    """The families (b,) of bars, 1 or -1 and 0 where it is not known, where these tell it.

    At a node of four bars inside the net the opposite ones are of one family, the others not.
    corner (c,): the nodes, as in `bars`."""
    family, rim = family.copy(), known.ends[known.panels[:, 1] < 0]
    nodes, start = np.unique(corner, return_index=True)
    crossing = (np.bincount(known.ends.ravel())[nodes] == 4) & ~np.isin(nodes, rim)
    fan = [start[crossing]]
    for _ in range(3):
        fan.append(known.twin[known.before[fan[-1]]])
    around, signs = known.bar[np.stack(fan, axis=1)], np.array([1, -1, 1, -1])
    while True:
        told = np.sign(np.sum(family[around] * signs, axis=1))[:, None] * signs
        new = (family[around] == 0) & (told != 0)
        if not new.any():
            return family
        family[around[new]] = told[new]


def types(V: np.ndarray, panels: Sequence, tolerance: float) -> np.ndarray:
    """The type (p,) of each panel, from 0 on: a panel is of the first type that it agrees with.

    The first panel of each type, the one with the lowest number, is its pattern.  A panel agrees
    with it when they have as many corners and, begun at some corner and gone round in the same
    sense, all edges, diagonals and heights (`shapes`) differ by `tolerance` at most.  So mirror
    images are of different types, and two panels of one type differ by twice as much at most.
    Differences that tie with the tolerance (`ties`) are within it."""
    pattern, height = np.arange(len(panels)), shapes(V, panels).height
    first = np.cumsum([0, *map(len, panels)])
    for numbers, corners in _groups(panels):
        k = corners.shape[1]
        P, found = V[corners], np.full(len(numbers), -1)
        chords = [np.linalg.norm(np.roll(P, -s, axis=1) - P, axis=2) for s in range(1, k // 2 + 1)]
        X = np.stack([*chords, height[first[numbers][:, None] + np.arange(k)]], axis=1)
        rows = np.sort(X, axis=2).reshape(len(X), -1)  # differ no more than X, however it is turned
        tree, reach = cKDTree(rows), tolerance * (1 + 2 * ties.TIE)
        for i in range(len(numbers)):
            if found[i] < 0:
                near = np.array(tree.query_ball_point(rows[i], reach, p=np.inf))
                near, found[i] = near[found[near] < 0], i
                if len(near) == 1:
                    continue
                turned = (np.roll(X[near], s, axis=2) for s in range(k))
                off = np.min([np.abs(Y - X[i]).max(axis=(1, 2)) for Y in turned], axis=0)
                found[near[ties.at_most(off, tolerance)]] = i
        pattern[numbers] = numbers[found]
    return np.unique(pattern, return_inverse=True)[1]
