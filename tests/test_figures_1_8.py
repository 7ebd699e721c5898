"""What Figs. 1 to 6 and 8 draw, panel by panel: shapes, nets, and the lines of plane panels."""

from functools import cache, partial
from unittest.mock import patch

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.text import Annotation

from inetlib import parallelogram, raster
from inetlib.drawings import fig01, fig02, fig03, fig04, fig05, fig06, fig08

DEG = np.pi / 180
GOLDEN = (1 + 5**0.5) / 2


@cache
def drawn(module, *args, **named):
    """A drawing of the module, and its axes by the names of the panels, in order."""
    coarse = partial(raster.render, pixels=150)  # quick
    with patch.object(raster, "render", lambda view, layers, *_: coarse(view, layers)):
        drawing = module.draw(*args, **named)
    plt.close(drawing.figure)
    return drawing, drawing.figure.axes


def plane(points):
    return np.asarray(points) @ [1, 1j]


def pieces(ax, kind):
    """The polylines or polygons of one kind of collection, as complex arrays."""
    paths = [p for c in ax.collections if isinstance(c, kind) for p in c.get_paths()]
    return [plane(p.vertices) for p in paths]


def has_lines(ax, *lines):
    """Whether all these polylines are drawn, in either direction."""
    found = pieces(ax, LineCollection)
    return all(any(near(x, np.array(line)) < 1e-9 for x in found) for line in lines)


def near(one, other):
    """How far two polylines are apart at most, in the better direction."""
    if len(one) != len(other):
        return np.inf
    return min(abs(one - other).max(), abs(one - other[::-1]).max())


def turn(a, b):
    """The oriented angle from a to b, complex, in degrees."""
    return np.angle(b / a) / DEG


def far(*points):
    """All distances between points, sorted."""
    points = np.array(points)
    return np.sort(abs(points[:, None] - points)[np.triu_indices(len(points), 1)])


def angle(a, b):
    """The angle between vectors (..., 3), degrees."""
    sizes = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    return np.arccos(np.sum(a * b, axis=-1) / sizes) / DEG


def inner(V, Q):
    """Side vectors a, b (f, 3) of the parallelograms between the midpoints of the edges."""
    v1, v2, v3, v4 = np.asarray(V)[np.asarray(Q)].transpose(1, 0, 2)
    p12, p23, p34, p41 = (v1 + v2) / 2, (v2 + v3) / 2, (v3 + v4) / 2, (v4 + v1) / 2
    np.testing.assert_allclose(p23 - p12, p34 - p41, atol=1e-12)  # opposite sides are parallel
    return p23 - p12, p41 - p12


def quotient(a, b):
    return np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)


@pytest.mark.parametrize("degrees", [(70, 55, 60), (110, 40, 75), (50, 120, 100)])
def test_fig_1_shows_the_angles_and_the_two_similar_triangles(degrees):
    drawing, axes = drawn(fig01, *np.array(degrees) * DEG)
    theta, theta0, equal = degrees
    shapes = (drawing.data["general"], (theta, theta0)), (drawing.data["special"], (equal, equal))
    for ax, (shape, wanted) in zip(axes, shapes, strict=False):
        A, B, C, D = shape
        np.testing.assert_allclose([A - B, abs(C - B)], [D - C, 1])
        assert (turn(C - B, A - B), turn(D - B, A - C)) == pytest.approx(wanted)
        assert has_lines(ax, [A, B], [B, C], [C, D], [A, D], [A, C], [B, D])
    middle = (A + C) / 2
    big, small = drawing.data["same_pose"]
    np.testing.assert_allclose(np.abs(big - np.roll(big, -1)), np.abs([A - B, B - D, D - A]))
    sides = np.abs([middle - D, D - C, C - middle])
    np.testing.assert_allclose(np.abs(small - np.roll(small, -1)), sides)
    np.testing.assert_allclose(np.diff(big) / np.diff(small), 2**0.5)  # one pose: only scaled
    for triangle in (big, small):
        assert has_lines(axes[2], *(triangle[[k - 1, k]] for k in range(3)))
        assert any(near(p[:3], triangle) < 1e-12 for p in pieces(axes[2], PolyCollection))


