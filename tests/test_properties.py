"""Invariants of the public functions over random valid input, judged by code of the test's own."""

from collections import Counter
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import Delaunay
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

# isort: off
from inetlib import conformal, design, developable, io, loxodrome, measure, mesh, moebius
from inetlib import parallelogram, planar, reference, repair, solver, surfaces

seeds = st.integers(0, 2**32 - 1).map(np.random.default_rng)
angle, small = st.floats(0.5, 2.6), st.integers(2, 5)
profiles = st.sampled_from(sorted(surfaces.PROFILES))
GOALS = ("theta", "theta0"), ("theta",), ("theta0",), ("lam", "mu"), ("lam",), ("equal",)
BITS = ".obj", ".ply", ".off", ".3dm", ".stl", ".glb"
close = partial(np.testing.assert_allclose, rtol=1e-7, atol=1e-9)


def turned(rng):
    return Rotation.from_rotvec(2 * rng.normal(size=3)).as_matrix()


def patch(rng, m, n, rough=0.0):
    """A wavy grid of m x n quads somewhere in space, its vertices moved by up to `rough`."""
    x, y = np.mgrid[: m + 1, : n + 1].reshape(2, -1)
    a, b, c = rng.uniform(-1, 1, 3)
    z = 0.5 * np.sin(0.7 * x + 3 * a) * np.cos(0.7 * y + 3 * b)
    V = np.stack([x + 0.4 * c * y, y, z], axis=1) + rough * rng.uniform(-1, 1, (len(x), 3))
    return V @ turned(rng) + rng.normal(size=3), mesh.grid_quads(m, n)


def sheet(rng, m, n):
    V, Q = patch(rng, m, n, 0.1)
    return V, np.concatenate([Q[:, [0, 1, 2]], Q[:, [0, 2, 3]]])


def sides(faces):
    return [(a, b) for f in np.asarray(faces).tolist() for a, b in pairwise([*f, f[0]])]


def links(curves):
    return Counter((min(a, b), max(a, b)) for c in curves for a, b in pairwise(map(int, c)))


def areas(V, T):
    a, b, c = np.moveaxis(V[T], 1, 0)
    return np.cross(b - a, c - a) / 2


