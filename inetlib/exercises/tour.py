"""Five minutes of notebook 0: the reader changes one thing in a net, and is told what happened."""

import numpy as np

from .. import measure, mesh
from .engine import Checked

GO = "Now write {} in the place of {}, and run the cell again."


def _angles(V, Q):
    """The middle of the angles of all faces, theta and theta0 in degrees."""
    return np.median(np.degrees(measure.angles(V, Q)), axis=1)


def _off(V, Q, theta=60.0, theta0=60.0):
    """By how many degrees each face is off these angles."""
    return np.degrees(measure.deviations(V, Q, *np.radians([theta, theta0]))).max(axis=0)


def angle(V: np.ndarray, Q: np.ndarray) -> tuple[bool, str]:
    """Whether the net has other angles than 60 and 60 degrees, and the ratios of both."""
    means = _angles(V, Q)
    lam, mu = (np.median(x) for x in measure.ratios(V, Q))
    words = f"{len(Q)} faces: theta = {means[0]:.2f}, theta0 = {means[1]:.2f} degrees"
    if _off(V, Q, *means).max() > 1e-6:
        return False, f"{words}, but not in all of them. Change nothing but the marked number."
    words += f", lam = {lam:.5f}, mu = {mu:.5f}, each the same in all of them."
    if np.abs(means - 60).max() < 0.01:
        return False, f"{words} Both ratios are the golden ratio. {GO.format(75, 'the first 60')}"
    return True, f"{words} Two angles go with two ratios: who knows one pair knows the other."


def power(V: np.ndarray, Q: np.ndarray) -> tuple[bool, str]:
    """Whether the angles differ between the faces, and by how much."""
    off = _off(V, Q).max()
    if off < 1e-6:
        words = "the angles are the same in all faces, to less than a millionth of a degree."
        return False, f"{words} {GO.format(-1, 2)}"
    words = f"now some face is {off:.2f} degrees off. Both maps keep the angles of curves,"
    return True, f"{words} but a face has straight edges: only a few maps keep those of all faces."


def cells(V: np.ndarray, Q: np.ndarray) -> tuple[bool, str]:
    """How much finer the cells are, and what is left of the error."""
    side = round(np.sqrt(len(Q)))
    off = _off(V, Q).max()
    words = f"{side} by {side} cells, off by up to {off:.3f} degrees."
    if side <= 8 or side % 2:
        return False, f"{words} {GO.format(16, 8)}"
    sparse = V.reshape(side + 1, side + 1, 3)[::2, ::2].reshape(-1, 3)
    coarse = _off(sparse, mesh.grid_quads(side // 2, side // 2)).max()
    words += f" Without every second line it was {coarse:.3f}: {off / coarse:.2f} of that is left."
    words += " The finer the cells, the nearer that comes to a quarter"
    return True, f"{words}: try 32." if side < 32 else f"{words}."


def labels(V: np.ndarray, Q: np.ndarray) -> tuple[bool, str]:
    """By how many quarter turns the labels are off the top left corner, and what that does."""
    turns = (int(Q[0].argmin()) - 1) % 4
    theta, theta0 = _angles(V, Q)
    words = f"theta = {theta:.2f}, theta0 = {theta0:.2f} degrees"
    if turns == 0:
        return False, f"from the top left {words}. {GO.format(1, 0)}"
    if turns == 2:
        return True, f"a half turn: {words}, as from the top left. Only d1, d2 change their signs."
    words = f"a quarter turn: {words}. These are the supplements, and both ratios are inverted"
    return True, f"{words}: no error is raised, and it is another net than you asked for. Try 2."


def vertex(V: np.ndarray, Q: np.ndarray) -> tuple[bool, str]:
    """How many faces a push at one vertex changes."""
    off = _off(V, Q)
    changed = int((off > 1e-6).sum())
    if not changed:
        return False, f"no face is off. {GO.format(0.05, 0)}"
    words = f"{changed} of {len(Q)} faces are off, by up to {off.max():.2f} degrees, the others"
    words += " not at all: angles are measured face by face. Notebook 6 shows the way back."
    return True, words


STEPS = {f"tour.{k + 1}": f for k, f in enumerate((angle, power, cells, labels, vertex))}


def judge(name: str, answer: object) -> Checked:
    """What a step of the tour says of a net (V, Q)."""
    try:
        V, Q = (np.asarray(part) for part in answer)  # type: ignore[attr-defined]
        right, words = STEPS[name](V, Q)
    except (TypeError, ValueError, IndexError):
        return Checked(False, "a net (V, Q) is wanted: change nothing but the marked number.")
    return Checked(right, words)
