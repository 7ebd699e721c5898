"""`planar` against `measure`, known nets, dense ranks; how exact conformal images are."""

import numpy as np
import pytest
import sympy

from inetlib import conformal, measure, mesh, planar

ANGLES = [(90, 90), (60, 60), (60, 45), (100, 40)]
T, T0 = np.radians(60), np.radians(45)
SQUARE = np.array([0, 1, 1 + 1j, 1j])
CIRCLE = np.exp(2j * np.pi * np.arange(90) / 90)


def strip(m, n):
    """A closed strip of m x n quads, vertex (i, j) numbered i (n + 1) + j."""
    return mesh.grid_quads(m, n) % (m * (n + 1))


def ring(m, n, ratio):
    """Concentric m-gons, from radius 1 on by powers of the complex ratio."""
    i, j = np.meshgrid(np.arange(m), np.arange(n + 1), indexing="ij")
    return (np.exp(2j * np.pi * i / m) * ratio**j).ravel()


def require_exact(net, Q, degrees):
    """The judge: both angles of every face, orientation, the equations themselves."""
    found = np.degrees(measure.angles(net.V, Q))
    assert np.abs(found - np.reshape(degrees, (2, 1))).max() < 1e-9
    assert measure.quality(net.V, Q).flips == 0
    assert not net.V[:, 2].any()
    z = net.V[:, 0] + 1j * net.V[:, 1]
    v1, v2, v3, v4 = z[Q].T
    assert ((np.conj(v3 - v1) * (v4 - v2)).imag > 0).all()
    lam, _ = measure.ratios(net.V, Q)
    K = lam[0] * np.exp(1j * np.radians(degrees[0]))
    assert np.abs(v4 - v2 - K * (v3 - v1)).max() < 1e-12 * np.abs(z).max()
    assert net.residual < 1e-11
    return z


