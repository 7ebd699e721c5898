"""Webs on surfaces of revolution, judged by `measure`, by closed forms and by brute force."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, root

from inetlib import loxodrome, measure, mesh, parallelogram, surfaces
from inetlib.surfaces import Profile

DEG = np.pi / 180
SURFACES = {name: make() for name, make in surfaces.PROFILES.items()}
SPHERE, VASE = SURFACES["sphere"], SURFACES["vase"]
each_surface = pytest.mark.parametrize("profile", SURFACES.values(), ids=SURFACES)


def deviation(net, theta, theta0):
    """The largest deviations of both angles, radians."""
    return np.abs(measure.deviations(net.V, net.Q, theta, theta0)).max(axis=1)


def longitudes(points):
    return np.unwrap(np.arctan2(points[:, 1], points[:, 0]))


def outwards(V, Q, centre):
    """Whether the quads' normals point away from centre(middle of the quad)."""
    normal = np.cross(V[Q[:, 2]] - V[Q[:, 0]], V[Q[:, 3]] - V[Q[:, 1]])
    return (np.einsum("ij,ij->i", normal, V[Q].mean(axis=1) * centre) > 0).all()


@each_surface
@pytest.mark.parametrize("degrees", [60, 110])
def test_a_loxodrome_meets_the_parallels_at_its_angle(profile, degrees):
    points = loxodrome.loxodrome(profile, degrees * DEG, angle=0.3, samples=801)
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    tangent = sum(w * points[k : len(points) - 8 + k] for k, w in enumerate(weights))
    x, y, _ = points[4:-4].T
    east = np.stack([-y, x, 0 * x], axis=1)
    cross = np.linalg.norm(np.cross(east, tangent), axis=1)
    found = np.arctan2(cross, np.einsum("ij,ij->i", east, tangent))
    assert np.abs(found / DEG - degrees).max() < 1e-9


def test_loxodromes_of_sphere_and_cone_in_closed_form():
    points = loxodrome.loxodrome(SPHERE, 60 * DEG, angle=0.2)
    latitude = np.arcsin(points[:, 2])
    mercator = np.arctanh(np.sin(latitude)) - np.arctanh(np.sin(-1.2))
    assert longitudes(points) - 0.2 == pytest.approx(mercator / np.tan(60 * DEG), abs=1e-10)
    points = loxodrome.loxodrome(SURFACES["cone"], 60 * DEG)
    spiral = 0.2 * np.exp(longitudes(points) * np.sin(30 * DEG) * np.tan(60 * DEG))  # logarithmic
    assert np.linalg.norm(points, axis=1) == pytest.approx(spiral, abs=1e-10)
    meridian = loxodrome.loxodrome(VASE, np.pi / 2, samples=20)
    assert np.abs(meridian[:, 1]).max() < 1e-14 and len(meridian) == 20


@each_surface
def test_500_random_exact_webs_keep_their_angles_or_do_not_fit(profile):
    rng = np.random.default_rng(53)
    built = 0
    for _ in range(500):
        theta, theta0 = rng.uniform(15, 165, 2) * DEG
        m = int(rng.integers(8, 61))
        try:
            net = loxodrome.web(profile, theta, theta0, m, n=4)
        except ValueError as error:
            assert "not one row" in str(error)
            continue
        built += 1
        assert deviation(net, theta, theta0).max() / DEG < 1e-9
        assert net.rows == 4 or f"{net.rows} of 4 rows" in net.message
    assert built > 450


@each_surface
@pytest.mark.parametrize("degrees", [(60, 45), (90, 90), (130, 70), (75, 120)])
def test_whole_exact_webs_reach_the_end_of_the_meridian(profile, degrees):
    theta, theta0 = np.array(degrees) * DEG
    net = loxodrome.web(profile, theta, theta0, 48)
    assert deviation(net, theta, theta0).max() / DEG < 1e-10
    assert net.t[0] == profile.start and net.t[-1] <= profile.stop
    assert measure.quality(net.V, net.Q).flips == 0
    more = loxodrome.web(profile._replace(stop=profile.stop + 0.01), theta, theta0, 48)
    assert more.t[: net.rows + 1] == pytest.approx(net.t, abs=1e-12)
    step = 2 * np.pi / 48 * np.sin(theta0) / parallelogram.ratios(theta, theta0)[1]
    assert surfaces.mercator(profile)[0](profile.stop) / step - net.rows < 1.1


