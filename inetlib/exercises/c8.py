"""The exercises of chapter 8: how large the quads are, and what kind of surface it is."""

import numpy as np
import sympy as sp

from .engine import Exercise


def _grid(m, n, turn=0):
    """The quads of m x n cells; turn: 1 closes it to a ring, 2 to a torus, -1 to a strip."""

    def at(i, j):
        if turn and i == m:
            i, j = 0, n - j if turn < 0 else j
        return i * (n + 1) + (j % n if turn == 2 else j)

    cells = np.ndindex(m, n)
    return np.array([[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)] for i, j in cells])


def _meshes(rng):
    """Disks, rings, sheets with holes, a torus, a Moebius strip, a sphere, two parts."""
    sphere = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ]
    sheet, ring = _grid(7, 5), _grid(8, 3, 1)
    found = [sheet, sheet[:1], ring, _grid(6, 5, 2), _grid(9, 2, -1), np.array(sphere)]
    found += [np.delete(sheet, [7], axis=0), np.delete(sheet, [7, 27], axis=0)]
    found += [np.concatenate([sheet, ring + 60]), np.array(sphere)[1:]]
    found += [F[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3) for F in (found[0], found[3], found[7])]
    return [(rng.permutation(F) + int(rng.integers(3)),) for F in found]


def _parts(F):
    """(vertices, edges, faces, boundary edges) of a mesh, as sets and lists."""
    sides = [
        frozenset(pair) for row in F.tolist() for pair in zip(row, row[1:] + row[:1], strict=True)
    ]
    border = [side for side in set(sides) if sides.count(side) == 1]
    return set(F.ravel().tolist()), set(sides), F, border


def _loops(border):
    """How many pieces the boundary has: edges with a common end are joined."""
    pieces = []
    for edge in border:
        touching = [piece for piece in pieces if piece & edge]
        pieces = [p for p in pieces if not p & edge] + [set(edge).union(*touching)]
    return len(pieces)


def _topology(F):
    vertices, edges, faces, border = _parts(F)
    return _loops(border), len(vertices) - len(edges) + len(faces)


def _euler(F, vertices=1, edges=1, largest=False):
    """(loops, Euler number), wrongly."""
    v, e, f, border = _parts(F)
    count = F.max() + 1 if largest else len(v)
    return _loops(border), vertices * count - edges * len(e) + len(f)


def _sizes(rng):
    some = [(0.1, 300, 300), (0.1, 300, 1200), (2.0, 100, 25)]
    return some + [
        (float(rng.uniform(0.01, 3)), *rng.integers(50, 3000, 2).tolist()) for _ in range(10)
    ]


EXERCISES = [
    Exercise(
        name="8.1",
        title="The size for a number of quads",
        level="write a function",
        minutes=5,
        task="`answer(size, count, wanted)`: a net with edges of this mean length has `count` "
        "quads. Which `size` has about `wanted` of them, on the same surface, with the same"
        " angles?",
        hint="How does the area of one quad grow with its edges?",
        kind="function",
        instances=_sizes,
        truth=lambda size, count, wanted: np.exp(np.log(size) + np.log(count / wanted) / 2),
        mistakes=[
            (
                "Linear: edges of half the length make four times as many quads.",
                lambda s, n, w: s * n / w,
            ),
            ("Upside down: more quads are smaller ones.", lambda s, n, w: s * np.sqrt(w / n)),
            ("Upside down, and linear.", lambda s, n, w: s * w / n),
            ("Squared: a root is wanted.", lambda s, n, w: s * (n / w) ** 2),
            ("A cubic root is for volumes.", lambda s, n, w: s * np.cbrt(n / w)),
            ("The size that there is, is lost.", lambda s, n, w: np.sqrt(n / w)),
            ("That is the same size again.", lambda s, n, w: s),
        ],
    ),
    Exercise(
        name="8.2",
        title="Which kind of surface",
        level="write a function",
        minutes=20,
        task="`answer(F)`: (boundary loops, Euler number) of a mesh of triangles or quads, F of "
        "the shape (faces, 3) or (faces, 4); without `mesh`. Not every number is one of a vertex.",
        hint="The Euler number is V - E + F. An edge is a pair of vertices in either order, and "
        "one of the boundary belongs to one face only; follow these from vertex to vertex.",
        kind="function",
        instances=_meshes,
        truth=lambda F: _topology(F),
        mistakes=[
            (
                "Numbers that no face uses are not vertices: count with np.unique.",
                lambda F: _euler(F, largest=True),
            ),
            (
                "Each inner edge is counted twice, once for each of its faces.",
                lambda F: (_topology(F)[0], len(_parts(F)[0]) - F.size + len(F)),
            ),
            (
                "The sign of the faces: V - E + F.",
                lambda F: (_topology(F)[0], _topology(F)[1] - 2 * len(F)),
            ),
            (
                "The Euler number is 2 minus the loops on a sphere with holes: not on others.",
                lambda F: (_topology(F)[0], 2 - _topology(F)[0]),
            ),
            (
                "These are the edges of the boundary: in how many loops do they lie?",
                lambda F: (len(_parts(F)[3]), _topology(F)[1]),
            ),
            ("Loops first, then the Euler number.", lambda F: _topology(F)[::-1]),
            (
                "Half as many edges as sides of faces: that is so where all edges have two faces.",
                lambda F: (_topology(F)[0], len(_parts(F)[0]) - F.size / 2 + len(F)),
            ),
            (
                "How many loops, not whether there is one.",
                lambda F: (min(_topology(F)[0], 1), _topology(F)[1]),
            ),
        ],
    ),
    Exercise(
        name="8.3",
        title="The edge for an area",
        level="prove",
        minutes=10,
        task="A flat sheet of the area A is covered by N congruent quads of a sheared grid. How "
        "long is the edge along u? A sympy expression in `A, N, mu, theta0`.",
        hint="In a sheared grid the edges are the medial lines: the other one is 1 / mu times as "
        "long, at the angle theta0.",
        kind="expression",
        instances=lambda rng: [
            (1.0, 100, 1.0, np.pi / 2),
            *map(tuple, rng.uniform([0.5, 20, 0.4, 0.4], [5, 900, 2.5, 2.7], (11, 4)).tolist()),
        ],
        truth=lambda A, N, mu, theta0: sp.sqrt(A * mu / (N * sp.sin(theta0))),
        mistakes=[
            (
                "That is the edge along v: mu is the quotient of the edges, u over v.",
                lambda A, N, mu, t: sp.sqrt(A / (N * mu * sp.sin(t))),
            ),
            (
                "mu is lost: the quads are not rhombuses.",
                lambda A, N, mu, t: sp.sqrt(A / (N * sp.sin(t))),
            ),
            ("The root is lost.", lambda A, N, mu, t: A * mu / (N * sp.sin(t))),
            ("A scalar product is no area.", lambda A, N, mu, t: sp.sqrt(A * mu / (N * sp.cos(t)))),
            ("A tangent is no height.", lambda A, N, mu, t: sp.sqrt(A * mu / (N * sp.tan(t)))),
            (
                "The sine is on the wrong side: a slanted quad has less area for its edges.",
                lambda A, N, mu, t: sp.sqrt(A * mu * sp.sin(t) / N),
            ),
            (
                "A factor 2: a quad has the area of two triangles.",
                lambda A, N, mu, t: sp.sqrt(2 * A * mu / (N * sp.sin(t))),
            ),
        ],
    ),
]