def test_fig_2_shows_reciprocal_ratios_and_three_theta_parallelograms():
    drawing, axes = drawn(fig02)
    lam, mu = drawing.claims["lam, mu A"]
    ratios = {"A": (lam, mu), "B": (1 / lam, mu), "C": (lam, 1 / mu), "D": (1 / lam, 1 / mu)}
    angles = {"A": (65, 70), "B": (65, 110), "C": (115, 70), "D": (115, 110)}  # the text of 3.1
    roots = GOLDEN, (2**0.5 + 6**0.5) / 2, (3**0.5 + 7**0.5) / 2
    for letter, size, degrees in zip("EFG", roots, (60, 45, 30), strict=True):
        ratios[letter], angles[letter] = (size, size), (degrees, degrees)
    polygons = pieces(axes[0], PolyCollection)
    assert list(drawing.data) == list("ABCDEFG") and len(polygons) == 7
    for (letter, (A, B, C, D)), polygon in zip(drawing.data.items(), polygons, strict=True):
        np.testing.assert_allclose([A - B, C - B], [D - C, 1])
        found = abs(A - B) / abs(C - B), abs(B - D) / abs(A - C)
        assert found == pytest.approx(ratios[letter], rel=1e-9), letter
        assert (turn(C - B, A - B), turn(D - B, A - C)) == pytest.approx(angles[letter])
        shift = polygon[1] - B
        np.testing.assert_allclose(polygon[:4] - shift, [A, B, C, D], atol=1e-12)
        assert has_lines(axes[0], *(x + shift for x in ([A, B], [B, C], [A, C], [B, D])))
    whole = far(*drawing.data["A"])
    for letter, scale in (("B", lam), ("C", 1), ("D", lam)):  # similar to A or its mirror image
        np.testing.assert_allclose(scale * far(*drawing.data[letter]), whole)
    mirrored = -np.conj(drawing.data["A"] - drawing.data["A"][2])[::-1]
    np.testing.assert_allclose(drawing.data["C"], mirrored, atol=1e-12)


FIG_3 = {"A": (80, 50), "B": (45, 45), "C": (60, 60)}  # theta, theta0


def test_fig_3_a_to_c_are_grids_of_the_angles_on_integers_and_heights():
    drawing, axes = drawn(fig03)
    for ax, (name, (theta, theta0)) in zip(axes, FIG_3.items(), strict=False):
        z = drawing.data[name]
        u, v = z[1:] - z[:-1], z[:, 1:] - z[:, :-1]
        np.testing.assert_allclose(u, 1, atol=1e-12)  # horizontal edges of length 1
        np.testing.assert_allclose(np.angle(v) / DEG, theta0)
        np.testing.assert_allclose(v, v[0, 0])
        cosine = np.cos((turn(u[0, 0] - v[0, 0], u[0, 0] + v[0, 0])) * DEG)
        assert abs(cosine) == pytest.approx(np.cos(theta * DEG))  # the lines, not their sense
        heights = z[0].imag / v[0, 0].imag
        np.testing.assert_allclose(heights, heights.round(), atol=1e-9)
        feet = z[:, 0] - z[:, 0].imag * v[0, 0] / v[0, 0].imag
        assert heights.min() > 0.5  # in the upper half plane
        np.testing.assert_allclose(feet, feet.real.round(), atol=1e-9)
        assert (feet.real.round() != 0).all()  # no line through 0
        assert has_lines(ax, *z, *z.T)


def test_fig_3_a_prime_shows_arcs_of_the_printed_circles():
    drawing, axes = drawn(fig03)
    z, arcs = drawing.data["A"], pieces(axes[3], PathCollection)
    np.testing.assert_allclose(drawing.data["A'"], 1 / z, rtol=1e-14)
    k = np.tan(FIG_3["A"][1] * DEG)
    circles = [(-0.5j / A, 1 / (2 * A)) for A in z[0].imag]
    for B in z[:, 0].real - z[:, 0].imag / k:
        circles.append(((1 + 1j / k) / (2 * B), np.sqrt(1 + k**2) / abs(2 * k * B)))
    assert len(arcs) == len(circles) == sum(z.shape)
    ends = [(line[0], line[-1]) for line in (*(1 / z).T, *(1 / z))]
    for arc, (centre, radius), pair in zip(arcs, circles, ends, strict=True):
        assert near(np.array([arc[0], arc[-1]]), np.array(pair)) < 1e-12
        np.testing.assert_allclose(abs(arc - centre), radius, rtol=1e-9)
    assert has_lines(axes[3], *(1 / z), *(1 / z).T)  # the straight quads, dashed


