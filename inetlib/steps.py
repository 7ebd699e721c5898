"""Steps of the reduced formulation: two residuals a face, no auxiliary variables.

The unknowns are the vertices V and the freedom s of the goal (see `goals`).  A shape step
balances the angles against the shape energies of the paper; an angle step is the smallest
change of the net that meets the linearised angles.

Paper: Sec. 6.3 (beyond the paper).
"""

import time
from contextlib import contextmanager

import numpy as np
from scipy.sparse import bsr_array, diags_array

from . import constraints, linear
from .goals import logs
from .problem import shape

REGULAR = 1e-12  # of the mean diagonal, in the matrix of an angle step


@contextmanager
def timed(seconds, name):
    """Add the seconds that the block takes to seconds[name].

    Paper: Table 1 (seconds).
    """
    start = time.perf_counter()
    yield
    seconds[name] = seconds.get(name, 0.0) + time.perf_counter() - start


def equations(problem, V, goal, s, quadratic=False):
    """(residual (2 f,), Jacobian (2 f, 3 n), slopes (2 f, k)) of the angles at the net V.

    Zero residual: log lam and log mu of every face are those of the goal at the freedom s;
    the Jacobian is in V and minus `slopes` in s.  quadratic: `constraints.scaled_ratios`.

    Paper: Eq. (11), Eq. (12).
    """
    wanted, slopes = logs(goal, s)
    corners = V[problem.Q].reshape(-1, 12)
    if quadratic:
        residual, jacobian = constraints.scaled_ratios(
            corners, *np.exp(wanted), constraints.sizes(corners)
        )
    else:
        residual, jacobian = constraints.log_ratios(corners)
        residual = residual - wanted
    J = linear.rows(jacobian, linear.coordinates(problem.Q), V.size)
    return residual.ravel(), J, np.tile(slopes, (len(corners), 1))


def shape_step(problem, V, goal, s, seconds, quadratic=False):
    """(change of V, change of s) of one Gauss-Newton step on all energies.

    All lengths are measured in mean edges, so the step does not depend on the scale.

    Paper: Sec. 6.3 (target function, with logarithms of the ratios).
    """
    with timed(seconds, "assemble"):
        residual, J, slopes = equations(problem, V, goal, s, quadratic)
        f, G = residual * problem.edge, slopes * problem.edge
        root = np.repeat(np.sqrt(problem.mobility), 3)
        J = linear.scaled(J, problem.edge * root)
        A, g = shape(problem, V)
        if (root != 1).any():
            A = linear.scaled(linear.scaled(A, root).T.tocsr(), root)
        A = A + J.T @ J
        diagonal = A.diagonal() + np.repeat(problem.weights.closeness, 3)
        A.setdiag(diagonal + REGULAR * diagonal.mean())
        right = np.column_stack([root * g + J.T @ f, J.T @ G])
    with timed(seconds, "factor"):
        solve = problem.shape_factor(A)
    with timed(seconds, "solve"):
        y = solve(right)
        ds = _freedom(
            G.T @ G - right[:, 1:].T @ y[:, 1:],
            G.T @ f - right[:, 1:].T @ y[:, 0],
        )
        d = root * (y[:, 1:] @ ds - y[:, 0])
    return d.reshape(-1, 3), ds


def _freedom(A, b):
    """Solution of the small system of the freedom s (0, 1 or 2 unknowns)."""
    if not (len(b) and np.isfinite(A).all() and np.isfinite(b).all()):
        return np.full(len(b), np.nan)  # no freedom, or a run that has diverged
    return np.linalg.lstsq(A, b, rcond=None)[0]


def angle_step(problem, V, goal, s, seconds, quadratic=False):
    """(change of V, change of s): the smallest change to the linearised angles.

    Smallest in the sum of |d|^2 / mobility over the vertices.  On a surface (`on_surface`)
    the vertices go to their closest points and move along the tangent planes there.

    Paper: Sec. 6.3 (beyond the paper: minimum-norm Newton steps).
    """
    with timed(seconds, "assemble"):
        residual, J, slopes = equations(problem, V, goal, s, quadratic)
        free, root, lift = _metric(problem, V)
        f = residual + J @ lift
        J = free(J)
        S = J @ J.T
        diagonal = S.diagonal()
        S.setdiag(diagonal + REGULAR * diagonal.mean())
        right = np.column_stack([f, slopes])
    with timed(seconds, "factor"):
        solve = problem.angle_factor(S)
    with timed(seconds, "solve"):
        y = solve(right)
        ds = _freedom(slopes.T @ y[:, 1:], slopes.T @ y[:, 0])
        d = lift - root @ (J.T @ (y[:, 0] - y[:, 1:] @ ds))
    return d.reshape(-1, 3), ds


def _metric(problem, V):
    """(free, root, lift): J -> J R, the matrix R, and the way onto the surface.

    R R^T tells how freely the coordinates move: by the mobility, on a surface along it.
    """
    root = np.sqrt(problem.mobility)
    if not problem.on_surface:
        root = np.repeat(root, 3)
        return lambda J: linear.scaled(J, root), diags_array(root), np.zeros(V.size)
    feet, normals = problem.reference.closest(V)
    blocks = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) * root[:, None, None]
    count = len(V)
    R = bsr_array((blocks, np.arange(count), np.arange(count + 1)), shape=(V.size, V.size)).tocsr()
    lift = np.where(root[:, None] > 0, feet - V, 0.0).ravel()
    return lambda J: J @ R, R, lift