RIPPLED = Profile(lambda t: 1 + 0.2 * np.sin(25 * t), lambda t: 1.0 * t, 0.0, 2.0)
RINGS = [(SURFACES[k], 12, x) for k in ("sphere", "torus", "cone") for x in ((60, 45), (120, 60))]


@pytest.mark.parametrize(("profile", "m", "degrees"), [*RINGS, (RIPPLED, 6, (150, 40))])
def test_the_exact_ring_is_the_lowest_parallel_that_carries_such_quads(profile, m, degrees):
    theta, theta0 = np.array(degrees) * DEG
    net = loxodrome.web(profile, theta, theta0, m, n=1)
    low, high = net.t
    t = low + (high - low) * np.linspace(0.02, 0.95, 94)[:, None]
    turn = np.linspace(-np.pi, np.pi, 721)[None, :]
    corner = [(turn, t), (0, low), (2 * np.pi / m, low), (turn + 2 * np.pi / m, t)]
    v1, v2, v3, v4 = (surfaces.revolve(profile, *c) + 0 * t[..., None] for c in corner)
    d1, d2 = v3 - v1, v4 - v2

    def between(a, b):
        return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(axis=-1))

    off = np.hypot(between(d1, d2) - theta, between(d1 + d2, d2 - d1) - theta0)
    assert off.min() > 0.7 * DEG  # every quad below is wrong ...
    assert deviation(net, theta, theta0).max() < 1e-12  # ... and this one right


def test_reflection_scaling_and_parameter_change_nothing_and_cylinders_have_congruent_quads():
    theta, theta0 = 70 * DEG, 50 * DEG
    net, mirrored = (loxodrome.web(VASE, theta, x, 20) for x in (theta0, np.pi - theta0))
    assert mirrored.t == pytest.approx(net.t, abs=1e-12)
    turn = [longitudes(n.V[: n.rows + 1]) for n in (net, mirrored)]
    assert turn[0] == pytest.approx(-turn[1], abs=1e-12)
    large = Profile(
        lambda t: 7 * VASE.radius(t**3), lambda t: 7 * VASE.height(t**3), 0.1, 3.2 ** (1 / 3)
    )
    small = loxodrome.web(VASE._replace(start=0.1**3), theta, theta0, 20)
    found = loxodrome.web(large, theta, theta0, 20)
    np.testing.assert_allclose(found.V, 7 * small.V, atol=1e-10)
    cylinder = Profile(lambda t: 1.0, lambda t: 2 * t, 0, 3)
    for method in ("exact", "smooth"):
        net = loxodrome.web(cylinder, 60 * DEG, 45 * DEG, 30, method=method)
        assert np.ptp(np.diff(net.t)) < 1e-10
    assert deviation(loxodrome.web(cylinder, 1, 2, 30), 1, 2).max() < 1e-12


def test_rows_end_where_the_radius_changes_too_fast_and_missing_ones_are_announced():
    disk = Profile(lambda t: 1 + t, lambda t: 0 * t, 0, 1000)
    with pytest.raises(ValueError, match="no quad with these angles stands where the radius is 1"):
        loxodrome.web(disk, 128 * DEG, 94 * DEG, 4)
    net = loxodrome.web(disk, 128 * DEG, 94 * DEG, 8, n=2)
    assert net.rows == 2 and deviation(net, 128 * DEG, 94 * DEG).max() < 1e-12
    for method in ("exact", "smooth"):
        net = loxodrome.web(SPHERE, 60 * DEG, 45 * DEG, 24, n=100, method=method)
        assert net.rows == 26
        assert net.message.startswith("26 of 100 rows of 24 quads: a further one does not fit")
        assert net.message.endswith("the profile is too short")