@pytest.mark.parametrize("panel", [4, 5])
def test_fig_3_b_prime_and_c_prime_show_parabolas_as_exact_bezier_curves(panel):
    drawing, axes = drawn(fig03)
    z = drawing.data["ABC"[panel - 3]]
    np.testing.assert_allclose(drawing.data["ABC"[panel - 3] + "'"], z**2, rtol=1e-14)
    curves, lines = pieces(axes[panel], PathCollection), [*z.T, *z]
    t = np.linspace(0, 1, 9)
    assert len(curves) == len(lines)
    for (b0, b1, b2), line in zip(curves, lines, strict=True):
        bezier = (1 - t) ** 2 * b0 + 2 * t * (1 - t) * b1 + t**2 * b2
        np.testing.assert_allclose(bezier, ((1 - t) * line[0] + t * line[-1]) ** 2, atol=1e-11)
    assert has_lines(axes[panel], *(z**2), *(z**2).T)  # the straight quads, dashed


def test_fig_3_c1_to_c3_are_patterns_of_parallelograms_similar_where_exact():
    drawing, axes = drawn(fig03)
    for k, name in enumerate(("C1", "C2", "C3")):
        w = drawing.data[name]
        v1, v2, v3, v4 = w[:-1, 1:], w[:-1, :-1], w[1:, :-1], w[1:, 1:]
        a, b = v3 - v1, v4 - v2
        K = (b / a).ravel()
        black = np.array(pieces(axes[6 + k], PolyCollection))
        assert black.shape == (100, 5)
        assert np.allclose(black[:, 0], ((v1 + v2) / 2).ravel())
        assert np.allclose(black[:, 2], ((v3 + v4) / 2).ravel())
        assert np.allclose(black[:, 1] - black[:, 0], (a / 2).ravel())
        assert np.allclose(black[:, 3] - black[:, 0], (b / 2).ravel())
        if name == "C1":
            assert 1e-3 < abs(K / K.mean() - 1).max() < 0.1
            assert abs(abs(np.cos(np.angle(K))) - 0.5).max() < 0.05
        else:
            np.testing.assert_allclose(K, K[0], rtol=1e-11)
            assert abs(np.cos(np.angle(K[0]))) == pytest.approx(0.5)
            R = (1 + K[0]) / (K[0] - 1)
            assert abs(np.cos(np.angle(R))) == pytest.approx(0.5)  # theta = theta0 = 60
    for name, times in (("C1", 0), ("C2", 0), ("C3", 2)):  # how often the outline goes around 0
        w = drawing.data[name]
        rim = np.concatenate([w[:, 0], w[-1], w[::-1, -1], w[0, ::-1]])
        steps = np.angle(rim[1:] / rim[:-1])
        assert round(steps[rim[1:] != rim[:-1]].sum() / (2 * np.pi)) == times
    np.testing.assert_allclose(w, w[::-1, ::-1], atol=1e-12)  # C3 covers everything twice
    assert abs(w[5, 5]) < 1e-24


@pytest.mark.parametrize("degrees", [(80, 55, 60), (40, 100, 115)])
def test_fig_4_shows_skew_quads_with_their_parallelograms(degrees):
    drawing, _ = drawn(fig04, *np.array(degrees) * DEG)
    wanted = {"A": degrees[:2], "B": degrees[2:] * 2}
    for name, (theta, theta0) in wanted.items():
        V = drawing.data[name]
        v1, v2, v3, v4 = V
        assert abs(np.linalg.det([v2 - v1, v3 - v1, v4 - v1])) > 0.1  # not plane
        ((a,), (b,)) = inner(V, [[0, 1, 2, 3]])
        np.testing.assert_allclose([2 * a, 2 * b], [v3 - v1, v4 - v2])  # parallel to d1 and d2
        assert (angle(a, b), angle(a + b, b - a)) == pytest.approx((theta, theta0))
        lam, mu = quotient(b, a), quotient(a + b, b - a)
        assert (drawing.claims[f"lam_{name}"], drawing.claims[f"mu_{name}"]) == pytest.approx(
            (lam, mu)
        )
        assert (abs(lam - mu) < 1e-12) == (name == "B")  # a theta-quad
        shown = drawing.nets["AB".index(name)]
        np.testing.assert_array_equal(shown[0], V)
        assert np.array(shown[2:]) / DEG == pytest.approx((theta, theta0))


