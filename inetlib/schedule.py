"""What a fabricator asks for first: the panels, the nodes and the bars of a net, as tables.

Panels, nodes and bars count from 1 in the tables and from 0 here.  The quads come first, in their
order, then the other faces; nodes are the vertices in their order, without those of no face."""

import csv
from collections.abc import Sequence
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from . import files, measure, mesh, panels, ties
from .parallelogram import check_positive

FAMILIES = "u", "v", "edge"
DIGITS = 10  # of an area, and of the net's diagonal, whose decimals all lengths have


class Schedule(NamedTuple):
    """The panels, nodes and bars of a net; lengths in the unit of V, angles in radians.

    The corners of panel k are the entries first[k] to first[k + 1] of flat arrays (c,)."""

    V: np.ndarray  # (n, 3) nodes
    valence: np.ndarray  # (n,) bars at each
    boundary: np.ndarray  # (n,) whether a bar of one panel only ends there
    whole: int  # how many panels, the first ones, are quads; the others are cut
    first: np.ndarray  # (p + 1,)
    corner: np.ndarray  # (c,) nodes
    neighbour: np.ndarray  # (c,) the panel across that bar, -1 at the boundary
    shape: panels.Shapes  # areas, planarities, angles
    type: np.ndarray  # (p,) see `panels.types`
    thetas: np.ndarray | None  # theta, theta0 (2, whole); None if quads do not agree on u and v
    bars: panels.Bars
    length: np.ndarray  # (b,)
    family: np.ndarray  # (b,) numbers in FAMILIES
    tolerance: float


def schedule(
    V: np.ndarray, Q: np.ndarray, polygons: Sequence = (), tolerance: float = 1e-3
) -> Schedule:
    """The `Schedule` of a net V (n, 3), Q (f, 4), and polygons: index arrays of other faces.

    tolerance: of `panels.types`, a length.  A bar is of a family as an edge of a quad, or because
    it goes on beyond a node (`panels.go_on`); others are edges.  ValueError for what
    `mesh.check_arrays` refuses, and for panels with a vertex twice, without area, more than two
    at an edge or oriented against each other."""
    tolerance = check_positive("tolerance", tolerance)
    V, Q = mesh.check_arrays(V, Q)
    faces = [*Q, *(np.asarray(polygon) for polygon in polygons)]
    for face in faces[len(Q) :]:
        different = np.unique(face)
        if len(different) < max(len(face), 3) or different[0] < 0 or different[-1] >= len(V):
            words = f"three or more different numbers from 0 to {len(V) - 1} are wanted"
            raise ValueError(f"a panel has the corners {face.tolist()}: {words}")
    first, flat = np.cumsum([0, *map(len, faces)]), np.concatenate(faces)
    labelled, known = mesh.is_labelled(Q), panels.bars(flat, first)
    family = np.zeros(len(known.ends), dtype=np.int64)
    if labelled:
        family[known.bar[: Q.size]] = np.tile([-1, 1, -1, 1], len(Q))
        family = panels.go_on(family, known, flat)
    used, number = np.unique(flat, return_inverse=True)
    ends = np.searchsorted(used, known.ends)
    twin = known.twin
    return Schedule(
        V=V[used],
        valence=np.bincount(ends.ravel()),
        boundary=np.isin(np.arange(len(used)), ends[known.panels[:, 1] < 0]),
        whole=len(Q),
        first=first,
        corner=number,
        neighbour=np.where(twin < 0, -1, np.searchsorted(first, twin, side="right") - 1),
        shape=panels.shapes(V, faces),
        type=panels.types(V, faces, tolerance),
        thetas=np.stack(measure.angles(V, Q)) if labelled else None,
        bars=known._replace(ends=ends),
        length=np.linalg.norm(V[known.ends[:, 1]] - V[known.ends[:, 0]], axis=1),
        family=np.array([2, 0, 1])[family],
        tolerance=tolerance,
    )


def places(path: str | Path, force: bool = False) -> list[Path]:
    """The three files of `write`; ValueError or OSError if one of them cannot be written."""
    path = Path(path)
    if path.suffix.lower() != ".csv":
        raise ValueError(f"{path}: tables are written, the name ends with .csv")
    found = [path.with_name(path.stem + more + path.suffix) for more in ("", "_nodes", "_bars")]
    for one in found:
        files.check_place(one, force)
        if one.exists():
            one.open("r+b").close()  # on Windows a table that another program shows is locked
    return found


