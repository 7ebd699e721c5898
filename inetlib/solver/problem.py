"""An optimisation problem: the checked input, and all that stays the same from step to step."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, diags_array, kron

from .. import measure, mesh
from ..reference import Reference
from . import lattice, residuals, sparse
from .goal import Goal

LARGE = 1600  # quads: of meshes with more it is found out whether they are pieces of grids
SOME = 5000  # vertices, about, tell how far away the reference is
FAR = 0.1  # a reference farther away on average (in its diagonals) is a mistake


class Weights(NamedTuple):
    """Weights of the shape energies, numbers >= 0 or arrays (n,), one number a vertex.

    The formulation "ratio" compares them with logarithms of ratios, lengths in mean edges;
    "paper" with squared lengths of a mesh of diagonal 1, so that numbers differ: `PAPER`."""

    fairness: float | np.ndarray = 0.02  # omega_2
    closeness: float | np.ndarray = 0.001  # omega_3
    approximation: float | np.ndarray = 0.1  # omega_4
    boundary: float | np.ndarray = 0.0003  # omega_5


PAPER = Weights(fairness=0.005, closeness=0.01, approximation=0.01, boundary=0.01)


class Problem(NamedTuple):
    """A checked problem: the arguments of `prepare`, and what they lead to."""

    V: np.ndarray
    Q: np.ndarray
    goal: Goal
    weights: Weights  # arrays (n,)
    reference: Reference | None
    on_surface: bool
    mobility: np.ndarray  # (n,)
    boundary: np.ndarray  # the vertices on it
    fair: Callable  # the matrix of fairness, made when it is first asked for
    neighbours: np.ndarray  # of the faces
    edge: float  # mean length
    rounding: float  # the angle by which rounding of V may turn the shortest edge
    shape_factor: sparse.Factor  # of the linear systems, one for each kind of step
    angle_factor: sparse.Factor
    quadratic: bool
    piece: lattice.Piece | None  # of a grid, if a large mesh is one
    seconds: dict  # {stage: seconds} spent so far


def prepare(
    V: np.ndarray,
    Q: np.ndarray,
    goal: Goal,
    weights: Weights | None = None,
    reference: Reference | None = None,
    on_surface: bool = False,
    fixed: str | Sequence | np.ndarray | None = None,
    mobility: np.ndarray | None = None,
    polygons: Sequence = (),
    quadratic: bool = False,
) -> Problem:
    """The `Problem` of a labelled mesh V (n, 3), Q (f, 4), or a ValueError that says what is wrong.

    on_surface: keep the vertices on the reference; fixed: vertex numbers, a mask or "boundary";
    mobility (n,), how easily each vertex moves, 0 not at all; polygons: faces that are no quads
    and bound no boundary of the net; quadratic: the kind of residual, see `run.equations`."""
    if isinstance(Q, (list, tuple)) and len({np.size(face) for face in Q}) > 1:
        face = next(k for k, corners in enumerate(Q) if np.size(corners) != 4)
        words = f"face {face} has {np.size(Q[face])} corners: give the quads as Q"
        raise ValueError(f"{words} and the other faces as polygons=[...]")
    V, Q = mesh.check(V, Q)
    mesh.require_labels(Q)
    measure.planarity(V, Q)  # refuses collapsed faces
    weights = _checked_weights(weights or Weights(), len(V))
    boundary = _boundary(Q, polygons)
    mobility = _mobility(mobility, fixed, boundary, len(V))
    if on_surface and reference is None:
        raise ValueError(
            "on_surface=True needs a reference surface (--on-surface: --reference FILE)"
        )
    if reference is not None:
        some = V[:: 1 + len(V) // SOME]
        apart = np.linalg.norm(some - reference.closest(some)[0], axis=1).mean()
        apart /= reference.diagonal
        if not apart < FAR:
            far = f"{apart:.3g} of its diagonal on average, at most {FAR} is wanted"
            raise ValueError(f"the reference is far away, {far}: move or scale one of the two")
    edges = np.linalg.norm(V[Q] - V[np.roll(Q, -1, axis=1)], axis=2)
    lengths = float(edges.mean()), 8 * np.spacing(np.abs(V).max()) / edges.min()
    factors = sparse.Factor(V), sparse.Factor(V[Q].mean(axis=1))
    fair = cache(lambda: _fairness(mesh.triples(Q), weights.fairness, len(V)))
    kept = goal, weights, reference, on_surface, mobility, boundary, fair
    neighbours, piece = mesh.face_neighbours(Q), None
    if len(Q) > LARGE:
        turned, piece = lattice.find(Q, neighbours)
        if (turned != Q).any():
            Q, neighbours = turned, mesh.face_neighbours(turned)
    return Problem(V, Q, *kept, neighbours, *lengths, *factors, quadratic, piece, {})


def shape(problem: Problem, V: np.ndarray) -> tuple[csr_array, np.ndarray]:
    """Matrix (3 n, 3 n) and half gradient (3 n,) of the energies of fairness, approximation
    and boundary gliding at the net V; the last two only with a reference."""
    A = problem.fair()
    g = A @ V.ravel()
    if problem.reference is None:
        return A, g
    weights, at = problem.weights, np.arange(len(V))
    near = residuals.distances(V, *problem.reference.closest(V))
    terms = [(at, weights.approximation, near)]
    if weights.boundary.any() and problem.reference.has_boundary and problem.boundary.size:
        at = problem.boundary
        feet, _, e2, e3 = problem.reference.boundary(V[at])
        terms.append((at, weights.boundary[at], residuals.distances(V[at], feet, e2, e3)))
    for at, weight, (residual, jacobian) in terms:
        J = sparse.rows(jacobian, sparse.coordinates(at[:, None]), V.size)
        W = diags_array(np.repeat(weight, residual.shape[1]))
        A = A + J.T @ W @ J
        g = g + J.T @ (W @ residual.ravel())
    return A, g


def _checked_weights(weights, count):
    found = {}
    for name, value in weights._asdict().items():
        value = np.asarray(value, dtype=float)
        if value.ndim and value.shape != (count,):
            words = f"weights.{name} has the shape {value.shape}: one number, or one for each of"
            raise ValueError(f"{words} the {count} vertices, is wanted")
        if not (np.isfinite(value).all() and (value >= 0).all()):
            raise ValueError(f"weights.{name} = {value.min():.6g}: weights are finite and >= 0")
        found[name] = np.broadcast_to(value, (count,))
    return Weights(**found)


def _mobility(mobility, fixed, boundary, count):
    """The mobility (n,), 0 for what is fixed."""
    mobility = np.ones(count) if mobility is None else np.array(mobility, dtype=float)
    if mobility.shape != (count,) or not np.isfinite(mobility).all() or (mobility < 0).any():
        raise ValueError(f"mobility: {count} finite numbers >= 0 are wanted, one for each vertex")
    if isinstance(fixed, str) and fixed != "boundary":
        raise ValueError(f'fixed = "{fixed}": vertex numbers, a mask or "boundary" is wanted')
    fixed = np.asarray(boundary if isinstance(fixed, str) else [] if fixed is None else fixed)
    if fixed.dtype == bool and fixed.shape != (count,):
        raise ValueError(f"fixed is a mask of shape {fixed.shape}: {count} entries are wanted")
    if fixed.dtype != bool and fixed.size and not (fixed.min() >= 0 and fixed.max() < count):
        raise ValueError(f"fixed names a vertex that is not there: 0 to {count - 1} are wanted")
    if fixed.size:
        mobility[fixed] = 0
    if not mobility.any():
        raise ValueError("no vertex is free to move: fix fewer")
    return mobility


def _boundary(Q, polygons):
    """The vertices on the boundary, without the rims of the given polygons."""
    loops = {frozenset(loop.tolist()): loop for loop in mesh.boundary_loops(Q)}
    for polygon in polygons:
        rim = frozenset(np.asarray(polygon).ravel().tolist())
        if loops.pop(rim, None) is None:
            words = f"polygon {sorted(rim)[:8]} is not a hole of the quad mesh: its corners must"
            raise ValueError(f"{words} be all the vertices of one boundary loop")
    return np.concatenate([np.zeros(0, dtype=np.int64), *loops.values()])


def _fairness(triples, weights, count):
    """The matrix of sum w |2 v - left - right|^2, (3 n, 3 n)."""
    J = sparse.rows(np.tile([[[-1.0, 2.0, -1.0]]], (len(triples), 1, 1)), triples, count)
    return kron(J.T @ (J * weights[triples[:, 1]][:, None]), np.eye(3), format="csr")
