"""Regular grids inside a mesh: found, refined by splines, and their smallest steps by waves.

In a plane of places the equations of all faces look alike, so that J J^T is nearly inverted
by fast transforms.  A face's place is a pair of whole numbers (i, j), u running along i and
v along j."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import fft
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.linalg import LinearOperator, cg

from .sparse import BLAS

ACROSS = np.array([[-1, 0], [0, -1], [1, 0], [0, 1]])  # from a face to its neighbours, in places
LOOSE = 4  # places in the box around a piece for each face, at most
LONGEST = 10  # times the eigenvalue of a wave twice as long as the piece: none counts for less
SAMPLES = 5000  # faces, about, for the mean couplings
MOST = 300  # iterations; more is a sign of a net without any order
# neighbours of a face, and the corners it shares with them, its own one first
SHARED = {
    (1, 0): [(2, 1), (3, 0)],
    (0, 1): [(0, 1), (3, 2)],
    (1, 1): [(3, 1)],
    (1, -1): [(2, 0)],
}


class Piece(NamedTuple):
    """Where the faces of a mesh are in a grid."""

    place: np.ndarray  # (f, 2), from 0 on
    period: np.ndarray  # (2,), the step around a ring, whose places break off somewhere; else 0


def find(Q: np.ndarray, neighbours: np.ndarray) -> tuple[np.ndarray, Piece | None]:
    """(Q (f, 4) with all faces turned like the first one, their `Piece` of a grid).

    neighbours: `mesh.face_neighbours(Q)`.  None for the piece where two faces would have the
    same place, where the mesh is in several parts, and where most places would be empty."""
    count = len(Q)
    face, edge = np.nonzero(neighbours >= 0)
    other = neighbours[face, edge]
    graph = csr_array((np.ones(len(face), dtype=np.int8), (face, other)), shape=(count, count))
    order, before = breadth_first_order(graph, 0)
    if len(order) < count:
        return Q, None
    before[0] = 0
    slot = np.argmax(neighbours[before] == np.arange(count)[:, None], axis=1)
    alike = Q[np.arange(count), (slot + 2) % 4] == Q[before, (slot + 1) % 4]
    sign, place = np.where(alike, 1, -1), ACROSS[slot]
    sign[0], place[0] = 1, 0
    while before.any():  # twice as far back each time
        place = place[before] + sign[before, None] * place
        sign, before = sign[before] * sign, before[before]
    place -= place.min(axis=0)
    jumps = place[other] - place[face] - sign[face, None] * ACROSS[edge]
    period = jumps[np.argmax(jumps.any(axis=1))]
    once = [(jumps == k * period).all(axis=1) for k in (0, 1, -1)]
    piece = Piece(place, period * int(np.any(once, axis=0).all()))
    at, box = _boxed(piece)[:2]
    alone = np.prod(box) <= LOOSE * count and np.bincount(at @ [box[1], 1]).max() == 1
    turned = np.where(sign[:, None] < 0, np.roll(Q, 2, axis=1), Q)
    return turned, piece if alone else None


def _boxed(piece):
    """(places (f, 2) in a box, its size, the axis along a ring, shift): axes swapped if it is 1.

    A ring begins again after box[0] steps along it and, in part, of one across: `shift` is
    what is left of that at each step, (box[0],), and at its end the step across."""
    along = int(abs(piece.period[1]) > abs(piece.period[0]))
    order = [1, 0] if along else [0, 1]
    at, (k, across) = piece.place[:, order], piece.period[order]
    if not k:
        return at, [fft.next_fast_len(int(n), real=True) for n in at.max(axis=0) + 1], 0, None
    k, across = int(abs(k)), int(np.sign(k) * across)
    at = at - (at[:, :1] // k) * [k, across]
    steps = np.arange(k + 1) * across
    at[:, 1] -= (steps // k)[at[:, 0]]
    at[:, 1] -= at[:, 1].min()
    shift = np.append((steps % k)[:-1] / k, across)
    return at, [k, fft.next_fast_len(int(at[:, 1].max()) + 1, real=True)], along, shift


def vertices(Q: np.ndarray, place: np.ndarray) -> np.ndarray | None:
    """The vertices (m+1, n+1) of a mesh that is a whole grid of m x n quads, or None."""
    m, n = place.max(axis=0) + 1
    if m * n != len(Q):
        return None
    (i, j), grid = place.T, np.empty((m + 1, n + 1), dtype=np.int64)
    at = (i, j + 1), (i, j), (i + 1, j), (i + 1, j + 1)
    for where, corner in zip(at, Q.T, strict=True):
        grid[where] = corner
    fits = all((grid[where] == corner).all() for where, corner in zip(at, Q.T, strict=True))
    return grid if fits and len(np.unique(grid)) == grid.size else None


def solve(
    piece: Piece, J: csr_array, b: np.ndarray, tolerance: float, more: float
) -> np.ndarray | None:
    """y (2 f, k) with J J^T y = b (2 f, k), by conjugate gradients; None where they fail.

    J: two rows for each face at its place, the entries of its four corners one after another;
    tolerance: relative residual.  Each face is scaled by the Cholesky factor of its 2 x 2
    block, `more` added to its diagonal; what remains is nearly the same everywhere: see `waves`."""
    count, width = len(piece.place), J.data.size // len(b)
    i00, i10, i11 = _scale(J.data.reshape(count, 2, width), more)
    one, two = np.moveaxis(J.data.reshape(count, 2, width), 1, 0)
    rows = np.empty((2, count, width), dtype=np.float32)
    rows[0], rows[1] = i00[:, None] * one, i10[:, None] * one + i11[:, None] * two
    index = np.moveaxis(J.indices.reshape(count, 2, width), 1, 0).ravel()
    J = csr_array((rows.ravel(), index, J.indptr), shape=J.shape)  # all rows are of one length
    back, nearly = J.T, waves(piece, rows.reshape(2, count, 4, -1))
    matrix = LinearOperator((len(b),) * 2, lambda y: J @ (back @ y), dtype=np.float32)
    nearly = LinearOperator((len(b),) * 2, nearly, dtype=np.float32)
    columns = []
    with BLAS.limit(limits=1, user_api="blas"):  # more threads only wait here
        for column in b.T if np.isfinite(b).all() else ():
            one, two = column.reshape(-1, 2).T
            scaled = np.concatenate([i00 * one, i10 * one + i11 * two]).astype(np.float32)
            y, left = cg(matrix, scaled, rtol=tolerance, maxiter=MOST, M=nearly)
            one, two = y.reshape(2, -1)
            columns += [] if left else [np.stack([i00 * one + i10 * two, i11 * two], 1).ravel()]
    return np.stack(columns, axis=1) if len(columns) == b.shape[1] else None


def waves(piece: Piece, rows: np.ndarray) -> Callable:
    """A function z(r), symmetric positive definite, nearly the inverse of J J^T, r (2 f,).

    rows (2, f, 4, k): those of J, corner by corner, scaled so that the block of every face is
    the unit matrix.  With the mean couplings of neighbours the rest is inverted by fast sine
    transforms in a whole grid, else by Fourier transforms in a box, with zeros at the places
    without a face.  In single precision."""
    at, box, along, shift = _boxed(piece)
    whole = shift is None and (piece.place.max(axis=0) + 1).prod() == len(piece.place)
    there, back, turn, box = _sines(piece.place) if whole else _circles(box, along, shift)
    at = (piece.place if whole else at) @ [box[1], 1]
    w00, w01, w11 = _inverse_waves(piece.place, rows, turn, max(box))
    w10 = w01.conj()

    def apply(r):
        z = np.zeros((2, box[0] * box[1]), dtype=np.float32)
        for plane, values in zip(z, r.reshape(2, -1), strict=True):
            plane[at] = values
        one, two = there(z.reshape(2, *box))
        z = np.empty((2, *one.shape), dtype=one.dtype)
        np.add(w00 * one, w01 * two, out=z[0])
        np.add(w10 * one, w11 * two, out=z[1])
        return back(z).reshape(2, -1).take(at, axis=1, mode="clip").ravel()

    return apply


def _sines(place):
    """(transform, its inverse, step -> what it makes of a wave, box) in a whole grid."""
    box = [int(k) for k in place.max(axis=0) + 1]
    a, b = (np.pi * np.arange(1, k + 1) / (k + 1) for k in box)

    def there(z):
        return fft.dstn(z, type=1, norm="ortho", axes=(1, 2), overwrite_x=True)

    return there, there, lambda step: np.cos(step[0] * a)[:, None] * np.cos(step[1] * b), box


def _circles(box, along, shift):
    """The same in a box that begins again where it ends: see `_boxed`."""
    a = 2 * np.pi * np.arange(box[0])[:, None] / box[0]
    b = 2 * np.pi * np.arange(box[1] // 2 + 1) / box[1]
    phase = np.ones(1, dtype=np.float32)
    if shift is not None:  # a wave across is out of step after a turn
        a = a - b * shift[-1] / box[0]
        phase = np.complex64(np.exp(1j * shift[:-1, None] * b))

    def there(z):
        return fft.fft(phase * fft.rfft(z), axis=1, overwrite_x=True)

    def back(z):
        z = phase.conj() * fft.ifft(z, axis=1, overwrite_x=True)
        return fft.irfft(z, n=box[1], overwrite_x=True)

    return there, back, lambda step: np.exp(1j * (step[along] * a + step[1 - along] * b)), box


def _scale(rows, more):
    """Entries 00, 10, 11 of the inverse Cholesky factors of the faces' blocks, (3, f)."""
    pairs = (0, 0), (0, 1), (1, 1)
    d00, d01, d11 = (np.einsum("fk,fk->f", rows[:, a], rows[:, b]) for a, b in pairs)
    d00, d11 = d00 + more, d11 + more
    i00, i11 = 1 / np.sqrt(d00), 1 / np.sqrt(d11 - d01**2 / d00)
    return np.stack([i00, -i11 * d01 / d00, i11])