def test_numbering_labels_orientation_and_families():
    net = loxodrome.web(SURFACES["torus"], 70 * DEG, 55 * DEG, 18, n=7)
    assert net.V.shape == (18 * 8, 3) and net.Q.shape == (18 * 7, 4) and net.rows == 7
    assert net.Q[0].tolist() == [1, 0, 8, 9]  # v1 above v2, v3 the next around
    assert mesh.is_labelled(net.Q) and len(mesh.boundary_loops(net.Q)) == 2
    assert net.V[0] == pytest.approx([1.2, 0, 0]) and len(net.t) == 8
    assert (net.theta, net.theta0) == (70 * DEG, 55 * DEG)
    assert net.message == "7 rows of 18 quads: as many as asked for"
    rings = np.linalg.norm(net.V.reshape(18, 8, 3)[..., :2], axis=-1)
    np.testing.assert_allclose(rings, np.tile(2 + 0.8 * np.cos(net.t), (18, 1)))

    def steps(lines):
        pairs = [np.stack([line[:-1], line[1:]], 1) for line in lines]
        return {tuple(sorted(map(tuple, pair.round(9)))) for pair in np.concatenate(pairs)}

    for family, curves in zip(net.families, mesh.polylines(net.Q), strict=True):
        assert steps(family) == steps([net.V[c] for c in curves])
    assert [len(f) for f in net.families] == [8, 18, 18, 18]
    assert all(np.array_equal(line[0], line[-1]) for line in net.families.u)


def test_smooth_webs_in_closed_form_on_the_sphere():
    net = loxodrome.web(SPHERE, 60 * DEG, 45 * DEG, 24, method="smooth")
    mu = parallelogram.ratios(60 * DEG, 45 * DEG)[1]
    w = np.arange(net.rows + 1) * 2 * np.pi / 24 * np.sin(45 * DEG) / mu
    assert np.sin(net.t) == pytest.approx(np.tanh(w + np.arctanh(np.sin(-1.2))), abs=1e-10)
    assert longitudes(net.V[: net.rows + 1]) == pytest.approx(w / np.tan(45 * DEG), abs=1e-10)


@each_surface
def test_the_angles_of_smooth_webs_are_off_by_the_square_of_the_mesh_size(profile):
    nets = [loxodrome.web(profile, 1.1, 0.8, m, method="smooth") for m in (48, 96, 192)]
    off = [deviation(net, 1.1, 0.8) for net in nets]
    assert np.all((off[0] / off[1] > 3.8) & (off[0] / off[1] < 4.2))
    assert np.all((off[1] / off[2] > 3.9) & (off[1] / off[2] < 4.1))


def test_the_constants_of_that_law_and_of_the_published_algorithm_on_the_sphere():
    wide = surfaces.sphere_profile(start=-1.45, stop=1.45)
    net = loxodrome.web(wide, 60 * DEG, 45 * DEG, 192, method="smooth")
    assert deviation(net, 60 * DEG, 45 * DEG) * 192**2 == pytest.approx([3.05, 2.84], abs=0.02)

    def constants(m, equation):
        net = loxodrome.web(SPHERE, 60 * DEG, 60 * DEG, m, method="paper", equation=equation)
        return deviation(net, 60 * DEG, 60 * DEG) * m**2

    assert constants(24, "lam")[0] == pytest.approx(9.87, abs=0.02)
    assert constants(192, "lam") == pytest.approx([9.64, 2.41], abs=0.01)
    assert constants(192, "mu") == pytest.approx([0.60, 2.41], abs=0.01)


@pytest.mark.parametrize("degrees", [(60, 45), (115, 45), (60, 130), (115, 130)])
@pytest.mark.parametrize("equation", ["lam", "mu"])
def test_published_webs_approach_the_angles_on_either_side_of_90_degrees(degrees, equation):
    asked = np.array(degrees) * DEG
    nets = [loxodrome.web(VASE, *asked, m, 10, "paper", equation) for m in (96, 192)]
    coarse, fine = (deviation(net, *asked).max() for net in nets)
    assert fine < 0.3 * coarse < 0.03


def test_the_lam_equation_is_empty_at_theta0_90_and_has_no_root_at_theta_90():
    right = np.pi / 2
    with pytest.raises(ValueError, match=r"theta0 = 90 degrees.*holds on every parallel"):
        loxodrome.web(SPHERE, 1.0, right, 24, method="paper")
    with pytest.raises(ValueError, match=r"theta = 90 degrees.*double root"):
        loxodrome.web(SPHERE, right, 1.0, 24, method="paper")
    with pytest.raises(ValueError, match="no root"):
        loxodrome.web(SPHERE, 88 * DEG, 150 * DEG, 8, method="paper")
    for theta, theta0 in ((1.0, right), (right, 1.0)):
        net = loxodrome.web(SPHERE, theta, theta0, 96, method="paper", equation="mu")
        assert deviation(net, theta, theta0).max() < 1e-2


def ratios_of_eq_16(A, B, C, D):
    """Eq. (16), word for word."""
    length = np.linalg.norm
    lam = length(D - A, axis=-1) / length(B - C, axis=-1)
    return lam, length(B + D - A - C, axis=-1) / length(C + D - A - B, axis=-1)


