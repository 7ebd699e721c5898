"""A small z-buffer: smooth shaded surfaces as pictures, and what of a curve is in front of them.

Pixels are decided in whole numbers (corners are rounded to a grid finer than a pixel), so that
the last digits of coordinates, which differ between machines, do not show."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import ArrayLike
from scipy.ndimage import minimum_filter, uniform_filter

SUB = 64  # corners are rounded to 1/SUB of a pixel
DEEP = 1 << 20  # steps of the depth
CHUNK = 1 << 21  # pixels of boxes of triangles that are tried at once
MARGIN = 5.37  # pixels around a scene; no whole number, lest its middle falls between two
LIGHT = -0.35, 0.6, 0.72  # direction of the light: right, up, towards the viewer
AMBIENT, DIFFUSE = 0.68, 0.32
INSIDE = 0.88  # brightness of the back side
HOLLOWS = (0.012, 0.3), (0.05, 0.25)  # radius and strength of the darkening in hollows
CREASE = 0.025  # of the scene's size: a step in depth that gets a silhouette line
LINE = 0.55  # brightness of these lines
APART = 1.47  # pixels between the points of a curve that are tried
NEXT = 1e-6  # pixels: closer points of a curve are one


class Buffer(NamedTuple):
    """What is seen at each pixel (h, w), row 0 on top."""

    depth: np.ndarray  # nearness to the viewer, -inf where nothing is seen
    face: np.ndarray  # number of the triangle, -1 where nothing is seen
    weights: np.ndarray  # (h, w, 3) barycentric coordinates in it


def buffer(xy: np.ndarray, near: np.ndarray, T: np.ndarray, shape: tuple) -> Buffer:
    """The `Buffer` of triangles T (t, 3) with corners at xy (n, 2), in pixels from the lower left.

    near (n,): nearness; shape: (h, w).  Of equally near triangles the first is seen."""
    h, w = shape
    x, y = np.round(xy * SUB).astype(np.int64).T
    low, high = near.min(), near.max()
    best = np.full(h * w, -1, dtype=np.int64)
    corners = np.stack([x[T], y[T]], axis=2)
    first = np.maximum(-((SUB // 2 - corners.min(axis=1)) // SUB), 0)  # columns, rows of centres
    last = np.minimum((corners.max(axis=1) - SUB // 2) // SUB, [w - 1, h - 1])
    size = np.maximum(last - first + 1, 0)
    sides = _sides(corners.astype(float))  # whole numbers below 2^53 are exact, and fast
    area = sides[2].sum(axis=0)
    sides *= np.sign(area)  # all turn alike, and what has no area is not seen
    sides[2][:, area == 0] = -1
    area = np.abs(area)
    count = np.where(area > 0, size.prod(axis=1), 0)
    ends = np.cumsum(count)
    step = (near[T] - low) / ((high - low) or 1)
    start = 0
    while start < len(T):
        stop = max(start + 1, int(np.searchsorted(ends, (ends[start - 1] if start else 0) + CHUNK)))
        k = np.repeat(np.arange(start, stop), count[start:stop])
        place = np.arange(len(k)) - np.repeat(
            ends[start:stop] - count[start:stop], count[start:stop]
        )
        place += ends[start - 1] if start else 0
        row, column = np.divmod(place, size[k, 0])
        row, column = row + first[k, 1], column + first[k, 0]
        for side in range(3):  # what is outside of one need not be tried at the next
            inside = np.flatnonzero(_part(sides, side, k, column, row) >= 0)
            k, row, column = k[inside], row[inside], column[inside]
        depth = np.einsum("ij,ij->i", _parts(sides, k, column, row), step[k]) / area[k]
        key = np.round(DEEP * depth).astype(np.int64) * len(T) + (len(T) - 1 - k)
        np.maximum.at(best, (h - 1 - row) * w + column, key)
        start = stop
    seen = np.flatnonzero(best >= 0)
    face = np.full(h * w, -1)
    face[seen] = len(T) - 1 - best[seen] % len(T)
    row, column = np.divmod(seen, w)
    parts = _parts(sides, face[seen], column, h - 1 - row)
    weights = np.zeros((h * w, 3))
    weights[seen] = parts / area[face[seen], None]
    depth = np.full(h * w, -np.inf)
    depth[seen] = np.sum(weights[seen] * near[T[face[seen]]], axis=1)
    return Buffer(depth.reshape(shape), face.reshape(shape), weights.reshape(h, w, 3))


def _sides(corners):
    """Coefficients (3, 3, t) of `_parts`, in x, in y, and constant, for the three sides."""
    x, y = corners[:, [1, 2, 0]].transpose(2, 1, 0)
    u, v = corners[:, [2, 0, 1]].transpose(2, 1, 0)
    return np.stack([y - v, u - x, x * v - y * u])


def _part(sides, side, k, column, row):
    """Twice the area, with sign, that a pixel's centre makes with a side of k."""
    a, b, c = (one[side].take(k) for one in sides)
    return a * (column * float(SUB) + SUB // 2) + b * (row * float(SUB) + SUB // 2) + c


def _parts(sides, k, column, row):
    """These for the three sides, (., 3)."""
    return np.stack([_part(sides, side, k, column, row) for side in range(3)], axis=1)


def picture(seen: Buffer, normals: np.ndarray, colours: np.ndarray, T: np.ndarray) -> np.ndarray:
    """RGBA (h, w, 4) in [0, 1] of what is seen.

    normals (n, 3): unit normals at the vertices as the viewer has them (right, up, towards);
    colours (t, 3) of the triangles."""
    there = seen.face >= 0
    face = seen.face[there]
    normal = np.einsum("ki,kij->kj", seen.weights[there], normals[T[face]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-9)[:, None]
    front = normal[:, 2] >= 0
    normal[~front] *= -1
    light = np.asarray(LIGHT) / np.linalg.norm(LIGHT)
    bright = AMBIENT + DIFFUSE * np.clip(normal @ light, 0, 1)
    bright *= np.where(front, 1, INSIDE)
    size = max(seen.depth.shape)
    image = np.zeros((*there.shape, 4))
    image[there, :3] = colours[face] * bright[:, None]
    image[there, 3] = 1
    image[..., :3] *= _hollows(seen.depth, there, size)[..., None]
    image[_creases(seen.depth, there, size), :3] *= LINE
    return image


def _hollows(depth, there, size):
    """Brightness (h, w) of ambient light: less where what is around is nearer to the viewer."""
    bright = np.ones(depth.shape)
    solid = np.where(there, depth, 0.0)
    for radius, strength in HOLLOWS:
        reach = radius * size
        weight, mean = (_blurred(x, reach) for x in (there.astype(float), solid))
        above = (mean / np.maximum(weight, 1e-6) - solid) / reach
        bright *= 1 - strength * np.clip(above, 0, 1)
    return bright


def _blurred(x, reach):
    """Means over squares, twice, so that these leave no trace."""
    width = 2 * int(reach) + 1
    return uniform_filter(uniform_filter(x, width, mode="constant"), width, mode="constant")


def _creases(depth, there, size):
    """Where a surface ends in front of another one, or of nothing: boolean (h, w)."""
    nothing = depth[there].min(initial=0) - size
    solid = np.where(there, depth, nothing)
    return solid - minimum_filter(solid, 3, mode="constant", cval=nothing) > CREASE * size


class Picture(NamedTuple):
    """A scene made by `render`."""

    image: np.ndarray  # RGBA (h, w, 4) in [0, 1]
    extent: tuple  # left, right, bottom, top in the camera's coordinates
    seen: Buffer
    planes: np.ndarray  # (t, 3): depth of the triangles at x, y: their product with (x, y, 1)
    scale: float  # pixels in a unit of length
    lift: float  # of a layer over the one below, in pixels


def render(view: Callable, layers: Sequence, pixels: int = 1000, lift: float = 0.003) -> Picture:
    """The `Picture` of surfaces.

    view: a `plot.camera`; layers: (V (n, 3), faces (f, 3 or 4), a colour or one a face), shaded
    smoothly where faces share vertices; pixels: of the longer side.  Later layers lie over the
    earlier ones by `lift`, a part of the longer side, and by what quads are bent."""
    points, faces, normals, colours, over, bent = [], [], [], [], [], 0.0
    for k, (V, F, colour) in enumerate(layers):
        V, sides = np.asarray(V, dtype=float), F.shape[1]
        normal = np.cross(V[F[:, 2]] - V[F[:, 0]], V[F[:, -1]] - V[F[:, 1]])
        if sides == 4:
            area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
            apart = np.abs(np.einsum("ij,ij->i", V[F[:, 1]] - V[F[:, 0]], normal)) / area
            bent = max(bent, 1.35 * apart.max())
        around = [np.bincount(F.ravel(), np.repeat(x, sides), len(V)) for x in normal.T]
        around = np.stack(around, axis=1)
        length = np.maximum(np.linalg.norm(around, axis=1), 1e-300)
        T = np.stack([F[:, [0, i, i + 1]] for i in range(1, sides - 1)], axis=1).reshape(-1, 3)
        colour = np.atleast_2d(to_rgb(colour) if isinstance(colour, str) else colour)[:, :3]
        faces.append(T + sum(map(len, points)))
        points.append(V)
        normals.append(around / length[:, None])
        colours.append(np.repeat(np.broadcast_to(colour, (len(F), 3)), sides - 2, axis=0))
        over.append(np.full(len(V), k))
    every = map(np.concatenate, (points, faces, normals, colours, over))
    return _rendered(view, pixels, lift, bent, *every)


def _rendered(view, pixels, lift, bent, V, T, normals, colours, over):
    (right, up), towards = view(np.eye(3))[0].T, view(np.eye(3))[1]
    xy, near = view(V)
    low, high = xy.min(axis=0), xy.max(axis=0)
    size = (high - low).max() or 1.0
    scale = pixels / size
    lift = lift * pixels + bent * scale
    w, h = np.ceil((high - low) * scale + 2 * MARGIN).astype(int).tolist()
    xy = (xy - low) * scale + MARGIN
    near = near * scale + over * lift
    seen = buffer(xy, near, T, (h, w))
    image = picture(seen, normals @ np.column_stack([right, up, towards]), colours, T)
    left, bottom = low - MARGIN / scale
    extent = left, left + w / scale, bottom, bottom + h / scale
    return Picture(image, extent, seen, _planes(xy, near, T), scale, lift)


def _planes(xy, near, T):
    """Coefficients (t, 3) of the depth of each triangle, in x, in y, and constant."""
    (x, y), z = np.moveaxis(xy[T], 2, 0), near[T]
    one, two = ([c[:, i] - c[:, 0] for c in (x, y, z)] for i in (1, 2))
    area = one[0] * two[1] - one[1] * two[0]
    area = np.where(np.abs(area) > 1e-9, area, np.inf)
    by_x = (one[2] * two[1] - two[2] * one[1]) / area
    by_y = (two[2] * one[0] - one[2] * two[0]) / area
    return np.stack([by_x, by_y, z[:, 0] - by_x * x[:, 0] - by_y * y[:, 0]], axis=1)


def in_front(scene: Picture, view: Callable, lines: Sequence, layers: int = 1) -> list[np.ndarray]:
    """The parts of polylines (k, 3) that are seen, in space and in their order: a list of (., 3).

    layers: how many of the scene's layers they may lie beneath."""
    lines = [np.asarray(line, dtype=float) for line in lines]
    if not lines:
        return []
    points, counts = np.concatenate(lines), np.array(list(map(len, lines)))
    last = np.cumsum(counts) - 1
    first = last - counts + 1
    xy = view(points)[0] * scene.scale
    step = np.linalg.norm(np.diff(xy, axis=0, prepend=xy[:1]), axis=1)
    step[first] = 1.0  # from one line to the next
    way = np.cumsum(step)
    long = way[last] - way[first]
    tries = np.maximum(2, (long / APART).astype(int) + 1)
    owner = np.repeat(np.arange(len(lines)), tries)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(tries) - tries, tries)
    tried = way[first][owner] + number / (tries - 1)[owner] * long[owner]
    seen = visible(scene, view, _at(points, way, tried), layers)
    cuts = np.flatnonzero((seen[1:] != seen[:-1]) | (owner[1:] != owner[:-1])) + 1
    begin, end = np.append(0, cuts), np.append(cuts, len(tried)) - 1
    shown = seen[begin] & (end > begin)
    begin, end = tried[begin[shown]], tried[end[shown]]
    inner = np.searchsorted(way, [begin + NEXT, end - NEXT])
    ends = _at(points, way, begin)[:, None], _at(points, way, end)[:, None]
    every = zip(ends[0], *inner, ends[1], strict=True)
    return [np.concatenate([start, points[i:j], stop]) for start, i, j, stop in every]


def _at(line, way, s):
    return np.stack([np.interp(s, way, x) for x in line.T], axis=1)


def visible(scene: Picture, view: Callable, points: ArrayLike, layers: int = 1) -> np.ndarray:
    """Whether each of the points (k, 3) on the surfaces is seen: boolean (k,)."""
    xy, near = view(points)
    depth, (h, w) = scene.seen.depth, scene.seen.depth.shape
    xy = (xy - [scene.extent[0], scene.extent[2]]) * scene.scale
    column, row = np.floor(xy).astype(int).T
    inside = (column >= 0) & (column < w) & (row >= 0) & (row < h)
    at = h - 1 - np.clip(row, 0, h - 1), np.clip(column, 0, w - 1)
    # The depth is known at the middle of the pixel; what is seen there goes on as a plane.
    most, exact = 4 * scene.lift, depth[at]
    seen = np.isfinite(exact)
    plane = scene.planes[scene.seen.face[at][seen]]
    there = np.einsum("ij,ij->i", plane, np.column_stack([xy[seen], np.ones(seen.sum())]))
    exact[seen] += np.clip(there - exact[seen], -most, most)
    return ~inside | (near * scene.scale >= exact - (layers - 0.25) * scene.lift)
