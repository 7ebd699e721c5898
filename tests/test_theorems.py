"""The theorems of Section 4: by symbols for any tangents, then on smooth nets and face by face.

Angles and lengths are taken here by the textbook formulas, from points alone."""

from functools import cache
from itertools import combinations, pairwise

import numpy as np
import pytest
import sympy as sp

from inetlib import conformal, loxodrome, measure, mesh, moebius, parallelogram, solver, surfaces

DEG = np.pi / 180
SURFACES = {
    "sphere": surfaces.SPHERE,
    "catenoid": surfaces.CATENOID,
    "helicoid": surfaces.HELICOID,
    "minimal": surfaces.conjugate(0.7),
    "image": moebius.image(moebius.inversion((2.5, -1.5, 1.0), 2.0), surfaces.CATENOID),
}
PAIRS = [(60, 45), (75, 65), (115, 40), (50, 130)]
NETS = "plane", "spiral", "vase", "roof"
each_net = pytest.mark.parametrize("name", NETS)


def torus_by_angles(u, v):
    """A torus by its two angles: orthogonal, and not isothermal."""
    r = 2 + 0.8 * np.cos(v)
    return r * np.cos(u), r * np.sin(u), 0.8 * np.sin(v) + 0 * u


def inet(surface, theta, theta0):
    """A linear reparametrisation: X_v is X_u turned by theta0 and divided by mu, by hand."""
    _, mu = exact_ratios(theta, theta0)
    a, b = np.cos(theta0) / mu, np.sin(theta0) / mu
    return surfaces.Surface("", lambda u, v: surface.coordinates(u + a * v, b * v))


def exact_ratios(theta, theta0):
    """(lam, mu) by bisection: with X_u = mu and X_v = exp(i theta0), theta falls as mu grows."""
    low, high = 1e-3, 1e3
    for _ in range(200):
        mu = np.sqrt(low * high)
        u, v = mu + 0j, np.exp(1j * theta0)
        small = np.angle((u + v) / (u - v)) > theta
        low, high = (mu, high) if small else (low, mu)
    return abs(u + v) / abs(u - v), mu


@cache
def net(name, theta, theta0):
    """(V, Q) of an exact net with faces of very unequal sizes; degrees."""
    angles = theta * DEG, theta0 * DEG
    if name == "plane":
        z = conformal.sheared_grid(*angles, 9, 7, origin=0.5 + 0.3j, edge=0.2)
        return conformal.quads(z**2)
    if name == "spiral":
        return conformal.quads(np.exp(conformal.sheared_grid(*angles, 9, 7, edge=0.3, kappa=1)))
    if name == "vase":
        return loxodrome.web(surfaces.vase_profile(), *angles, 16)[:2]
    V, Q = net("spiral", theta, theta0)
    V = V + [0, 0, 1] * (0.6 * V[:, :1] ** 2 - 0.3 * V[:, 1:2] ** 2) / np.abs(V).max()
    found = solver.optimize(V, Q, *angles)
    assert found.converged
    return found.V, Q


def angle(a, b):
    return np.arccos(np.sum(a * b, -1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1))


def black(V, Q):
    """The corners (f, 4, 3) of the black quads."""
    board = mesh.checkerboard(V, Q)
    return board.V[board.black]


def shapes(P):
    """The six distances of the corners of each quad (f, 6), in units of their root mean square.

    Quads with equal rows are similar."""
    far = [np.linalg.norm(P[:, i] - P[:, j], axis=1) for i, j in combinations(range(4), 2)]
    return np.transpose(far / np.sqrt(np.mean(np.square(far), axis=0)))


def sides(P):
    return P[:, 1] - P[:, 0], P[:, 3] - P[:, 0]


def quotient(a, b):
    return np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)


def sampled(surface, theta, theta0, n):
    """The net of the points of an I-net over a square of the same size for all n."""
    u, v = np.meshgrid(*2 * [np.linspace(-0.5, 0.5, n + 1)], indexing="ij")
    points = inet(surface, theta, theta0).point(u, v)
    return points.reshape(-1, 3), mesh.grid_quads(n, n)