M, ASKED = 24, (1.2, 0.9)


def own_ratios(theta, theta0):
    """(lam, mu) from Eq. (3), one unknown after the other until they agree."""
    lam = mu = 1.0
    for _ in range(60):  # (3) is cos theta = cosh(log lam) tanh(log mu), and so for theta0
        mu = np.exp(np.arctanh(np.cos(theta) / np.cosh(np.log(lam))))
        lam = np.exp(np.arctanh(np.cos(theta0) / np.cosh(np.log(mu))))
    return np.array([lam, mu])


def own_loxodrome():
    """Its angle on the vase as a function of the height, by an ODE."""

    def rate(t, _):
        slope = 0.33 * 1.9 * np.cos(1.9 * t + 0.25)
        return np.hypot(slope, 1) / (0.72 + 0.33 * np.sin(1.9 * t + 0.25)) / np.tan(ASKED[1])

    found = solve_ivp(rate, (0, 3.2), [0.0], "DOP853", rtol=1e-13, atol=1e-14, dense_output=True)
    return lambda t: found.sol(t)[0]


def own_quads(alpha, t0, t, turn=None):
    """A, B at the height t0; C, D at t on the loxodromes through A, B, or turned by `turn`."""
    corners = []
    for height, angle in ((t0, alpha(t0)), (t, alpha(t) if turn is None else alpha(t0) + turn)):
        r = 0.72 + 0.33 * np.sin(1.9 * height + 0.25)
        for x in (angle, angle + 2 * np.pi / M):
            corners.append(np.stack([r * np.cos(x), r * np.sin(x), height + 0 * x], axis=-1))
    return corners


@pytest.mark.parametrize(("which", "equation"), [(0, "lam"), (1, "mu")])
def test_eq_16_one_ratio_on_loxodromes_of_an_ode_by_own_brackets(which, equation):
    alpha, wanted = own_loxodrome(), own_ratios(*ASKED)
    net, rings = loxodrome.web(VASE, *ASKED, M, 6, "paper", equation), [0.0]

    def off(t):
        return ratios_of_eq_16(*own_quads(alpha, rings[-1], t))[which] / wanted[which] - 1

    for _ in range(6):  # the first change of sign
        t = rings[-1] + np.linspace(1e-3, 0.8, 400)
        change = np.flatnonzero(np.diff(np.sign(off(t))))[0]
        rings.append(brentq(off, t[change], t[change + 1], xtol=1e-14))
    np.testing.assert_allclose(net.t, rings, atol=1e-9)
    found = ratios_of_eq_16(*net.V[net.Q][:, [1, 2, 0, 3]].transpose(1, 0, 2))
    np.testing.assert_allclose(found[which], wanted[which], rtol=1e-9)
    assert np.abs(found[1 - which] / wanted[1 - which] - 1).max() > 1e-3
    values = loxodrome.residual(VASE, *ASKED, M, rings[-1], rings[-1] + t[::20], equation)
    ratio = ratios_of_eq_16(*own_quads(alpha, rings[-1], rings[-1] + t[::20]))[which]
    np.testing.assert_allclose(values, np.log(ratio / wanted[which]), atol=1e-9)


def test_eq_16_both_ratios_of_exact_webs_and_rings_by_newtons_method():
    alpha, wanted = own_loxodrome(), own_ratios(*ASKED)
    net = loxodrome.web(VASE, *ASKED, M)
    found = ratios_of_eq_16(*net.V[net.Q][:, [1, 2, 0, 3]].transpose(1, 0, 2))
    np.testing.assert_allclose(found, np.transpose([wanted] * len(net.Q)), rtol=1e-10)
    for low, high in zip(net.t[:8], net.t[1:9], strict=True):

        def off(x, low=low):
            return ratios_of_eq_16(*own_quads(alpha, low, *x)) - wanted

        t, _ = root(off, [1.03 * high - 0.03 * low, 0.9 * (alpha(high) - alpha(low))]).x
        assert t == pytest.approx(high, abs=1e-8)
        assert abs(loxodrome.residual(VASE, *ASKED, M, low, high)) < 1e-14
        assert loxodrome.residual(VASE, *ASKED, M, low, 0.9 * high + 0.1 * low) > 1e-5


