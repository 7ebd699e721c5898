"""The exercises of chapter 5.1: straight lines on cones and cylinders, and chords of a bent net."""

import numpy as np
import sympy as sp

from .engine import Exercise


def _cones(rng):
    """Half vertex angles, some just below and just above those where a crossing is lost."""
    borders = [np.arcsin(1 / (2 * k)) + s for k in (1, 2, 3) for s in (1e-3, -1e-3)]
    return [(float(x),) for x in [*borders, 1.4, *rng.uniform(0.04, 0.8, 14)]]


def _crossings(gamma):
    """The line is d / cos(phi) away from the apex: pairs phi, -phi that k sectors join."""
    sector = 2 * np.pi * np.sin(gamma)
    return sum(1 for k in range(1, 200) if k * sector / 2 < np.pi / 2)


def _windings(turn, rise, r, lap=2 * np.pi, laps=range(-9, 10)):
    """The three shortest ways that go around by `turn` and more laps."""
    return np.sort([np.hypot(r * (turn + lap * k), rise) for k in laps])[:3]


def _points(rng):
    """Points side by side, above each other, opposite; less and more than one turn apart."""
    some = [(0.0, 1.5, 2.0), (np.pi, 0.0, 1.0), (2.0, 0.0, 0.5), (7.5, 1.0, 1.0), (-9.0, 0.4, 2.0)]
    return some + [tuple(x) for x in rng.uniform([-9, -3, 0.3], [9, 3, 2], (12, 3)).tolist()]


def _edges(rng):
    """Edges along and across the rulings, and others, on cylinders of less than half a turn."""
    some = [(0.0, 1.2, 0.8), (1.5, 0.0, 2.0)]
    return some + [tuple(x) for x in rng.uniform([0.2, 0.2, 0.2], [1.5, 2, 2], (10, 3)).tolist()]