@pytest.mark.parametrize(("degrees", "n"), [*((pair, 50) for pair in ANGLES), ((60, 45), 100)])
def test_a_grid_through_five_handles(degrees, n):
    Q, z = mesh.grid_quads(n, n), conformal.sheared_grid(*np.radians(degrees), n, n).ravel()
    held = [0, n, n * (n + 1), n * (n + 2), n // 2 * (n + 2)]  # the corners and the middle
    points = z[held] * (1 + 0.2j / n * np.abs(z[held]))
    net = conformal.planar_net(Q, *np.radians(degrees), handles=(held, points))
    found = require_exact(net, Q, degrees)
    assert np.abs(found[held] - points).max() < 1e-12 * np.abs(points).max()
    assert len(net.flipped) == len(net.wound) == 0
    assert net.freedom == 2 * n + 1


@pytest.mark.parametrize("degrees", ANGLES)
def test_a_hexagon_with_rings_through_six_handles_or_near_a_start(degrees):
    V, Q, _ = mesh.polygon_rings(6, 8)
    rim = max(mesh.boundary_loops(Q), key=len)
    held = rim[:: len(rim) // 6]
    for given in ({"handles": (held, V[held])}, {"start": V}):
        net = planar.planar_net(Q, *np.radians(degrees), **given)
        require_exact(net, Q, degrees)
        assert len(net.flipped) == len(net.wound) == 0
        if "handles" in given:
            np.testing.assert_allclose(net.V[held], V[held], atol=1e-12)


def planar_ratio(m, theta, theta0):
    """The ratio of rings of the strip that turns by 2 pi / m: (u + v) = K (u - v) in powers."""
    K, w = planar.factor_k(theta, theta0), np.exp(2j * np.pi / m)
    return (1 + K * w) / (w + K)


@pytest.mark.parametrize("degrees", ANGLES)
def test_an_annulus_near_a_start(degrees):
    """A round one closes at all angles, but with a ratio of its own; it gives others too."""
    z, Q = ring(40, 10, planar_ratio(40, *np.radians(degrees))), strip(40, 10)
    net = planar.planar_net(Q, *np.radians(degrees), start=z, smooth=0)
    np.testing.assert_allclose(require_exact(net, Q, degrees), z, atol=1e-12)
    z = ring(40, 10, abs(planar_ratio(40, *np.radians(degrees))))
    net = planar.planar_net(Q, *np.radians(degrees), start=z.real + 1.1j * z.imag)
    require_exact(net, Q, degrees)
    assert len(net.flipped) == len(net.wound) == 0


def test_known_nets_are_recovered_from_handles():
    m, n = 12, 9
    Q, z = mesh.grid_quads(m, n), conformal.sheared_grid(T, T0, m, n, 1 + 2j, 0.1)
    straight = planar.planar_net(Q, T, T0, ([7, 95], z.ravel()[[7, 95]]))
    np.testing.assert_allclose(straight.V, conformal.quads(z)[0], atol=1e-11)
    # z^2 is given back by as many of its vertices as there are freedoms, along the rim
    w, rim = z**2, mesh.boundary_loops(Q)[0]
    held, every = np.append(rim[::2], rim[1]), np.arange(w.size)
    for given, off in ((held, 1e-11), (every, 1e-14)):  # more than freedoms, but they agree
        net = planar.planar_net(Q, T, T0, (given, w.ravel()[given]))
        np.testing.assert_allclose(net.V, conformal.quads(w)[0], atol=off)
    assert len(held) == net.freedom


def test_the_smoothest_net_has_the_least_energy_and_a_start_its_orthogonal_projection():
    Q, count = mesh.grid_quads(5, 4), 30
    A = planar.equations(Q, planar.factor_k(T, T0)).toarray()
    held, points = [0, 4, 25, 29], np.array([0, 0.5 + 0.3j, 1, 1.7 + 0.4j])
    net = planar.planar_net(Q, T, T0, (held, points))
    z = net.V[:, 0] + 1j * net.V[:, 1]
    rows = np.concatenate([A, np.eye(count)[held]])
    null = np.linalg.svd(rows)[2][np.linalg.matrix_rank(rows) :].conj().T
    grid = z.reshape(6, 5)

    def energy(z):
        twist = z[1:, 1:] - z[1:, :-1] - z[:-1, 1:] + z[:-1, :-1]
        parts = np.diff(z, 2, axis=0), np.diff(z, 2, axis=1), np.sqrt(2) * twist
        return sum((np.abs(part) ** 2).sum() for part in parts)

    assert null.shape[1] == 10 - 4
    for direction in null.T:
        for step in (1e-4, -1e-4, 1e-4j):
            assert energy(grid + step * direction.reshape(6, 5)) > energy(grid)
    V, Q, _ = mesh.polygon_rings(6, 3)
    net = planar.planar_net(Q, T, T0, start=V, smooth=0)
    A = planar.equations(Q, planar.factor_k(T, T0)).toarray()
    z = V[:, 0] + 1j * V[:, 1]
    nearest = z - np.linalg.pinv(A) @ (A @ z)
    np.testing.assert_allclose(net.V[:, 0] + 1j * net.V[:, 1], nearest, atol=1e-11)


def test_freedoms_are_the_dimension_of_the_null_space():
    hexagon = mesh.polygon_rings(6, 8)[1]
    for Q, wanted in ((hexagon, 54), (mesh.grid_quads(7, 4), 12), (strip(12, 3), 12)):
        for degrees in ANGLES:
            A = planar.equations(Q, planar.factor_k(*np.radians(degrees)))
            gram = (A @ A.conj().T).toarray()  # of full rank when its eigenvalues are positive
            assert np.linalg.eigvalsh(gram)[0] > 1e-9
            assert A.shape == (len(Q), len(Q) + wanted)


def test_an_outline_is_followed_and_the_distance_is_true():
    V, Q, _ = mesh.polygon_rings(6, 8)
    V = V / np.abs(V).max()
    ellipse = CIRCLE.real + 0.9j * CIRCLE.imag
    net = planar.planar_net(Q, np.pi / 2, np.pi / 2, boundary=ellipse, start=V)
    require_exact(net, Q, (90, 90))
    assert net.distance < 0.01 and "boundary off by" in net.message
    rim = max(mesh.boundary_loops(Q), key=len)
    t = np.linspace(0, 1, 200)
    dense = (ellipse[:, None] * (1 - t) + np.roll(ellipse, -1)[:, None] * t).ravel()
    z = net.V[rim, 0] + 1j * net.V[rim, 1]
    apart = np.abs(z[:, None] - dense).min(axis=1).max()
    assert net.distance == pytest.approx(apart, abs=1e-4)


def test_outlines_that_a_net_has_are_met_two_of_an_annulus_and_functions_too():
    flat = conformal.sheared_grid(T, T0, 12, 8, 1, 0.05)
    z = flat**2
    ends = flat[[0, 12, 12, 0], [0, 0, 8, 8]]
    t = np.arange(200) / 200
    rim = (ends[:, None] * (1 - t) + np.roll(ends, -1)[:, None] * t).ravel() ** 2
    corners = [0, 8, 12 * 9, 13 * 9 - 1]
    Q = mesh.grid_quads(12, 8)
    handles, start = {"handles": (corners, z.ravel()[corners])}, {"start": z.ravel() * 1.01}
    for given, most in ((handles, 1e-4), (start, 1e-3)):
        net = planar.planar_net(Q, T, T0, boundary=rim[::-1], smooth=1e-6, **given)
        assert net.distance < most
        require_exact(net, Q, (60, 45))
    assert planar.planar_net(Q, T, T0, boundary=rim).distance < 0.02
    z = ring(40, 10, planar_ratio(40, T, T0))
    loops = [np.arange(40) * 11, np.arange(40) * 11 + 10]
    pairs = [(loops[0], lambda t: np.exp(2j * np.pi * t)), (loops[1], abs(z[10]) * CIRCLE)]
    net = planar.planar_net(strip(40, 10), T, T0, boundary=pairs, start=1.1 * z)
    require_exact(net, strip(40, 10), (60, 45))
    assert net.distance < 2e-3


@pytest.mark.parametrize("seed", range(4))
def test_closest_points_and_of_feet_equally_near_the_first(seed):
    feet, tangents = planar.closest(np.array([0.3 - 1j, 2 + 0.25j, 3 + 3j]), SQUARE)
    np.testing.assert_allclose(feet, [0.3, 1 + 0.25j, 1 + 1j])
    np.testing.assert_allclose(tangents[:2], [1, 1j])
    t = np.linspace(0.05, 0.45, 9)
    points = np.concatenate([t * (1 + 1j), 1 - t + 1j * t, [0.5 + 0.5j, 0, 1 + 0j, 1 + 1j]])
    noise = np.random.default_rng(seed).standard_normal((2, len(points)))
    feet, tangents = planar.closest(points + 1e-13 * (noise[0] + 1j * noise[1]), SQUARE)
    np.testing.assert_allclose(feet, [*t, *(1 - t), 0.5, 0, 1, 1 + 1j], atol=1e-12)
    np.testing.assert_allclose(tangents[:19], 1, atol=1e-12)
    np.testing.assert_allclose(tangents[19:], [1, 1j, -1], atol=1e-12)  # of the side that leaves


def test_crossing_faces_and_double_windings_are_found():
    z = np.array([0, 1j, 1, 1 + 1j])  # grid_quads(1, 1): v1 = 1, v2 = 0, v3 = 2, v4 = 3
    Q = mesh.grid_quads(1, 1)
    assert not len(planar.faults(z, Q)[0])
    assert len(planar.faults(z[[0, 1, 3, 2]], Q)[0]) == 1
    double = conformal.sheared_grid(T, T, 4, 4)
    double = (double - double[2, 2]) ** 2
    np.testing.assert_array_equal(planar.faults(double.ravel(), mesh.grid_quads(4, 4))[1], [12])


GRID = mesh.grid_quads(4, 3)
ROW, COLUMN = np.divmod(mesh.grid_quads(6, 5), 6)
TORUS = ROW % 6 * 5 + COLUMN % 5
HELD = {"handles": ([1, 2], [0, 1])}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "0 handles do not fix"),
        ({"handles": ([0], [1j])}, "1 handles do not fix"),
        ({"handles": ([0, 0], [1, 2])}, "vertex 0 twice"),
        ({"handles": ([0, 20], [1, 2])}, "name vertex 20: 0 to 19"),
        ({"handles": ([0, -1], [1, 2])}, "name vertex -1"),
        ({"handles": ([0.5, 1], [1, 2])}, "list of vertex numbers"),
        ({"handles": ([0, 1], [1, np.nan])}, "point 1 is not finite"),
        ({"handles": ([0, 1], [1, 2, 3])}, "2 points are wanted, not 3"),
        ({"handles": ([0, 1], ["a", "b"])}, "numbers are wanted"),
        ({"handles": [0, 1, 2]}, "handles has 3 parts"),
        ({"handles": ([0, 1], [3, 3])}, "coincide"),
        ({"handles": (range(20), np.arange(20) ** 2 + 1j)}, "no net with these angles"),
        ({"start": np.zeros((20, 3))}, "coincide"),
        ({"start": np.zeros((19, 3))}, "20 points are wanted"),
        ({"start": np.zeros((20, 4))}, "shape"),
        ({"boundary": [0, 1]}, "at least three"),
        ({"boundary": [(0, 0), (1, 0)]}, "at least three"),
        ({"boundary": [([0, 30], CIRCLE)]}, "vertex 30"),
        ({"boundary": []}, "0 handles do not fix"),
        ({"boundary": [0, 1, np.inf]}, "not finite"),
        (HELD | {"smooth": 0}, "smooth = 0"),
        (HELD | {"smooth": -1}, "smooth = -1"),
        (HELD | {"theta": 60}, "radians"),
        (HELD | {"theta": [T, T]}, "one number"),
        (HELD | {"Q": GRID[:, :3]}, "quads are wanted"),
        (HELD | {"Q": GRID[:0]}, "no faces"),
        (HELD | {"Q": np.concatenate([GRID[:1], np.roll(GRID[1:], 1, 1)])}, "mesh.label"),
        (HELD | {"Q": np.concatenate([GRID, GRID + 20])}, "2 separate parts"),
        (HELD | {"Q": GRID + 1}, "vertex 0 belongs to no face"),
        ({"Q": TORUS, "start": np.exp(1j * np.arange(30))}, "collapses"),
        ({"Q": TORUS, "boundary": CIRCLE}, "no boundary to lay along an outline"),
    ],
)
def test_bad_input_is_named(given, words):
    with pytest.raises(ValueError, match=words):
        planar.planar_net(**{"Q": GRID, "theta": T, "theta0": T0} | given)