def test_subnets_meet_at_the_angles_of_the_four_directions():
    theta, theta0 = 60 * DEG, 45 * DEG
    alpha, beta = parallelogram.half_angles(*parallelogram.ratios(theta, theta0))
    direction = {"u": 0, "v": theta0, "d1": -beta, "d2": alpha}
    net = loxodrome.web(VASE, theta, theta0, 96, n=12)
    for first in direction:
        for second in set(direction) - {first}:
            V, Q = loxodrome.subnet(net, first, second)
            mesh.check(V, Q)
            assert mesh.is_labelled(Q) and len(Q) >= 96 * 4
            meet = measure.angles(V, Q)[1]
            assert np.abs(meet - (direction[second] - direction[first]) % np.pi).max() < 0.1
            assert outwards(V, Q, [1, 1, 0])
    assert np.array_equal(loxodrome.subnet(net, "u", "v")[1], net.Q)


def test_subnets_use_the_edges_of_their_families_and_mirrored_ones_have_the_supplement():
    net = loxodrome.web(SURFACES["torus"], 1.2, 0.9, 10, n=6)
    chains = mesh.polylines(net.Q)._asdict()
    edges = {
        name: {frozenset(e) for line in lines for e in np.stack([line[:-1], line[1:]], 1).tolist()}
        for name, lines in chains.items()
    }
    for first, second in (("u", "d1"), ("v", "d1"), ("d1", "d2"), ("d2", "u"), ("d2", "v")):
        Q = loxodrome.subnet(net, first, second)[1].tolist()
        assert {frozenset(quad[1:3]) for quad in Q} <= edges[first]
        assert {frozenset(quad[0:2]) for quad in Q} <= edges[second]
    net = loxodrome.web(SPHERE, 60 * DEG, 45 * DEG, 24)
    V, Q = loxodrome.subnet(net, "u", "v", mirror=True)
    off = measure.deviations(V, Q, 60 * DEG, 135 * DEG)
    assert np.abs(off).max() < 1e-9 and outwards(V, Q, 1) and mesh.is_labelled(Q)


@pytest.mark.parametrize("pair", ["v v", "d1 d1", "d2 d2", "v d2", "d1 d2", "v d1"])
def test_a_family_and_a_mirrored_one_are_two_families_of_another_web(pair):
    """In the plane of angle and Mercator coordinate all are lines: Sec. 5.3, reflections."""
    theta, theta0 = 60 * DEG, 50 * DEG
    alpha, beta = parallelogram.half_angles(*parallelogram.ratios(theta, theta0))
    direction = {"v": theta0, "d1": np.pi - beta, "d2": alpha}
    first, second = (direction[name] for name in pair.split())
    slopes = sorted([1 / np.tan(first), -1 / np.tan(second)])
    shape = parallelogram.from_rho((slopes[1] + 1j) / (slopes[1] - slopes[0]))
    net = loxodrome.web(SPHERE, shape.theta, shape.theta0, 384, n=4, method="smooth")
    found = []
    for family in (net.families.v, net.families.d1):
        a, b = sorted(family[0][:2], key=lambda x: x[2])
        east = np.array([-a[1], a[0], 0])
        found.append(np.arctan2(np.linalg.norm(np.cross(east, b - a)), east @ (b - a)))
    assert sorted(found) == pytest.approx(sorted([first, np.pi - second]), abs=0.04)
    V, Q = loxodrome.subnet(net, "v", "d1")
    if first == second:  # symmetric, so rhombic
        assert measure.angles(V, Q)[0] == pytest.approx(np.pi / 2)


def test_subnets_that_do_not_exist():
    net = loxodrome.web(SPHERE, 1.0, 1.0, 9, n=2)
    with pytest.raises(ValueError, match="chessboard"):
        loxodrome.subnet(net, "d1", "d2")
    for pair in (("u", "u"), ("u", "w")):
        with pytest.raises(ValueError, match="two of u, v, d1, d2"):
            loxodrome.subnet(net, *pair)
    short = loxodrome.web(SPHERE, 1.0, 1.0, 8, n=1)
    for pair in (("v", "d1"), ("d1", "d2")):
        with pytest.raises(ValueError, match="too few"):
            loxodrome.subnet(short, *pair)