def test_thm_7_by_symbols_for_any_tangents():
    """X_u = (Y_v + Y_u) / 2 and X_v = (Y_v - Y_u) / 2 with Y_u = 1, Y_v = lam exp(i theta)."""
    lam, theta = sp.symbols("lam theta", positive=True)
    c = sp.cos(theta)
    long, short = lam**2 + 1 + 2 * lam * c, lam**2 + 1 - 2 * lam * c  # |2 X_u|^2, |2 X_v|^2
    mu = sp.sqrt(long / short)
    exact = {  # cosine of the angle between two of them, squared, and its sign
        "Y_u, Y_v": (c**2, c),
        "X_u, X_v": ((lam**2 - 1) ** 2 / (long * short), lam**2 - 1),
        "X_u, Y_v": ((lam + c) ** 2 / long, lam + c),
        "X_u, Y_u": ((1 + lam * c) ** 2 / long, 1 + lam * c),
    }
    found = *parallelogram.cosines(lam, mu), *parallelogram.half_cosines(lam, mu)
    numbers = np.random.default_rng(7).uniform([0.2, 0.1], [5, 3], (1000, 2)).T
    for formula, (square, sign) in zip(found, exact.values(), strict=True):
        assert sp.simplify(formula**2 - square) == 0
        one, two = (sp.lambdify([lam, theta], x)(*numbers) for x in (formula, sign))
        assert (one * two > 0).all()
    assert sp.simplify(found[0] - c) == 0


@pytest.mark.parametrize("name", SURFACES)
def test_thm_7_constant_ratios_of_tangents_mean_constant_angles(name):
    rng = np.random.default_rng(17)
    for theta, theta0 in PAIRS:
        lam, mu = exact_ratios(theta * DEG, theta0 * DEG)
        surface = inet(SURFACES[name], theta * DEG, theta0 * DEG)
        u, v = rng.uniform(-1, 1, (2, 100))
        found = surfaces.ratios(surface, u, v)
        np.testing.assert_allclose(found, [[lam] * 100, [mu] * 100], rtol=1e-9)
        x_u, x_v = (t.T for t in surfaces.tangents(surface, u, v))
        np.testing.assert_allclose(angle(x_u, x_v), theta0 * DEG, rtol=1e-9)
        np.testing.assert_allclose(angle(x_u - x_v, x_u + x_v), theta * DEG, rtol=1e-9)
        cosines = np.cos([theta * DEG, theta0 * DEG])
        np.testing.assert_allclose(parallelogram.cosines(lam, mu), cosines, atol=1e-12)


def test_thm_7_one_constant_ratio_is_not_enough():
    u, v = np.random.default_rng(3).uniform(-3, 3, (2, 100))
    torus = surfaces.Surface("torus", torus_by_angles)
    lam, mu = surfaces.ratios(torus, u, v)
    x_u, x_v = (t.T for t in surfaces.tangents(torus, u, v))
    np.testing.assert_allclose(lam, 1, rtol=1e-10)
    np.testing.assert_allclose(angle(x_u, x_v), np.pi / 2, rtol=1e-9)
    assert np.ptp(mu) > 0.2 and np.ptp(angle(x_u - x_v, x_u + x_v)) > 5 * DEG


@pytest.mark.parametrize("name", SURFACES)
def test_thm_8_four_families_meet_at_six_constant_angles(name):
    """On the surface at random points; those of finite quads tend to them with the square."""
    rng = np.random.default_rng(8)
    for theta, theta0 in np.array(PAIRS) * DEG:
        surface = inet(SURFACES[name], theta, theta0)
        u, v = rng.uniform(-1, 1, (2, 100))
        x_u, x_v = (t.T for t in surfaces.tangents(surface, u, v))
        lines = [x_u, x_u + x_v, x_v, x_v - x_u, -x_u]  # counter-clockwise
        gaps = [angle(a, b) for a, b in pairwise(lines)]
        wanted = parallelogram.gaps(*exact_ratios(theta, theta0))
        np.testing.assert_allclose(gaps, np.transpose([wanted] * 100), atol=1e-9)
        alpha, rest, _, beta = wanted
        limits = np.array([theta, theta0, alpha, beta, rest, theta0 + beta])
        off = []
        for n in (8, 16, 32):
            six = np.array(measure.web_angles(*sampled(SURFACES[name], theta, theta0, n)))
            off.append(np.abs(six - limits[:, None]).max())
        assert off[2] < 1e-2 and 3 < off[0] / off[1] < 5 and 3.5 < off[1] / off[2] < 4.5


def test_cor_9_the_black_quads_of_an_i_net_are_similar_in_the_limit():
    for surface in SURFACES.values():
        for theta, theta0 in np.array(PAIRS) * DEG:
            nets = [sampled(surface, theta, theta0, n) for n in (10, 20, 40)]
            off = [np.ptp(shapes(black(*net)), axis=0).max() for net in nets]
            assert off[2] < 0.01 and 3 < off[0] / off[1] < 5 and 3.5 < off[1] / off[2] < 4.5
    u, v = np.meshgrid(*2 * [np.linspace(-0.5, 0.5, 41)], indexing="ij")  # constant theta0 only
    V = np.stack(torus_by_angles(u, v + 1), axis=-1).reshape(-1, 3)
    assert np.ptp(shapes(black(V, mesh.grid_quads(40, 40))), axis=0).max() > 0.05