def test_a_net_with_a_face_that_collapses_is_refused_by_name():
    z = conformal.sheared_grid(T, T0, 4, 3)
    _, Q = conformal.quads(z)
    z = (z.ravel() - z.ravel()[Q[5]].mean()) ** 2  # exact images of a grid, twice around face 5
    d1, d2 = z[Q[:, 2]] - z[Q[:, 0]], z[Q[:, 3]] - z[Q[:, 1]]
    assert np.abs(d2 / d1 - (d2 / d1)[0])[np.arange(len(Q)) != 5].max() < 1e-9
    assert abs(d1[5]) < 1e-12 < np.abs(d1).min(where=np.arange(len(Q)) != 5, initial=1)
    with pytest.raises(ValueError, match="the net collapses at face 5: ask for less"):
        planar.planar_net(Q, T, T0, start=z, smooth=0)


Z = sympy.Symbol("z")
MAPS = {
    "z^2": (Z**2, 0),
    "exp": (sympy.exp(Z), 1),
    "sin": (sympy.sin(Z), -1),
    "1/z": (1 / Z, None),
    "z^3": (Z**3, None),
    "tan": (sympy.tan(Z), None),
}


@pytest.mark.parametrize("name", MAPS)
def test_the_leading_error_is_right_and_the_rest_of_fourth_order(name):
    f, wanted = MAPS[name]
    z, u = 0.7 + 0.4j, 0.2 + 0.05j
    v = u * conformal.sheared_grid(T, T0, 1, 1)[0, 1]
    call, first, third = (sympy.lambdify(Z, f.diff(Z, k), "numpy") for k in (0, 1, 3))
    rest = []
    for h in (1, 1 / 2, 1 / 4):
        found = conformal.cell_errors(call, z, h * u, h * v)
        said = conformal.leading_errors(first(z), third(z), h * u, h * v)
        rest.append(np.abs(np.subtract(found, said)))
        assert np.all(np.abs(found) > 1e-4 * h**2) or name == "z^2"
    if name == "z^2":
        assert np.max(rest) < 1e-13
    else:
        order = np.log2(np.array(rest)[:-1] / np.array(rest)[1:])
        assert np.abs(order[:, 0] - 4).max() < 0.15
        assert order[:, 1].min() > 3.85  # 6 for 1/z
    kappa = conformal.kappa(f, Z)
    assert kappa == wanted if wanted is not None else kappa.has(Z)