def write(path: str | Path, found: Schedule, force: bool = False) -> list[Path]:
    """Write the panels, NAME.csv, NAME_nodes.csv and NAME_bars.csv beside it: all or none.

    Lengths and coordinates have `decimals`, areas 10 digits, angles are degrees with 6 decimals.
    Errors as `places`, FileExistsError without `force`."""
    paths = places(path, force)
    with ExitStack() as stack:  # they get their names when all are written, the panels last
        new = [stack.enter_context(files.replacing(one)) for one in paths]
        for name, rows in zip(new, (_panel_rows, _node_rows, _bar_rows), strict=True):
            with open(name, "w", encoding="utf-8", newline="") as file:
                csv.writer(file, lineterminator="\n").writerows(rows(found))
    return paths


def decimals(found: Schedule) -> int:
    """Behind the point, of lengths and coordinates: with them the diagonal has ten digits."""
    diagonal = np.linalg.norm(np.ptp(found.V, axis=0))
    return max(0, DIGITS - 1 - int(np.floor(np.log10(diagonal) + ties.TIE)))


def _written(values, digits):
    return [f"{round(x, digits) + 0.0:.{digits}f}" for x in np.ravel(values).tolist()]


def _panel_rows(found):
    shape, digits, most = found.shape, decimals(found), np.diff(found.first).max()
    lists = {
        "node": (found.corner + 1).tolist(),
        "edge": _written(found.length[found.bars.bar], digits),
        "angle": _written(np.degrees(shape.angle), 6),
        "neighbour": [k or "" for k in (found.neighbour + 1).tolist()],
    }
    numbered = [f"{name}{k + 1}" for name in lists for k in range(most)]
    yield ["panel", "kind", "type", "area", "planarity", "theta", "theta0", *numbered]
    planarity, thetas = _written(shape.planarity, digits), []
    if found.thetas is not None:
        thetas = [*zip(*(_written(np.degrees(x), 6) for x in found.thetas), strict=True)]
    for k, (start, end) in enumerate(pairwise(found.first.tolist())):
        kind, blank = "whole" if k < found.whole else "cut", [""] * (most - end + start)
        cells = [x for values in lists.values() for x in values[start:end] + blank]
        pair = thetas[k] if k < len(thetas) else ("", "")
        area = f"{shape.area[k]:.{DIGITS}g}"
        yield [k + 1, kind, found.type[k] + 1, area, planarity[k], *pair, *cells]


def _node_rows(found):
    yield ["node", "x", "y", "z", "valence", "boundary"]
    digits = decimals(found)
    for k, point in enumerate(found.V):
        where = "yes" if found.boundary[k] else "no"
        yield [k + 1, *_written(point, digits), found.valence[k], where]


def _bar_rows(found):
    yield ["bar", "node1", "node2", "length", "family", "panel1", "panel2"]
    lengths = _written(found.length, decimals(found))
    ends, sides = found.bars.ends + 1, (found.bars.panels + 1).tolist()
    for k, nodes in enumerate(ends.tolist()):
        family = FAMILIES[found.family[k]]
        yield [k + 1, *nodes, lengths[k], family, *(x or "" for x in sides[k])]


def numbers(found: Schedule) -> dict:
    """Counts, the number of types, the total length of each family, rounded as in the tables."""
    digits, count = decimals(found), len(found.shape.area)
    totals = np.bincount(found.family, found.length, minlength=3)
    return {
        "panels": count,
        "whole": found.whole,
        "cut": count - found.whole,
        "types": int(found.type.max()) + 1,
        "tolerance": found.tolerance,
        "nodes": len(found.V),
        "bars": len(found.length),
        "lengths": {k: round(x, digits) for k, x in zip(FAMILIES, totals.tolist(), strict=True)},
        "area": float(f"{found.shape.area.sum():.{DIGITS}g}"),
        "planarity": round(float(found.shape.planarity.max()), digits),
        "decimals": digits,
    }


def text(found: Schedule) -> str:
    """The `numbers` in words."""
    about = numbers(found)
    lengths = ", ".join(f"{k} {x:.6g}" for k, x in about["lengths"].items())
    return (
        "{panels} panels, {whole} whole and {cut} cut, of {types} types up to {tolerance:g}; "
        "{nodes} nodes, {bars} bars\n"
        "area {area:.6g}, up to {planarity:.3g} out of plane; total length of the bars: "
        "{lengths}\n"
        "lengths have {decimals} decimals, angles are degrees"
    ).format(**about | {"lengths": lengths})