@pytest.mark.parametrize("m, n, shift", [(48, 24, 12), (48, 39, 12), (30, 20, -7), (25, 14, 0)])
def test_closed_torus_webs_close_and_are_exact(m, n, shift):
    net = loxodrome.torus_web(2, 0.8, m, n, shift)
    assert net.V.shape == (m * n, 3) and net.Q.shape == (m * n, 4) and net.rows == n
    assert deviation(net, net.theta, net.theta0).max() / DEG < 1e-10
    assert mesh.boundary_loops(net.Q) == [] and mesh.is_labelled(net.Q)
    assert measure.quality(net.V, net.Q).flips == 0
    assert net.t[-1] - net.t[0] == pytest.approx(2 * np.pi, abs=1e-12)
    assert np.abs(np.hypot(np.hypot(*net.V.T[:2]) - 2, net.V[:, 2]) - 0.8).max() < 1e-14
    around = net.families.u[0]
    assert np.array_equal(around[0], around[-1]) and len(net.families.u) == n


def test_subnets_of_a_closed_torus_are_closed_too_and_its_march_ends_where_it_started():
    net = loxodrome.torus_web(2, 0.8, 48, 24, 12)
    for pair, faces in ((("u", "d2"), 48 * 24), (("v", "d1"), 48 * 24), (("d1", "d2"), 48 * 12)):
        V, Q = loxodrome.subnet(net, *pair)
        assert len(Q) == faces and mesh.boundary_loops(Q) == [] and mesh.is_labelled(Q)
        mesh.check(V, Q)
    longer = surfaces.torus_profile(2, 0.8, -np.pi, 2 * np.pi)
    V = loxodrome.web(longer, net.theta, net.theta0, 48, n=24).V.reshape(48, 25, 3)
    assert np.abs(V[:, 24] - np.roll(V[:, 0], -12, axis=0)).max() < 1e-12
    assert (net.theta / DEG, net.theta0 / DEG) == pytest.approx((90.191, 60.182), abs=1e-3)


def test_closings_fulfil_the_closing_condition_find_a_closed_web_again_and_tie_by_m():
    period = quad(lambda t: 0.8 / (2 + 0.8 * np.cos(t)), -np.pi, np.pi)[0]
    found = loxodrome.closings(2, 0.8, 60 * DEG, 60 * DEG, limit=50, count=20)
    assert len(found) == 20
    for m, n, shift, theta, theta0 in found:
        step = 2 * np.pi / m * np.sin(theta0) / parallelogram.ratios(theta, theta0)[1]
        assert n * step == pytest.approx(period)
        assert period / np.tan(theta0) == pytest.approx(2 * np.pi * shift / m)
    off = [max(abs(c.theta - 60 * DEG), abs(c.theta0 - 60 * DEG)) for c in found]
    assert np.all(np.diff(off) > -1e-9) and off[0] < 0.3 * DEG and found[0][:3] == (16, 13, 4)
    every = loxodrome.closings(2, 0.8, 60 * DEG, 60 * DEG, limit=5, count=99)
    assert sorted(c[:2] for c in every) == [(m, n) for m in (3, 4, 5) for n in (3, 4, 5)]
    theta, theta0 = parallelogram.from_rho((12 + 48j * 0.8 / np.sqrt(2**2 - 0.8**2)) / 24)[2:]
    best = loxodrome.closings(2, 0.8, theta, theta0, limit=48)[0]
    assert best[:3] == (8, 4, 2)  # two rows (4, 2, 1) would be no net
    assert (best.theta, best.theta0) == pytest.approx((theta, theta0))
    for pair in np.radians([(90, 60), (60, 90), (90, 90)]):
        known = loxodrome.closings(np.sqrt(2), 1, *pair)
        for seed in range(6):
            noise = 1 + 1e-13 * np.random.default_rng(seed).standard_normal(3)
            found = loxodrome.closings(np.sqrt(2) * noise[0], 1, *pair * noise[1:])
            assert [c[:3] for c in found] == [c[:3] for c in known]


