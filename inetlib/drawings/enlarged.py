"""One parallelogram of a net in space, enlarged, with its angles as they are measured."""

import numpy as np

from .. import measure, plot

NAMES = "d1", "d2", "u", "v"  # the families along d1, d2, m13 and m24 of a face
WIDE, HIGH = 1.0, 0.6  # half the room of the quad
GAP = 0.2  # between the quad and the words


def flat(V, Q, face, right=2):
    """The quad `face` seen along the normal of its parallelogram: (4, 2), as large as the room.

    right: which of d1, d2, m13, m24 points to the right."""
    corners = V[Q[face]]
    d1, d2, m13, m24 = (x[0] for x in measure.vectors(V, Q[[face]]))
    normal = np.cross(d1, d2)
    right = (d1, d2, m13, m24)[right]
    axes = [x / np.linalg.norm(x) for x in (right, np.cross(normal, right))]
    points = (corners - corners.mean(axis=0)) @ np.transpose(axes)
    points -= (points.min(axis=0) + points.max(axis=0)) / 2
    return points / np.max(np.abs(points) / [WIDE, HIGH])


def parallelogram(ax, corners, names=NAMES, width=1.2, radii=(0.2, 0.16)):
    """That of a plane quad, sides and diagonals in the colours of families, and both angles.

    radii: of the arcs of theta and theta0, in units of the longer diagonal."""
    left, low, right, top = middles = (corners + np.roll(corners, -1, axis=0)) / 2
    plot.polygons(ax, middles, [[0, 1, 2, 3]], plot.FILL, zorder=1)
    pairs = [[left, low], [top, right]], [[left, top], [low, right]], [[left, right]], [[low, top]]
    for name, lines in zip(names, pairs, strict=True):
        plot.curves(ax, lines, plot.COLOURS[name], width, zorder=3)
    long = max(np.linalg.norm(right - left), np.linalg.norm(top - low))
    plot.angle(ax, left, low - left, top - left, radii[0] * long)
    plot.angle(ax, (left + right) / 2, right - left, top - low, radii[1] * long)


def words(V, Q, face):
    """Both angles of a face in two lines of TeX."""
    angles = (np.degrees(x[0]) for x in measure.angles(V, Q[[face]]))
    names = r"\theta", r"\theta_0"
    return "\n".join(rf"${n}={x:.1f}\degree$" for n, x in zip(names, angles, strict=True))


def draw(ax, V, Q, face, names=NAMES, size=8.5, reach=1.0, more=""):
    """A picture of the quad `face` with its parallelogram, and beside it its angles in words.

    ax: axes of their own, see `below`; names: see `NAMES`, "u" points to the right where it is a
    diagonal; size: of the words, in points; reach: their width, in half widths of the quad; more:
    lines below them."""
    ax.set_in_layout(False)
    ax.set_axis_off()
    corners = flat(V, Q, face, 2 + names[2:].index("u") if "u" in names[2:] else 2)
    plot.polygons(ax, corners, [[0, 1, 2, 3]], "#f0f2f5", zorder=0)
    for name, pairs in zip(names[2:], ([[1, 2], [0, 3]], [[1, 0], [2, 3]]), strict=True):
        plot.curves(ax, corners[pairs], plot.COLOURS[name], 0.7)
    parallelogram(ax, corners, names)
    text = words(V, Q, face) + ("\n" + more if more else "")
    half = corners[:, 0].max()
    ax.text(half + GAP, 0, text, va="center", size=size, linespacing=1.35)
    middle, room = (GAP + reach) / 2, WIDE + 0.05 + (GAP + reach) / 2
    ax.set(xlim=(middle - room, middle + room), ylim=(-HIGH - 0.05, HIGH + 0.05), aspect="equal")


def below(ax, ratio, room=0.3):
    """Make room in a panel under what it shows; axes there, for `draw`.

    ratio: width over height of what the panel shows, which is made as large as can be; room: the
    height of the new axes, in its heights."""
    (left, bottom), (right, top) = ax.dataLim.get_points()
    high = 1.03 * max(top - bottom, (right - left) / ratio)
    x, y = (left + right) / 2, (bottom + top) / 2
    ax.set(xlim=(x - ratio * high / 2, x + ratio * high / 2))
    ax.set(ylim=(y - (0.5 + room) * high, y + high / 2))
    return ax.inset_axes(place(room))


def place(room):
    """Where they are, as `inset_axes` asks, in a panel with so much room, see `below`."""
    return [0, 0, 1, 0.97 * room / (1 + room)]