@each_net
@pytest.mark.parametrize("degrees", PAIRS[:3])
def test_thm_11_prop_13_constant_ratios_mean_constant_angles_and_similar_black_quads(name, degrees):
    V, Q = net(name, *degrees)
    P = black(V, Q)
    assert np.ptp(shapes(P), axis=0).max() < 1e-9  # similar
    size = np.linalg.norm(P[:, 2] - P[:, 0], axis=1)
    assert size.max() > 1.5 * size.min()  # and not congruent
    lam, mu = exact_ratios(*np.array(degrees) * DEG)
    np.testing.assert_allclose(measure.ratios(V, Q), [[lam] * len(Q), [mu] * len(Q)], rtol=1e-9)
    d1, d2, f_u, f_v = measure.vectors(V, Q)
    for found in ((angle(d1, d2), angle(f_u, f_v)), measure.angles(V, Q)):
        np.testing.assert_allclose(found, np.transpose([degrees] * len(Q)) * DEG, atol=1e-9)
    a, b = sides(P)
    np.testing.assert_allclose([2 * a, 2 * b], [d1, d2], atol=1e-14)
    np.testing.assert_allclose([P[:, 2] - P[:, 0], P[:, 3] - P[:, 1]], [f_u, f_v], atol=1e-14)


@each_net
@pytest.mark.parametrize("degrees", PAIRS[:3])
def test_thm_12_all_six_angles_are_constant_over_the_web(name, degrees):
    """cot alpha = (mu + cos theta0) / sin theta0, and with - cot beta: the law of cosines."""
    V, Q = net(name, *degrees)
    theta, theta0 = np.array(degrees) * DEG
    mu = exact_ratios(theta, theta0)[1]
    alpha, beta = (np.arctan2(np.sin(theta0), mu + s * np.cos(theta0)) for s in (1, -1))
    wanted = theta, theta0, alpha, beta, theta0 - alpha, theta0 + beta
    np.testing.assert_allclose(measure.web_angles(V, Q), np.transpose([wanted] * len(Q)), atol=1e-9)


def test_def_10_lam_is_1_exactly_for_orthogonal_nets():
    lam, mu = sp.symbols("lam mu", positive=True)
    assert sp.solve(parallelogram.cosines(lam, mu)[1], lam) == [1]  # theta0 = 90 degrees
    assert sp.solve(parallelogram.cosines(lam, mu)[0], mu) == [1]  # theta = 90 degrees


@each_net
def test_def_14_cor_15_do_nets_have_similar_rhombuses(name):
    V, Q = net(name, 50, 90)
    P = black(V, Q)
    np.testing.assert_allclose(quotient(*sides(P)), 1, atol=1e-9)
    np.testing.assert_allclose(angle(*sides(P)), 50 * DEG, atol=1e-9)
    assert np.ptp(shapes(P), axis=0).max() < 1e-9
    np.testing.assert_allclose(measure.ratios(V, Q)[0], 1, atol=1e-9)  # DO-net: lam = 1


@each_net
def test_cor_16_mu_1_has_similar_rectangles(name):
    V, Q = net(name, 90, 50)
    P = black(V, Q)
    np.testing.assert_allclose(angle(*sides(P)), np.pi / 2, atol=1e-9)
    assert np.ptp(shapes(P), axis=0).max() < 1e-9 and np.ptp(quotient(*sides(P))) < 1e-9
    assert abs(quotient(*sides(P))[0] - 1) > 0.1  # no squares
    np.testing.assert_allclose(measure.ratios(V, Q)[1], 1, atol=1e-9)


@each_net
def test_cor_17_theta_quads_have_one_ratio(name):
    for theta in (60, 50, 110):
        V, Q = net(name, theta, theta)
        P = black(V, Q)
        lam = np.cos(theta * DEG) + np.sqrt(1 + np.cos(theta * DEG) ** 2)
        a, b = sides(P)
        np.testing.assert_allclose(quotient(b, a), lam, atol=1e-9)
        np.testing.assert_allclose(quotient(a + b, b - a), lam, atol=1e-9)
        np.testing.assert_allclose([angle(a, b), angle(a + b, b - a)], theta * DEG, atol=1e-9)
        assert np.ptp(shapes(P), axis=0).max() < 1e-9
        np.testing.assert_allclose(measure.theta_defect(V, Q), 0, atol=1e-9)


@each_net
def test_cor_18_do_nets_of_theta_quads_have_squares(name):
    P = black(*net(name, 90, 90))
    square = np.sqrt([1, 2, 1, 1, 2, 1]) / np.sqrt(8 / 6)  # 01, 02, 03, 12, 13, 23
    np.testing.assert_allclose(shapes(P), [square] * len(P), atol=1e-9)