THIN = Profile(lambda t: 1e-170 + 0 * t, lambda t: 1.0 * t, 0, 1)  # its squares are 0
METHODS = ["exact", "smooth", "paper"]
BAD = [0, np.pi, -1.0, 60.0, np.nan, np.inf]
GLOBE = surfaces.sphere_profile(start=-np.pi / 2, stop=np.pi / 2 + 0.1)
TORI = [(1, 1), (1, 2), (2, -1), (np.nan, 1), (np.inf, 1)]
TURNS = [(2, 12, 1), (12, 2, 1), (12, 12, 0.5), (12, 12, np.nan)]
WRONG = [
    *((loxodrome.web, (SPHERE, x, 1, 12, None, k), "^theta = .*pi") for x in BAD for k in METHODS),
    *((loxodrome.web, (SPHERE, 1, x, 12, None, k), "^theta0 = .*pi") for x in BAD for k in METHODS),
    *((loxodrome.loxodrome, (SPHERE, x), "^theta0 = .*0 and pi") for x in BAD),
    *((loxodrome.web, (SPHERE, 1, 1, m), "^m = .*3 or more") for m in (2, 8.5, np.nan)),
    *((loxodrome.web, (SPHERE, 1, 1, 9, n), "^n = .*1 or more") for n in (0, 1.5, np.inf)),
    (loxodrome.web, (SPHERE, 1, 1, 12, None, "best"), "method = 'best'"),
    (loxodrome.web, (SPHERE, 1, 1, 12, None, "paper", "nu"), "equation = 'nu'"),
    (loxodrome.residual, (VASE, 1, 1, 12, 0.1, 0.2, "nu"), "equation = 'nu'"),
    (loxodrome.web, (SPHERE, [1, 1], 1, 12), "theta: one angle"),
    (loxodrome.web, (SPHERE, 1e-8, 1, 12), "rows of 12 quads fit: choose a smaller"),
    (loxodrome.web, (SPHERE._replace(stop=np.nan), 1, 1, 12), "start < stop"),
    *((loxodrome.web, (GLOBE, 1, 1, 12, None, how), "radius = .*positive") for how in METHODS),
    (loxodrome.loxodrome, (SPHERE, 1, np.nan), "angle = nan"),
    (loxodrome.loxodrome, (SPHERE, 1, 0, 1), "samples = 1"),
    (loxodrome.closings, (2, 1, 1, 1, 2), "limit = 2"),
    (loxodrome.web, (THIN, 1, 1, 12, 2), "not one row of 12 quads fits, no quad with these"),
    (loxodrome.torus_web, (2, 1.9, 4, 3, 40), "theta|torus"),
    (loxodrome.torus_web, (2.9, 0.9, 5, 3, -11), "shift = -11: the rows do not fit on the torus"),
    (loxodrome.torus_web, (1.7, 1.1, 11, 3, -10), "no closed web .*: take more quads"),
    *((loxodrome.torus_web, (2, 1, *turn), "whole number") for turn in TURNS),
    *((loxodrome.torus_web, (*radii, 9, 9, 1), "major") for radii in TORI),
    *((loxodrome.closings, (*radii, 1, 1), "major") for radii in TORI),
]


@pytest.mark.parametrize("function, arguments, words", WRONG)
def test_bad_arguments_are_named(function, arguments, words):
    with pytest.raises(ValueError, match=words):
        function(*arguments)


def test_too_many_rows_are_counted_in_closed_form_on_a_cylinder():
    """theta = 90, theta0 = 30 degrees: mu = 1, rows of the height 2 pi / m sin theta0."""
    for height in (1e4, 1e6):
        high = Profile(lambda t: 1 + 0 * t, lambda t: t, 0, height)
        rows = height * 12 / (2 * np.pi * 0.5)
        with pytest.raises(ValueError, match=f"about {rows:.0f} rows of 12 quads fit"):
            loxodrome.web(high, np.pi / 2, np.pi / 6, 12)
    assert loxodrome.web(high, np.pi / 2, np.pi / 6, 12, n=3).rows == 3


@pytest.mark.parametrize("size", [1e-4, 1, 1e4])
@pytest.mark.parametrize("method", [(), ("smooth",), ("paper", "mu")])
def test_a_last_row_that_fits_up_to_rounding_fits(method, size):
    profile = Profile(lambda t: size * (1 + 0.1 * np.sin(t)), lambda t: size * 2 * t, 0, 3)
    five = loxodrome.web(profile, 1.2, 1.0, 24, 5, *method)
    for ulps in range(-4, 5):
        shorter = profile._replace(stop=five.t[-1] * (1 + ulps * 2**-52))
        net = loxodrome.web(shorter, 1.2, 1.0, 24, None, *method)
        assert net.rows == 5
        assert "the profile is too short" in net.message
        np.testing.assert_allclose(net.V, five.V, atol=size * 1e-9)
    almost = profile._replace(stop=five.t[-1] * (1 - 1e-6))
    assert loxodrome.web(almost, 1.2, 1.0, 24, None, *method).rows == 4