def test_fig_5_shows_four_families_a_catenoid_and_discrete_derivatives():
    drawing, axes = drawn(fig05)
    lines = [x for ax in axes for x in pieces(ax, LineCollection)]
    square = [x for x in lines if len(x) == 2 and np.abs([x.real, x.imag]).max() <= 0.5 + 1e-9]
    slopes = [round(turn(1, x[1] - x[0])) % 180 for x in square]  # lines of the parameter square
    assert all(slopes.count(k) >= 5 for k in (0, 45, 90, 135))
    arrows = [[a for a in ax.texts if isinstance(a, Annotation)] for ax in axes]
    ways = [{round(turn(1, plane(a.xy) - plane(a.xyann))) for a in some} for some in arrows]
    assert {0, 90, -45, 45} in ways  # X_u, X_v, Y_u, Y_v in the square
    rho = np.exp(65j * DEG) / parallelogram.ratios(75 * DEG, 65 * DEG)[1]  # X_v / X_u

    def points(n):
        """The web on the catenoid, (x, y) -> (cosh y sin x, -cosh y cos x, y), n x n faces."""
        side = np.linspace(-0.5, 0.5, n + 1)
        z = 1.45 * (side[:, None] + rho * side)
        x, y = z.real, z.imag
        return np.stack([np.cosh(y) * np.sin(x), -np.cosh(y) * np.cos(x), y], axis=-1)

    np.testing.assert_allclose(drawing.data["mesh"], points(3).reshape(-1, 3), atol=1e-12)
    X_u, X_v = 1.45 * np.array([1, 0, 0]), 1.45 * np.array([rho.real, 0, rho.imag])
    off = []
    for n in (3, 7, 15):  # the face in the middle, at x = y = 0
        grid, k = points(n), n // 2
        v1, v2, v3, v4 = grid[k, k + 1], grid[k, k], grid[k + 1, k], grid[k + 1, k + 1]
        pairs = [(v3 - v1, X_u - X_v), (v4 - v2, X_u + X_v)]
        pairs += [((v3 + v4 - v1 - v2) / 2, X_u), ((v1 + v4 - v2 - v3) / 2, X_v)]
        off.append([np.abs(n * one - two).max() for one, two in pairs])
    order = np.diff(np.log(off), axis=0) / np.log([[3 / 7], [7 / 15]])
    assert (np.abs(order - 2) < 0.1).all()  # first derivatives, to second order
    (domain, Q, *angles), *_ = drawing.nets
    a, b = inner(domain, Q)
    np.testing.assert_allclose(angle(a, b), 75)
    np.testing.assert_allclose(angle(a + b, b - a), 65)
    assert np.array(angles) / DEG == pytest.approx((75, 65))
    coarse, fine = (drawing.claims[f"sampled_net{s}_max_deviation_deg"] for s in ("", "_half_size"))
    assert 3 < coarse / fine < 5