EXERCISES = [
    Exercise(
        name="5.1.1",
        title="When a line stops crossing itself",
        level="change a number",
        minutes=5,
        task="A straight line that misses the apex is rolled up with the plane to a closed cone; "
        "gamma is the angle between rulings and axis. From which gamma on does the line not cross "
        "itself any more? `answer` in degrees.",
        hint="A closed cone is a sector of 2 pi sin(gamma) of the plane. Under which angle does "
        "one see a whole line from a point beside it?",
        kind="number",
        truth=30.0,
        tolerance=1e-3,
        mistakes=[
            ("That is the whole vertex angle: gamma is half of it.", 60.0),
            ("These are radians, degrees are wanted.", np.pi / 6),
            ("A half plane would be a sector of 2 gamma = pi: the sector has 2 pi sin.", 90.0),
            ("That is the sine of it.", 0.5),
            ("Seen from the apex the line fills pi, not pi / 2.", np.degrees(np.arcsin(0.25))),
            ("You took the cosine: gamma is measured from the axis.", np.degrees(np.arccos(0.25))),
        ],
    ),
    Exercise(
        name="5.1.2",
        title="How often a line crosses itself",
        level="write a function",
        minutes=15,
        task="`answer(gamma)`: how often a straight line that misses the apex crosses itself on "
        "the closed cone; gamma, in radians, is the angle between rulings and axis.",
        hint="Lay sector beside sector, and let the line run through them. Two of its points are "
        "one on the cone if they are equally far from the apex, a whole number of sectors apart.",
        kind="function",
        instances=_cones,
        truth=lambda gamma: _crossings(gamma),
        mistakes=[
            ("You count the sectors, one too many.", lambda g: np.ceil(1 / (2 * np.sin(g)))),
            (
                "Seen from the apex a line fills an angle of pi, not 2 pi.",
                lambda g: np.floor(1 / np.sin(g)),
            ),
            (
                "The sector of a cone is 2 pi sin(gamma), not the angle 2 gamma of its outline.",
                lambda g: np.floor(np.pi / (2 * g)),
            ),
            (
                "A tangent is the radius over the height: the sector takes radius over ruling.",
                lambda g: np.floor(1 / (2 * np.tan(g))),
            ),
            (
                "You took gamma from the base: it is the angle with the axis.",
                lambda g: np.floor(1 / (2 * np.cos(g))),
            ),
            ("gamma is in radians already.", lambda g: np.floor(1 / (2 * np.sin(np.radians(g))))),
            ("How often is a whole number.", lambda g: 1 / (2 * np.sin(g))),
        ],
    ),
    Exercise(
        name="5.1.3",
        title="The curvature of a helix",
        level="prove",
        minutes=10,
        task="A helix on a cylinder of the radius r rises by h in one full turn. Its curvature as "
        "a sympy expression in `r, h`.",
        hint="k cos(phi)^2, above, where phi is the angle with the direction of rolling: what are "
        "the two sides of the triangle that one turn unrolls to?",
        kind="expression",
        instances=lambda rng: [(2.0, 0.0), *map(tuple, rng.uniform(0.3, 5, (11, 2)).tolist())],
        truth=lambda r, h: 4 * sp.pi**2 * r / (4 * sp.pi**2 * r**2 + h**2),
        mistakes=[
            ("h is the rise of a full turn, not of one radian.", lambda r, h: r / (r**2 + h**2)),
            ("That is the curvature of the circle: the helix is less curved.", lambda r, h: 1 / r),
            (
                "The square is lost: it is cos(phi)^2.",
                lambda r, h: 1 / sp.sqrt(r**2 + (h / (2 * sp.pi)) ** 2),
            ),
            (
                "That is the torsion.",
                lambda r, h: 2 * sp.pi * h / (4 * sp.pi**2 * r**2 + h**2),
            ),
            (
                "That is the radius of curvature, the reciprocal.",
                lambda r, h: (4 * sp.pi**2 * r**2 + h**2) / (4 * sp.pi**2 * r),
            ),
            (
                "You took a sine: phi is the angle with the direction of rolling, not with the "
                "rulings.",
                lambda r, h: h**2 / (r * (4 * sp.pi**2 * r**2 + h**2)),
            ),
        ],
    ),
    Exercise(
        name="5.1.4",
        title="Three ways around a cylinder",
        level="write a function",
        minutes=10,
        task="`answer(turn, rise, r)`: the lengths of the three shortest geodesics, the shortest "
        "first, between two points of a cylinder of the radius r; one is `rise` higher, and `turn` "
        "radians further around, which may be more than a full turn or negative.",
        hint="Unroll the cylinder several times: each lap shows the second point once more.",
        kind="function",
        instances=_points,
        truth=lambda turn, rise, r: _windings(turn, rise, r),
        mistakes=[
            (
                "You go on in one direction only: the other way around may be shorter.",
                lambda t, h, r: _windings(t % (2 * np.pi), h, r, laps=range(9)),
            ),
            (
                "You begin at `turn` and go one lap on and back: it may be several laps itself.",
                lambda t, h, r: _windings(t, h, r, laps=(-1, 0, 1)),
            ),
            ("The radius is lost.", lambda t, h, r: _windings(t, h, 1)),
            ("A lap is 2 pi, not pi.", lambda t, h, r: _windings(t, h, r, lap=np.pi)),
            (
                "Length is measured on the surface, not through the air.",
                lambda t, h, r: np.hypot(2 * r * np.sin(t / 2), h) * np.ones(3),
            ),
            (
                "Sides of a right triangle: the root of the sum of their squares.",
                lambda t, h, r: _windings(t, 0, r) + abs(h),
            ),
            ("These are their squares.", lambda t, h, r: _windings(t, h, r) ** 2),
            ("The shortest first.", lambda t, h, r: _windings(t, h, r)[::-1]),
        ],
    ),
    Exercise(
        name="5.1.5",
        title="The chord of an edge",
        level="prove",
        minutes=10,
        task="An edge (x, y) of a flat net is rolled up, x along the direction of rolling, to a "
        "cylinder of the curvature k. The straight distance of its ends is which sympy expression "
        "in `x, y, k`?",
        hint="Look along the rulings: there the edge is an arc of the length x of a circle.",
        kind="expression",
        instances=_edges,
        truth=lambda x, y, k: (
            sp.sqrt((sp.cos(k * x) - 1) ** 2 + sp.sin(k * x) ** 2 + (k * y) ** 2) / k
        ),
        mistakes=[
            ("That is the length on the surface.", lambda x, y, k: sp.sqrt(x**2 + y**2)),
            (
                "The half angle: a chord is twice the sine of half the arc.",
                lambda x, y, k: sp.sqrt((sp.sin(k * x) / k) ** 2 + y**2),
            ),
            (
                "A factor 2 is lost: that is half a chord.",
                lambda x, y, k: sp.sqrt((sp.sin(k * x / 2) / k) ** 2 + y**2),
            ),
            (
                "A tangent is longer than the arc, a chord is shorter.",
                lambda x, y, k: sp.sqrt((2 * sp.tan(k * x / 2) / k) ** 2 + y**2),
            ),
            (
                "That is a cylinder of the radius k: the radius is 1 / k.",
                lambda x, y, k: sp.sqrt((2 * k * sp.sin(x / (2 * k))) ** 2 + y**2),
            ),
            (
                "That is its square.",
                lambda x, y, k: (2 * sp.sin(k * x / 2) / k) ** 2 + y**2,
            ),
        ],
    ),
]