def judged(V, Q):
    """((theta, theta0) of all faces, darts, flipped faces), each face in a complex plane."""
    e1, e3 = V[Q[:, 2]] - V[Q[:, 0]], np.cross(V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]])
    e1, e3 = (e / np.linalg.norm(e, axis=1, keepdims=True) for e in (e1, e3))
    z = np.einsum("fcx,fxk->fck", V[Q], np.stack([e1, np.cross(e3, e1)], axis=2)) @ [1, 1j]
    K = (z[:, 3] - z[:, 1]) / (z[:, 2] - z[:, 0])
    turn = np.angle((np.roll(z, -1, 1) - z) / (z - np.roll(z, 1, 1)))
    owner = {side: k // 4 for k, side in enumerate(sides(Q))}
    around = np.zeros_like(e3)
    for (a, b), face in owner.items():
        around[face] += e3[owner[b, a]] if (b, a) in owner else 0
    darts, flipped = (turn < -1e-8).any(axis=1), np.sum(around * e3, axis=1) < -1e-12
    return np.angle([K, (K - 1) / (K + 1)]), np.flatnonzero(darts), np.flatnonzero(flipped)


def require_net(V, Q, theta, theta0):
    found, darts, flipped = judged(V, Q)
    assert not len(darts) and not len(flipped)
    assert np.abs(found - [[theta], [theta0]]).max() < 1e-10


@given(st.floats(-3, 3), st.floats(0.05, 3.09), seeds)
def test_a_parallelogram_in_the_complex_plane_has_all_its_numbers(log_lam, theta, rng):
    K = np.exp(log_lam + 1j * theta)  # A, with B = 0, C = 1, D = 1 + K
    lam, mu, rho = abs(K), abs(1 + K) / abs(1 - K), (K - 1) / (K + 1)
    halves, theta0 = np.angle([K / (1 + K), 1 + K]), np.angle(rho)
    lines, shape = np.array(parallelogram.directions(rho)), (lam, mu, theta, theta0)
    close([*parallelogram.ratios(theta, theta0), *parallelogram.angles(lam, mu)], shape)
    close([*parallelogram.from_rho(rho), parallelogram.rho(lam, mu)], [*shape, rho])
    close(parallelogram.half_angles(lam, mu), halves)
    close(parallelogram.cosines(lam, mu), np.cos([theta, theta0]))
    close(parallelogram.half_cosines(lam, mu), np.cos(halves))
    close(parallelogram.lengths(lam, mu), (1, lam, abs(1 - K), abs(1 + K)))
    close(parallelogram.diagonals(1, lam, theta), (abs(1 - K), abs(1 + K)))
    close(parallelogram.gaps(lam, mu), np.angle(np.append(lines[1:], lines[0]) / lines) % np.pi)
    low, high = parallelogram.lam_range(mu)
    assert low < lam < high and not parallelogram.is_admissible(low * (1 - 1e-9), mu)
    p, q = rng.normal(size=(2, 2)) @ [1, 1j]
    image = parallelogram.cross_ratio(*(p * z + q * np.conj(z) for z in lines[[0, 2, 1, 3]]))
    assert image == pytest.approx(-1, rel=1e-6)  # harmonic, and so in all linear maps


@given(seeds, st.sampled_from([4, 6, 8]), st.integers(1, 3), st.booleans())
def test_any_shuffled_part_of_a_mesh_is_labelled_and_its_curves_cover_it(rng, corners, rings, all_):
    V, Q, _ = mesh.polygon_rings(corners, rings)
    part = rng.permutation(len(Q))[: None if all_ else rng.integers(1, len(Q) + 1)]
    given_ = np.array([np.roll(f[:: rng.choice([1, -1])], rng.integers(4)) for f in Q[part]])
    Q = mesh.label(given_)
    assert (Q[0] == given_[0]).all() and (np.sort(Q) == np.sort(given_)).all()
    slots = {}
    for k, (a, b) in enumerate(sides(Q)):
        slots.setdefault((min(a, b), max(a, b)), []).append((k % 2, a < b))
    assert slots.keys() == links(sides(given_)).keys()
    shared = [tuple(zip(*both, strict=True)) for both in slots.values() if len(both) > 1]
    assert all(slot[0] == slot[1] and way[0] != way[1] for slot, way in shared)
    curves = mesh.polylines(Q)
    for slot, found in enumerate((curves.v, curves.u)):
        assert links(found) == {edge: 1 for edge, both in slots.items() if both[0][0] == slot}
    assert links(curves.d1) == links(Q[:, ::2]) and links(curves.d2) == links(Q[:, 1::2])
    board, valence = mesh.checkerboard(V, Q), np.bincount(Q.ravel(), minlength=len(V))
    valence[[v for edge, both in slots.items() if len(both) == 1 for v in edge]] = 0
    counts = len(board.V), len(board.black), *sorted(map(len, [*board.white, *board.others]))
    assert counts == (len(slots), len(Q), *sorted(valence[valence > 0]))
    close(board.V[board.black[:, ::2]].mean(axis=1), board.V[board.black[:, 1::2]].mean(axis=1))


@given(seeds, st.floats(1e-4, 1e4), small, small)
def test_similarities_and_half_turns_of_labels_change_nothing(rng, scale, m, n):
    V, Q = patch(rng, m, n, 0.45)
    W, R = scale * V @ turned(rng) + rng.normal(size=3), np.roll(Q, rng.choice([0, 2]), axis=1)
    one, two, turn = (measure.quality(*net) for net in ((V, Q), (W, R), (V, np.roll(Q, 1, axis=1))))
    [close(a, b) for a, b in zip(one, two, strict=True)]
    for f in (measure.ratios, measure.angles, measure.web_angles, measure.theta_defect):
        close(f(V, Q), f(W, R))
    for found, wanted in zip((measure.angles(V, Q), *one[3:0:-2]), judged(V, Q), strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-9)
    assert turn.nonconvex.tolist() == one.nonconvex.tolist()
    close(measure.ratios(V, np.roll(Q, 1, axis=1)), 1 / np.array(measure.ratios(V, Q)))
    close(turn[4:], one[4:])


@given(angle, angle, seeds)
def test_images_of_grids_made_for_kappa_have_both_angles_exactly(theta, theta0, rng):
    a, b, g, h, origin = rng.normal(size=(5, 2)) @ [1, 1j]
    z = 0.3 * g * conformal.sheared_grid(theta, theta0, 3, 2, origin, 0.5, h, 0.09 * g**2)
    V, Q = conformal.quads(a * np.exp(z) + b * np.exp(-z))
    assert np.abs(judged(V, Q)[0] - [[theta], [theta0]]).max() < 1e-8


@given(seeds)
def test_moebius_maps_come_back_and_keep_cross_ratios(rng):
    z, w, x = rng.normal(size=(3, 4, 2)) @ [1, 1j]
    M = conformal.moebius_through(z[:3], w[:3])
    close(conformal.moebius(M, z[:3]), w[:3])
    close(conformal.moebius(np.linalg.inv(M), conformal.moebius(M, x)), x, rtol=1e-6)
    V = np.stack([x.real, x.imag, w.real], axis=1)
    M = np.linalg.multi_dot([moebius.inversion(3 * c + [5, 0, 0], 5) for c in turned(rng)])
    one, two = (cdist(W, W)[[0, 2, 0, 1], [1, 3, 2, 3]] for W in (V, moebius.apply(M, V)))
    close(two[0] * two[1] / (two[2] * two[3]), one[0] * one[1] / (one[2] * one[3]), rtol=1e-6)
    z *= 10 ** rng.uniform(-4, 4, 4)
    close(moebius.stereographic(moebius.sphere_points(z)) / z, 1)


@given(seeds, st.sampled_from([0, 4, 6]), angle, angle)
def test_planar_nets_have_their_angles_and_move_with_their_handles(rng, corners, theta, theta0):
    Q = mesh.polygon_rings(corners, 3)[1] if corners else mesh.grid_quads(*rng.integers(1, 6, 2))
    held, (a, b, *z) = rng.choice(Q.max() + 1, 2, replace=False), rng.normal(size=(4, 2)) @ [1, 1j]
    V, W = (planar.planar_net(Q, theta, theta0, (held, p)).V for p in (z, a * np.array(z) + b))
    assert (V[held, :2] @ [1, 1j] == z).all()
    assert np.abs(judged(V, Q)[0] - [[theta], [theta0]]).max() < 1e-9
    close(W[:, :2] @ [1, 1j], a * (V[:, :2] @ [1, 1j]) + b, atol=1e-6 * np.abs(W).max())


@settings(max_examples=10)
@given(seeds, profiles, st.floats(-2, 2), st.booleans())
def test_meridians_have_isothermal_parameters_that_come_back(rng, name, pitch, spline):
    profile = surfaces.PROFILES[name]()
    if spline:
        points = rng.uniform(1, 1.3, 6), np.cumsum(rng.uniform(0.5, 1, 6))
        profile = surfaces.spline_profile(np.transpose(points))
    w_of_t, t_of_w = surfaces.mercator(profile)
    t = np.linspace(profile.start, profile.stop, 20001)
    close(t_of_w(w_of_t(t)), t)
    r, moved = profile.radius(t), np.hypot(np.diff(profile.radius(t)), np.diff(profile.height(t)))
    close(np.diff(w_of_t(t)), 2 * moved / (r[1:] + r[:-1]), rtol=1e-5)
    surface, stop = surfaces.helical_isothermal(profile, pitch)
    z, h = rng.uniform(-3, 3, 20) + 1j * rng.uniform(0.01, 0.99, 20) * stop, 1e-4 * stop
    a, b = (np.subtract(*(surface.point((z + d).real, (z + d).imag) for d in (s, -s)))
            for s in (h, 1j * h))  # fmt: skip
    E, F, G = (np.sum(p * q, axis=1) for p, q in ((a, a), (a, b), (b, b)))
    close([G / E, 1 + F / E], 1, atol=1e-5)


@settings(max_examples=20)
@given(st.floats(-3, 3), st.floats(0.4, 2.7), seeds)
def test_bent_nets_keep_lengths_and_angles(curvature, gamma, rng):
    z = rng.uniform(0.2, 1, (6, 2)) @ [1, 0.1j]
    line = developable.bezier(np.column_stack([range(4), rng.normal(size=4)]))
    bow = [[0, 0, 0], [1, 0, 0.1], [2, 1, 0.1], [2.5, 2, rng.uniform(0, 0.6)]]
    curve = developable.arc_length(developable.bezier(bow))
    for bend in (
        partial(developable.roll, curvature=curvature, direction=np.exp(4j * gamma)),
        partial(developable.cone, gamma=gamma, direction=1 + 1j),
        partial(developable.cylinder, directrix=developable.arc_length(line)),
        lambda z: developable.rectifying(z + 1, curve),
    ):
        a, b = ((bend(z + h) - bend(z - h)) / 2e-5 for h in (1e-5, 1e-5j))
        close([np.sum(p * q, axis=1) for p, q in ((a, a), (b, b))], 1, atol=1e-6)
        close(np.sum(a * b, axis=1), 0, atol=1e-6)


@given(st.integers(1, 5), profiles, angle, angle, st.integers(3, 40))
def test_webs_of_loxodromes_have_their_angles_or_say_why_not(rows, name, theta, theta0, m):
    profile = surfaces.PROFILES[name]()
    try:
        net = loxodrome.web(profile, theta, theta0, m, rows)
    except ValueError as error:
        assert "not one row" in str(error)
        return
    found, darts, flipped = judged(net.V, net.Q)
    assert np.abs(found - [[theta], [theta0]]).max() < 1e-9
    bad = len(set(darts) | set(flipped))
    assert (f"{bad} faces are flipped or darts" in net.message) == (bad > 0)
    close(np.hypot(*net.V.T[:2]).reshape(m, -1), profile.radius(net.t) + np.zeros((m, 1)))


@given(seeds, st.sampled_from(GOALS), angle, angle, small, small, st.integers(0, 29))
def test_converged_means_what_an_independent_judge_finds(rng, names, theta, theta0, m, n, kind):
    V, Q = patch(rng, m, n, 0.15)
    K = np.exp(1j * theta) * parallelogram.ratios(theta, theta0)[0]
    shape = dict(theta=theta, theta0=theta0, lam=abs(K), mu=abs(1 + K) / abs(1 - K), equal=True)
    how = dict(fixed=rng.choice(len(V), kind % 3, False), residual=("log", "quadratic")[kind % 2])
    how["reference"] = None if kind % 5 else reference.mesh(V, Q)
    found = solver.optimize(V, Q, **{name: shape[name] for name in names}, **how)
    assert (found.V[how["fixed"]] == V[how["fixed"]]).all()
    assert found.message.startswith("converged" if found.converged else "not converged")
    if found.converged:
        require_net(found.V, Q, found.theta, found.theta0)
        close([getattr(found, name, True) for name in names], [shape[name] for name in names])
        assert "equal" not in names or abs(found.theta - found.theta0) < 1e-10


@given(seeds, small, small, st.floats(0, 2))
def test_no_sampled_point_of_the_surface_is_nearer_than_the_closest(rng, m, n, far):
    V, T = sheet(rng, m, n)
    goal, points = reference.mesh(V, T), rng.permutation(V) + far * rng.normal(size=V.shape)
    some = rng.dirichlet([0.7] * 3, 2000)[:, None] @ V[T[rng.integers(len(T), size=2000)]]
    feet, _ = goal.closest(points)
    off = np.linalg.norm(feet - points, axis=1)
    assert (off <= cdist(points, some[:, 0]).min(axis=1) + 1e-9).all()
    assert (cdist(feet, some[:, 0]).min(axis=1) < 0.5).all()
    close(goal.closest(some[:, 0])[0], some[:, 0])
    rim = np.array([edge for edge, often in links([[*f, f[0]] for f in T]).items() if often == 1])
    a, b = V[rim[rng.integers(len(rim), size=2000)]].transpose(1, 0, 2)
    feet, *frame = goal.boundary(points)
    off, some = np.linalg.norm(feet - points, axis=1), a + rng.random((2000, 1)) * (b - a)
    assert (off <= cdist(points, some).min(axis=1) + 1e-9).all()
    close(np.einsum("ikx,jkx->kij", frame, frame), np.tile(np.eye(3), (len(V), 1, 1)))


@given(seeds, st.integers(4, 12), st.booleans())
def test_stars_keep_area_and_side_in_triangles_with_a_bridged_hole_too(rng, k, hole):
    z = np.exp(2j * np.pi / k * (np.arange(k) + rng.uniform(0, 0.8, k))) * rng.uniform(0.2, 1, k)
    matrix, face = turned(rng), np.arange(k)
    if hole:
        near = np.abs(np.imag(np.conj(z) * np.roll(z, -1)) / (np.roll(z, -1) - z)).min()
        z = np.append(z, rng.uniform(0.2, 0.8, k) * near * z / np.abs(z))
        face = np.array([*range(k), 0, k, *range(2 * k - 1, k - 1, -1)])
    V, face = z[:, None].view(float) @ matrix[:2], np.roll(face, rng.integers(k))
    T = repair.triangulate(V, [face])
    wanted = np.sum(np.imag(np.conj(z[face]) * np.roll(z[face], -1))) / 2
    found = areas(V, T) @ matrix[2]
    assert found.min() > 0 and found.sum() == pytest.approx(wanted, rel=1e-9)
    assert len(T) == len(face) - 2 and Counter(sides(T)) >= Counter(sides([face]))


@given(seeds, small, small, st.booleans())
def test_an_unwelded_shuffled_partly_flipped_sheet_with_t_junctions_is_mended(rng, m, n, split):
    V, T = sheet(rng, m, n)
    P = V[T]
    if split:  # two vertices on one side of some triangles, not on that of the neighbour
        which = rng.choice(len(P), rng.integers(1, len(P)), replace=False)
        a, b, c = P[which].transpose(1, 0, 2)
        d, e = (a + s * (b - a) for s in np.sort(rng.uniform(0.1, 0.9, (2, len(a), 1)), axis=0))
        fan = [np.stack(f, axis=1) for f in ((a, d, c), (d, e, c), (e, b, c))]
        P = np.concatenate([np.delete(P, which, axis=0), *fan])
    P = rng.permutation(P)
    flips = rng.choice(len(P), rng.integers((len(P) - 1) // (14 if split else 2) + 1), False)
    P[flips] = P[flips, ::-1]
    W, F, said = repair.manifold(P.reshape(-1, 3), np.arange(3 * len(P)).reshape(-1, 3))
    edges = Counter(sides(F))
    assert max(edges.values()) == 1 and len(W) - len(links(edges)) + len(F) == 1
    for x in (lambda x: x, partial(np.linalg.norm, axis=1)):  # the same sides up, the same area
        close(x(areas(W, F)).sum(axis=0), x(areas(V, T)).sum(axis=0))
    assert {*map(tuple, V.tolist())} <= {*map(tuple, W.tolist())}
    assert split or (len(W) == len(V) and len(F) == len(T))
    assert any("turned" in words for words in said) == (len(flips) > 0)


@settings(max_examples=5)
@given(seeds, angle, angle)
def test_covers_of_bumpy_disks_are_good_or_say_that_they_are_not(rng, theta, theta0):
    z = np.concatenate([r / 7 * np.exp(2j * np.pi * np.arange(6 * r) / 6 / r) for r in range(1, 8)])
    T = Delaunay(z[:, None].view(float)).simplices
    z *= 1 + 0.15 * np.sin(3 * np.angle(z) + rng.uniform(0, 6))
    height = 0.3 * np.sin(2 * z.real + rng.uniform(0, 6)) * np.cos(2 * z.imag + rng.uniform(0, 6))
    V = np.stack([z.real, z.imag, height], axis=1) @ turned(rng)
    net = design.cover(V, T, theta, theta0, count=60)
    if net.report.converged:
        require_net(net.V, net.Q, theta, theta0)
        assert cdist(net.V, V).min(axis=1).max() < 0.2
    assert net.report.converged or "not converged" in net.report.message


@pytest.mark.parametrize("suffix", [*BITS, pytest.param(".vtp", marks=pytest.mark.long)])
@settings(max_examples=6)
@given(arrays(float, (12, 3), elements=st.floats(-1e99, 1e99)), seeds)
def test_files_give_back_bit_by_bit_what_was_written(tmp_path_factory, suffix, V, rng):
    if io.missing(suffix):
        pytest.skip(f"no package for {suffix}")
    path, Q = tmp_path_factory.getbasetemp() / f"net{suffix}", mesh.grid_quads(3, 2)
    V, Q, soup = V * 1e-62 if suffix == ".3dm" else V, rng.permutation(12)[Q], suffix in io.SOUPS
    polygons = [] if soup or suffix == ".3dm" else [rng.permutation(12)[:k] for k in (3, 5, 7)]
    if soup:  # triangles, float32
        V, Q = (x.astype(kind) for x, kind in zip(sheet(rng, 3, 2), ("f4", int), strict=True))
    io.write(path, V, Q, polygons=polygons, force=True)
    W, F, *others = io.read(path) if soup else io.net(path)
    if soup:
        assert np.abs(W[F] - V[Q]).max() <= (1e-6 if suffix == ".glb" else 0)
    else:
        assert W.tobytes() == V.tobytes() and (F == Q).all()
        assert [x.tolist() for x in others[0]] == [x.tolist() for x in polygons]