def test_fig_6_shows_rhombuses_rectangles_theta_parallelograms_and_squares():
    drawing, axes = drawn(fig06, 70 * DEG)
    polygons = [p[:4] for ax in axes for p in pieces(ax, PolyCollection) if len(p) == 5]
    nets = dict(zip("ABCD", drawing.nets, strict=True))
    for name, (domain, Q, *_) in nets.items():
        for V, tolerance in ((domain, 1e-12), (drawing.data[f"net_{name}"], 0.15)):
            a, b = inner(V, Q)
            sides, diagonals = quotient(b, a), quotient(a + b, b - a)
            theta, theta0 = angle(a, b), angle(a + b, b - a)
            close = {"rtol": tolerance, "atol": 1e-9}
            if name in "AD":  # rhombuses: lam = 1, theta0 = 90
                np.testing.assert_allclose(sides, 1, **close)
                np.testing.assert_allclose(theta0, 90, **close)
            if name in "BD":  # rectangles: mu = 1, theta = 90
                np.testing.assert_allclose(diagonals, 1, **close)
                np.testing.assert_allclose(theta, 90, **close)
            if name == "C":  # lam = mu, theta = theta0
                np.testing.assert_allclose(sides, diagonals, **close)
                np.testing.assert_allclose(theta0, theta, **close)
            asked = {"A": theta, "B": theta0, "C": theta}.get(name)
            if asked is not None:
                np.testing.assert_allclose(asked, 70, **close)
        V = drawing.data[f"net_{name}"]
        np.testing.assert_allclose(np.linalg.norm(V, axis=1), 1, rtol=1e-12)  # on the sphere
        latitude = np.arcsin(V[:, 2])
        mercator = np.arctan2(V[:, 0], -V[:, 1]) + 1j * np.arctanh(np.sin(latitude))
        np.testing.assert_allclose(mercator, plane(domain[:, :2]), atol=1e-12)
        one, two = inner(V, Q)  # of the net in space one parallelogram is drawn
        shapes = quotient(two, one) * np.exp(1j * angle(one, two) * DEG)
        off = [np.abs((p[3] - p[0]) / (p[1] - p[0]) - shapes).min() for p in polygons]
        right = [p for p, x in zip(polygons, off, strict=True) if x < 1e-9]
        assert any(has_lines(ax, p[[1, 2]], p[[3, 2]]) for ax in axes for p in right), name
    a, b = (x[0] for x in inner(*nets["D"][:2]))
    quarter = 2**-0.5 * ((a + b) + np.cross([0, 0, -1], a + b))  # m13 turned by -45 degrees
    np.testing.assert_allclose(quarter, 2**0.5 * a, atol=1e-12)
    a, b = (x[0] for x in inner(*nets["C"][:2]))  # one rotation for both directions
    assert angle(a + b, a) == pytest.approx(angle(b - a, b))


def test_fig_8_shows_two_squares_and_their_net_on_a_catenoid():
    drawing, axes = drawn(fig08)
    edges = [0, 2], [1j, 2 + 1j], [0, 1j], [2, 2 + 1j]  # around both squares
    (squares,) = (ax for ax in axes if has_lines(ax, *edges))
    v1, v2, v3, v4 = corners = np.array([1 + 1j, 1j, 1, 2])
    (polygon,) = pieces(squares, PolyCollection)
    assert (abs(v4 - v3), abs(v1 - v2)) == (1, 1)  # two edges and two diagonals
    assert abs(v3 - v2) == abs(v4 - v1) == pytest.approx(2**0.5)
    assert has_lines(squares, [v1, v2], [v2, v3], [v3, v4], [v1, v4], [v1, v3], [v2, v4])
    np.testing.assert_allclose(polygon[:4], (corners + np.roll(corners, -1)) / 2)
    p12, p23, p34, p41 = polygon[:4]
    assert has_lines(squares, [p12, p23], [p34, p41], [p12, p34], [p23, p41])
    assert abs(p41 - p12) ** 2 / abs(p23 - p12) ** 2 == pytest.approx(5)  # lam
    assert abs(p34 - p12) ** 2 / abs(p41 - p23) ** 2 == pytest.approx(2)  # mu
    assert np.cos(turn(p23 - p12, p41 - p12) * DEG) == pytest.approx(5**-0.5)
    assert turn(p34 - p12, p41 - p23) == pytest.approx(45)
    domain, Q, *_ = drawing.nets[0]
    z, step = plane(domain[:, :2]), 2 * np.pi / 36
    grid = z / step
    np.testing.assert_allclose(grid - grid[0], np.round(grid - grid[0]), atol=1e-9)  # of squares
    found = z[Q] - z[Q[:, 1]][:, None]  # each face: those two squares
    np.testing.assert_allclose(found / step, [corners - v2] * len(Q), atol=1e-9)
    x, y = domain[:, :2].T
    wanted = np.stack([np.cosh(y) * np.cos(x), np.cosh(y) * np.sin(x), y], axis=1)
    np.testing.assert_allclose(drawing.data["net"], wanted, atol=1e-12)
