"""The same picture with fewer paths, for scenes that are large as files."""

import numpy as np
from matplotlib.path import Path

SHRUNK = 0.97  # faces that only touch a line do not hide it


def lighter(collection):
    """Join the line pieces of a `plot.scene` into one path a style wherever that shows the same.

    Lines wait, and are painted together, until a face comes that covers one of them.  The
    faces lose their own edges: for scenes whose lines cover all of these.  Returns the
    collection, changed."""
    faces = collection.get_facecolors()
    edges, widths = collection.get_edgecolors(), collection.get_linewidths()
    painted, waiting = [], []
    for path, fill, edge, width in zip(collection.get_paths(), faces, edges, widths, strict=True):
        if fill[3] == 0:
            waiting.append((path, tuple(edge), float(width)))
            continue
        if waiting and _covers(path.vertices, np.array([line.vertices for line, *_ in waiting])):
            painted += _joined(waiting)
            waiting = []
        painted.append((Path(path.vertices[:-1]), tuple(fill), "none", 0.0))
    paths, fills, edges, widths = zip(*painted, *_joined(waiting), strict=True)
    collection.set_paths(paths)
    collection.set_facecolors(fills)
    collection.set_edgecolors(edges)
    collection.set_linewidths(widths)
    return collection


def _covers(corners, lines):
    """Whether the face with these corners, the first one twice, lies over one of the lines."""
    near = (lines.max(axis=1) > corners.min(axis=0)) & (lines.min(axis=1) < corners.max(axis=0))
    middle = corners[:-1].mean(axis=0)
    face = Path(middle + SHRUNK * (corners - middle))
    return any(face.intersects_path(Path(line)) for line in lines[near.all(axis=1)])


def _joined(waiting):
    """One path a style, thin lines first."""
    for width, edge in sorted({(width, edge) for _, edge, width in waiting}):
        pieces = [path for path, *style in waiting if style == [edge, width]]
        yield Path.make_compound_path(*pieces), "none", edge, width