def _inverse_waves(place, rows, turn, longest):
    """Entries 00, 01, 11 of the inverses of the 2 x 2 blocks of all waves."""
    table = np.full(place.max(axis=0) + 3, -1)  # empty places around: no face has them
    table[tuple((place + 1).T)] = np.arange(len(place))
    s00, s01, s11 = 1.0, 0.0, 1.0
    some = np.arange(0, len(place), 1 + len(place) // SAMPLES)
    for step, corners in SHARED.items():
        other = table[tuple((place[some] + 1 + step).T)]
        face, other = some[other >= 0], other[other >= 0]
        C = np.zeros((2, 2))
        for one, two in corners:
            C += np.einsum("qfk,pfk->qp", rows[:, face, one], rows[:, other, two])
        C /= max(len(face), 1)
        there = turn(step)
        s00 = s00 + 2 * C[0, 0] * there.real
        s11 = s11 + 2 * C[1, 1] * there.real
        s01 = s01 + C[0, 1] * there + C[1, 0] * there.conj()
    lowest = (s00 + s11) / 2 - np.sqrt((s00 - s11) ** 2 / 4 + abs(s01) ** 2)
    lift = np.maximum(0, LONGEST * (np.pi / longest) ** 2 - lowest)
    s00, s11 = s00 + lift, s11 + lift
    area = s00 * s11 - abs(s01) ** 2
    mixed = np.complex64 if np.iscomplexobj(s01) else np.float32
    return np.float32(s11 / area), mixed(-s01 / area), np.float32(s00 / area)


def levels(m: int, n: int, coarse: int = 20) -> list[tuple[int, int]]:
    """The sizes [(m0, n0), ..., (m, n)] of the grids from coarse to fine, each about doubled."""
    if not coarse >= 4:
        raise ValueError(f"coarse = {coarse}: at least 4 quads are wanted")
    sizes = [(m, n)]
    while min(m, n) > 1.5 * coarse or m * n > 4 * coarse**2:
        m, n = (-(-k // 2) if k > coarse else k for k in (m, n))
        sizes.insert(0, (m, n))
    return sizes


def refine(P: np.ndarray, m: int, n: int) -> np.ndarray:
    """The grid P (3, ., .) at m x n quads, by cubic splines through its points."""
    if P.shape[1:] == (m + 1, n + 1):
        return P
    from scipy.interpolate import RectBivariateSpline  # slow to import

    here = [np.linspace(0, 1, k) for k in P.shape[1:]]
    there = np.linspace(0, 1, m + 1), np.linspace(0, 1, n + 1)
    kx, ky = (min(3, len(x) - 1) for x in here)
    return np.stack([RectBivariateSpline(*here, x, kx=kx, ky=ky)(*there) for x in P])
