"""`measure` against values by hand, complex numbers and exact symmetries."""

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from inetlib import measure, mesh, parallelogram

ONE = np.array([[0, 1, 2, 3]])
angle = st.floats(0.05, np.pi - 0.05)
seeds = st.integers(0, 2**32 - 1)


def quad(*corners):
    """One quad with the corners v1 ... v4, in the plane or in space."""
    return np.array([[*c, 0][:3] for c in corners], dtype=float), ONE


HAND = {  # corners (above them d1 and d2); lam, mu, theta, theta0
    # (4, -3) and (5, 0)
    "a rhombus": (quad((0, 3), (0, 1), (4, 0), (5, 1)), (1, 3, np.arctan2(3, 4), np.pi / 2)),
    # (2, -2) and (3, 3)
    "a rectangle": (quad((0, 2), (0, 0), (2, 0), (3, 3)), (1.5, 1, np.pi / 2, np.arctan2(12, 5))),
    # (2, -2) and (2, 2)
    "a square": (quad((0, 2), (0, 0.5), (2, 0), (2, 2.5)), (1, 1, np.pi / 2, np.pi / 2)),
    # (1, 0) and (3, sqrt 7) / 2
    "a theta-parallelogram": (
        quad((0, 1), (0, 0), (1, 1), (1.5, 7**0.5 / 2)),
        (2, 2, np.arccos(3 / 4), np.arccos(3 / 4)),
    ),
    # (1, -1, 0) and (2, 1, 1)
    "a skew quad": (
        quad((0, 1, 0), (0, 0, 1), (1, 0, 0), (2, 1, 2)),
        (3**0.5, (5 / 3) ** 0.5, np.arctan2(11**0.5, 1), np.arctan2(44**0.5, 4)),
    ),
}


@pytest.mark.parametrize("what", HAND)
def test_values_by_hand_for(what):
    (V, Q), (lam, mu, theta, theta0) = HAND[what]
    found = [x.item() for x in (*measure.ratios(V, Q), *measure.angles(V, Q))]
    assert found == pytest.approx([lam, mu, theta, theta0], rel=1e-14)


@pytest.mark.parametrize("what", HAND)
def test_all_four_numbers_of_a_face_by_hand_for(what):
    (V, Q), wanted = HAND[what]
    np.testing.assert_allclose(measure.faces(V, Q)[:, 0], wanted, rtol=1e-14)


def test_vectors_are_the_diagonals_and_medial_lines():
    wanted = [[1, -1, 0], [2, 1, 1], [1.5, 0, 0.5], [0.5, 1, 0.5]]
    np.testing.assert_array_equal(np.concatenate(measure.vectors(*HAND["a skew quad"][0])), wanted)


def random_quads(seed, count=20):
    """Disjoint spatial quads (V, Q) and their diagonals d1, d2 as complex numbers.

    The diagonals are drawn in the plane, counter-clockwise, and then every quad is turned
    somewhere, and the second diagonal is moved away from the first one."""
    rng = np.random.default_rng(seed)
    d1 = np.exp(rng.uniform(-1, 1, count) + 1j * rng.uniform(0, 7, count))
    d2 = d1 * np.exp(rng.uniform(-1, 1, count) + 1j * rng.uniform(0.1, np.pi - 0.1, count))
    v1, v2 = rng.normal(size=(2, count, 3))
    turn = Rotation.from_quat(rng.normal(size=(count, 4)))
    one, two = (turn.apply(np.stack([d.real, d.imag, 0 * d.real], axis=1)) for d in (d1, d2))
    V = np.stack([v1, v2, v1 + one, v2 + two], axis=1).reshape(-1, 3)
    return V, np.arange(4 * count).reshape(-1, 4), d1, d2


@given(seeds)
def test_ratios_and_angles_of_spatial_quads_are_those_of_complex_numbers(seed):
    V, Q, d1, d2 = random_quads(seed)
    K, R = d2 / d1, (d2 - d1) / (d1 + d2)
    np.testing.assert_allclose(measure.ratios(V, Q), (abs(K), 1 / abs(R)), rtol=1e-12)
    np.testing.assert_allclose(measure.angles(V, Q), np.angle([K, R]), rtol=1e-12)


@given(seeds)
def test_measured_ratios_and_angles_satisfy_eq_3_and_eq_4(seed):
    V, Q, *_ = random_quads(seed)
    (lam, mu), (theta, theta0) = measure.ratios(V, Q), measure.angles(V, Q)
    cos_theta = (1 + lam**2) * (mu**2 - 1) / (2 * lam * (1 + mu**2))
    cos_theta0 = (1 + mu**2) * (lam**2 - 1) / (2 * mu * (1 + lam**2))
    np.testing.assert_allclose(np.cos(theta), cos_theta, atol=1e-11)
    np.testing.assert_allclose(np.cos(theta0), cos_theta0, atol=1e-11)
    assert (abs(mu - 1) / (mu + 1) < lam).all()
    assert (lam * abs(mu - 1) < mu + 1).all()


@given(seeds)
def test_web_angles_of_spatial_quads_add_up(seed):
    V, Q, d1, d2 = random_quads(seed)
    web = measure.web_angles(V, Q)
    m13, m24 = d1 + d2, d2 - d1
    np.testing.assert_allclose(web.m13_d2, np.angle(d2 / m13), rtol=1e-11)
    np.testing.assert_allclose(web.m13_d1, np.angle(m13 / d1), rtol=1e-11)
    alpha, beta, theta, theta0 = web.m13_d2, web.m13_d1, web.d1_d2, web.m13_m24
    np.testing.assert_allclose(alpha + beta, theta, rtol=1e-12)
    np.testing.assert_allclose(web.m24_d2, theta0 - alpha, rtol=1e-11)
    np.testing.assert_allclose(web.m24_d1, theta0 + beta, rtol=1e-12)
    np.testing.assert_allclose(theta, np.angle(d2 / d1), rtol=1e-12)
    np.testing.assert_allclose(theta0, np.angle(m24 / m13), rtol=1e-12)


def test_web_angles_are_the_printed_half_angles():
    V, Q = HAND["a skew quad"][0]  # lam^2 = 3, mu^2 = 5/3
    root = 2 * (5 / 3) ** 0.5 * (2 * 4 * 8 / 3) ** 0.5
    web = measure.web_angles(V, Q)
    assert np.cos(web.m13_d2) == pytest.approx((3 * 5 + 3 + 5 / 3 - 1) / (root * 3**0.5))
    assert np.cos(web.m13_d1) == pytest.approx((5 - 3 + 5 + 1) / root)


def judged(one, two):
    """theta_defect and both angles of a quad somewhere in space with these diagonals, scaled."""
    rng = np.random.default_rng(6)
    turn, scale = Rotation.from_quat(rng.normal(size=4)), np.exp(rng.uniform(-5, 5))
    v1, v2 = rng.normal(size=(2, len(one), 3))
    V = np.stack([v1, v2, v1 + one, v2 + two], axis=1).reshape(-1, 3)
    V, Q = scale * turn.apply(V), np.arange(len(V)).reshape(-1, 4)
    return measure.theta_defect(V, Q), *measure.angles(V, Q)


def test_prop_6_by_symbols_eq_13_says_that_two_cotangents_are_equal():
    """For any d1, d2 in space: (13) is d2^2 - d1^2 - 2 d1 d2 = 2 A (cot theta0 - cot theta)."""
    d1, d2 = (sympy.Matrix(sympy.symbols(f"{name}:3", real=True)) for name in "ab")
    m13, m24 = (d1 + d2) / 2, (d2 - d1) / 2
    area, half = d1.cross(d2), m13.cross(m24)
    assert (area - 2 * half).expand().is_zero_matrix  # cot theta = d1 d2 / A, A = |d1 x d2|
    defect = d2.dot(d2) - d1.dot(d1) - 2 * d1.dot(d2)
    assert sympy.expand(2 * (2 * m13.dot(m24) - d1.dot(d2)) - defect) == 0


def test_prop_6_both_directions_on_1000_quads_each():
    rng = np.random.default_rng(13)
    d1, side = rng.normal(size=(2, 1000, 3))
    one = np.linalg.norm(d1, axis=1)
    side -= d1 * (np.sum(d1 * side, axis=1) / one**2)[:, None]  # orthogonal to d1
    x, y = d1, side * (one / np.linalg.norm(side, axis=1))[:, None]
    theta = rng.uniform(0.05, np.pi - 0.05, 1000)
    across = np.cos(theta)[:, None] * x + np.sin(theta)[:, None] * y  # as long as d1
    # theta = theta0 (the unique ratio of Eq. (8)), then Eq. (13)
    lam = np.cos(theta) + np.sqrt(1 + np.cos(theta) ** 2)
    defect, found, found0 = judged(d1, lam[:, None] * across)
    np.testing.assert_allclose([found, found0], [theta, theta], rtol=1e-11)
    np.testing.assert_allclose(defect, 0, atol=1e-13)
    # Eq. (13): d2 = d1 + w with w^2 = 2 d1^2 (w = d2 - d1), any direction, then theta = theta0
    w = rng.normal(size=(1000, 3))
    w *= (2**0.5 * one / np.linalg.norm(w, axis=1))[:, None]
    defect, found, found0 = judged(d1, d1 + w)
    np.testing.assert_allclose(defect, 0, atol=1e-13)
    np.testing.assert_allclose(found, found0, atol=1e-11)
    assert found.min() < 0.2 and found.max() > 2.9
    # neither: its sign tells which angle is larger
    defect, found, found0 = judged(d1, np.exp(rng.uniform(-1, 1, 1000))[:, None] * across)
    np.testing.assert_array_equal(defect > 0, found > found0)
    one, two = 1 / np.tan(found), 1 / np.tan(found0)
    assert np.abs(defect[np.abs(one - two) > 0.1]).min() > 1e-4


@pytest.mark.parametrize("sign", [1, -1])
def test_prop_6_needs_diagonals_that_are_not_parallel(sign):
    """d2 = (1 +- sqrt 2) d1 fulfils (13), but the parallelogram has collapsed: an end of (9)."""
    V, Q = quad((0, 0), (3, 1, 4), (1, 0), (4 + sign * 2**0.5, 1, 4))
    assert measure.theta_defect(V, Q).item() == pytest.approx(0, abs=1e-15)
    assert measure.angles(V, Q) == (pytest.approx((1 - sign) * np.pi / 2, abs=1e-15),) * 2
    lam, mu = (x.item() for x in measure.ratios(V, Q))
    assert (lam, mu) == pytest.approx((2**0.5 + sign, 2**0.5 + sign), rel=1e-14)
    assert not parallelogram.is_admissible(lam * (1 + sign * 1e-12), mu * (1 + sign * 1e-12))
    V[3, 0] += 0.1  # parallel, and no solution: the angles are as equal as before
    assert abs(measure.theta_defect(V, Q).item()) > 0.01
    assert np.ptp(measure.angles(V, Q)) < 1e-14


@given(seeds, st.floats(1e-6, 1e6))
def test_turned_labels_and_mirror_images_give_reciprocals_and_moving_changes_nothing(seed, scale):
    """A mirror image keeps v1 at the top left: that of v4 becomes v1, that of v3 becomes v2."""
    V, Q, *_ = random_quads(seed)
    (lam, mu), (theta, theta0) = measure.ratios(V, Q), measure.angles(V, Q)
    turned = V, np.roll(Q, 1, axis=1)
    np.testing.assert_allclose(measure.ratios(*turned), (1 / lam, 1 / mu), rtol=1e-13)
    np.testing.assert_allclose(measure.angles(*turned), (np.pi - theta, np.pi - theta0), rtol=1e-12)
    image = V * [-1, 1, 1], Q[:, ::-1]
    np.testing.assert_allclose(measure.ratios(*image), (1 / lam, mu), rtol=1e-13)
    np.testing.assert_allclose(measure.angles(*image), (theta, np.pi - theta0), rtol=1e-12)
    rng = np.random.default_rng(seed)
    moved = scale * (Rotation.from_quat(rng.normal(size=4)).apply(V) + rng.normal(size=3))
    for name in ("ratios", "angles", "web_angles", "theta_defect"):
        function = getattr(measure, name)
        np.testing.assert_array_equal(function(V, np.roll(Q, 2, axis=1)), function(V, Q))
        off = {"rtol": 0, "atol": 1e-12} if name == "theta_defect" else {"rtol": 1e-11}
        np.testing.assert_allclose(function(moved, Q), function(V, Q), **off)


def test_reversing_the_orientation_breaks_eq_13():
    V, Q = HAND["a theta-parallelogram"][0]
    assert measure.theta_defect(V, Q).item() == pytest.approx(0, abs=1e-15)
    # the diagonals -d2 and -d1, with |d1| = 1, |d2| = 2, d1 d2 = 3/2: (1 - 4 - 3) / 5
    assert measure.theta_defect(V, Q[:, ::-1]).item() == pytest.approx(-6 / 5, rel=1e-14)
    theta, theta0 = measure.angles(V, Q[:, ::-1])
    assert theta + theta0 == pytest.approx(np.pi)


def test_small_angles_keep_their_digits():
    """An arccos would return 0 here: 1 - cos is below the rounding."""
    V, Q = quad((0, 0), (0, 1), (1, 0), (1.5, 1 + 1e-9))
    theta, theta0 = measure.angles(V, Q)
    with mpmath.workdps(40):
        y = mpmath.mpf(1 + 1e-9) - 1
        wanted = mpmath.atan(y / mpmath.mpf(1.5))
        wanted0 = mpmath.atan2(y, mpmath.mpf(0.5)) - mpmath.atan2(y, mpmath.mpf(2.5))
    assert theta.item() == pytest.approx(float(wanted), rel=1e-14)
    assert theta0.item() == pytest.approx(float(wanted0), rel=1e-14)


def sheared(m, n, u=(1.0, 0, 0), v=(0.3, 0.8, 0)):
    i, j = np.divmod(np.arange((m + 1) * (n + 1)), n + 1)
    return i[:, None] * np.array(u) + j[:, None] * np.array(v), mesh.grid_quads(m, n)


def test_a_grid_of_congruent_cells_has_one_value_in_every_face():
    V, Q = sheared(4, 3)
    V[0, 2] = 1  # but the first
    theta, theta0 = (angle[1:] for angle in measure.angles(V, Q))
    np.testing.assert_allclose(theta0, np.arctan2(0.8, 0.3), rtol=1e-13)
    np.testing.assert_allclose(theta, np.arctan2(0.8, 0.7) + np.arctan2(0.8, 1.3), rtol=1e-13)
    off = measure.deviations(V, Q, theta0=theta0[0])
    np.testing.assert_allclose(off[1, 1:], 0, atol=1e-13)
    found = measure.angles(V, Q)
    np.testing.assert_allclose(off[0], abs(found[0] - found[0].mean()), atol=1e-13)


COLLAPSED = [
    (quad((1, 1), (0, 0), (1, 1), (2, 5)), "a diagonal"),  # the first one
    (quad((0, 1), (2, 3), (1, 1), (2, 3)), "a diagonal"),
    (quad((0, 0), (1, 1), (1, 0), (0, 1)), "a medial line"),  # m13
    (quad((0, 0), (1, 1), (1, 0), (2, 1)), "a medial line"),
]


@pytest.mark.parametrize("name", ["ratios", "angles", "web_angles", "theta_defect", "quality"])
def test_collapsed_faces_and_bad_meshes_are_refused_by(name):
    function = getattr(measure, name)
    W, R = sheared(1, 1)
    for (V, Q), words in COLLAPSED:
        with pytest.raises(ValueError, match=f"face 4-5-6-7 has {words} of length zero"):
            function(np.concatenate([W, V]), np.concatenate([R, Q + 4]))
    V, Q = sheared(2, 2)
    with pytest.raises(ValueError, match="quads are wanted"):
        function(V, Q[:, :3])
    with pytest.raises(ValueError, match="only 8 vertices"):
        function(V[:-1], Q)
    V[4, 2] = np.nan
    with pytest.raises(ValueError, match=r"vertex 4 .* not a finite number"):
        function(V, Q)


def test_spread_by_hand_about_the_mean_and_about_a_target():
    assert measure.spread([1, 2, 6]) == pytest.approx((3, 1, 6, 3, 2))
    assert measure.spread([1, 2, 6], target=2) == pytest.approx((3, 1, 6, 4, 5 / 3))
    assert measure.spread(np.full((2, 2), 7.0)) == (7, 7, 7, 0, 0)
    assert measure.spread([1.0, 2.0], np.array([1.5, 2.0])).max_deviation == 0.5
    assert all(type(x) is float for x in measure.spread([1, 2, 6]))
    for bad in ([], [1, np.nan], [np.inf]):
        with pytest.raises(ValueError, match="at least one value, all of them finite"):
            measure.spread(bad)
    for bad, words in ((np.nan, "target = nan"), (np.array([1, np.nan]), r"target = \[ *1. nan")):
        with pytest.raises(ValueError, match=words):
            measure.spread([1.0, 2.0], target=bad)


@pytest.mark.parametrize("cell", [(0, 0), (1, 1), (2, 1), (3, 2), (0, 2)])
def test_one_folded_face_is_found_and_no_other(cell):
    """The corner v4 of one face is pushed across v2: its second diagonal changes direction.

    Found in the flat net, where the sign of the area tells, and in the same net in space.
    A corner beside the folded face has one neighbour for and one against it: not counted,
    however the turn rounds."""
    i, j = cell
    V, Q = sheared(5, 4, v=(0, 1, 0))
    V[(i + 1) * 5 + j + 1] = [i - 0.2, j - 0.2, 0]
    x, y = np.moveaxis(V[Q], 2, 0)[:2]
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1) / 2
    assert np.flatnonzero(area < 0).tolist() == [4 * i + j]
    turns = [(0.3, 1.1, -2), (1, 0.2, 0.5), (0.7, -1, 0.1), (-0.4, 0.9, 1.3), (2, 1, 0.6)]
    for W in (V, *(Rotation.from_rotvec(turn).apply(V) for turn in turns)):
        found = measure.quality(W, Q)
        assert (found.flips, found.flipped.tolist()) == (1, [4 * i + j])


def test_two_folded_faces_far_apart_are_both_found_and_none_on_a_torus():
    V, Q = sheared(6, 6, v=(0, 1, 0))
    for i, j in [(1, 1), (4, 3)]:
        V[(i + 1) * 7 + j + 1] = [i - 0.2, j - 0.2, 0]
    found = measure.quality(V, Q)
    assert (found.flips, found.flipped.tolist()) == (2, [1 * 6 + 1, 4 * 6 + 3])
    np.testing.assert_array_equal(measure.flipped(V, Q), found.flipped)
    i, j = np.divmod(np.arange(12 * 9), 9)
    u, v = 2 * np.pi * i / 12, 2 * np.pi * j / 9
    V = np.stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)], axis=1)
    i, j = np.divmod(mesh.grid_quads(12, 9), 10)
    assert measure.quality(V, i % 12 * 9 + j % 9).flips == 0


def test_planarity_area_ratio_and_aspect_by_hand():
    h = 0.3  # diagonals of length sqrt 2 at the heights 0 and h
    V, Q = quad((0, 1, 0), (0, 0, h), (1, 0, 0), (1, 1, h))
    assert measure.quality(V, Q).planarity == pytest.approx(h / 2**0.5, rel=1e-14)
    V, Q = quad((0, 2, 0), (0, 0, h), (2, 0, 0), (1, 1, h))  # lengths 2 sqrt 2 and sqrt 2
    assert measure.quality(V, Q).planarity == pytest.approx(h / (1.5 * 2**0.5), rel=1e-14)
    for W in (5 * V, V + np.array([3, 5, 7])):
        assert measure.quality(W, Q).planarity == pytest.approx(h / (1.5 * 2**0.5), rel=1e-14)
    found = measure.quality(*sheared(3, 2, v=(0, 1, 0)))
    assert (found.flips, found.flipped.tolist()) == (0, [])
    assert (found.darts, found.nonconvex.tolist()) == (0, [])
    assert found[4:] == pytest.approx((np.pi / 2, 1, 1, 0))
    x = np.array([0, 1, 3, 7])  # cells 1 x 1, 2 x 1, 4 x 1
    V = np.array([[a, b, 0.0] for a in x for b in (0, 1)])
    found = measure.quality(V, mesh.grid_quads(3, 1))
    assert found.area_ratio == pytest.approx(1 / 4)
    assert found.aspect == pytest.approx(4)
    tall = measure.quality(V[:, [1, 0, 2]] * [-1, 1, 1], mesh.grid_quads(3, 1))
    assert tall.aspect == pytest.approx(4)
    assert measure.quality(3 * V, mesh.grid_quads(3, 1)).aspect == pytest.approx(4)
    V, Q = quad((0, 0), (1, 1), (1, 0), (3, 1))
    W, R = sheared(1, 1)
    for mesh_ in ((V, Q), (np.concatenate([V, W]), np.concatenate([Q, R + 4]))):
        with pytest.raises(ValueError, match="face 0-1-2-3 has no area: its diagonals are para"):
            measure.quality(*mesh_)


@pytest.mark.parametrize("beyond", [-0.1, 0.1])
def test_darts_are_faces_whose_diagonals_meet_beyond_an_end(beyond):
    x = 1 + beyond  # the second diagonal crosses the line of the first one there
    dart = quad((0, 0), (x, -1), (1, 0), (x, 3))
    folded = quad((x, 3), (0, 0), (x, -1), (1, 0))  # the same with the diagonals exchanged
    for V, Q in (dart, folded, (7 * dart[0] + 100, ONE)):
        found = measure.quality(V, Q)
        assert found.nonconvex.tolist() == [0][: found.darts]
        assert found.darts == (beyond > 0)


@given(seeds, st.booleans())
def test_an_affine_map_leaves_darts_darts_and_other_faces_as_they_are(seed, dart):
    """So oblique diagonals are judged as well; the plane may be mapped anywhere into space."""
    x = 1.1 if dart else 0.9
    V, Q = quad((0, 0), (x, -1), (1, 0), (x, 3))
    rng = np.random.default_rng(seed)
    turn = Rotation.from_quat(rng.normal(size=4))
    oblique = np.array([[1, rng.uniform(-3, 3), 0], [0, np.exp(rng.uniform(-1, 1)), 0], [0, 0, 1]])
    W = turn.apply(V @ oblique.T) + rng.normal(size=3)
    for k in range(4):  # the labels, too, may begin anywhere
        assert measure.nonconvex(W, np.roll(Q, k, axis=1)).tolist() == [0] * dart


def test_corners_by_hand():
    V, Q = quad((0, 1), (0, 0), (2, 0), (1, 1))  # and a square in space
    V = np.concatenate([V, [[0, 0, 5], [3, 0, 5], [3, 0, 8], [0, 0, 8]]])
    right, half = np.pi / 2, np.pi / 4
    wanted = [[right, right, half, 3 * half], [right] * 4]
    np.testing.assert_allclose(measure.corners(V, np.concatenate([Q, Q + 4])), wanted, rtol=1e-14)
    assert measure.quality(V, np.concatenate([Q, Q + 4])).corner == pytest.approx(half)


@given(seeds)
def test_star_angles_of_a_star_in_space_by_arccos(seed):
    V = np.random.default_rng(seed).normal(size=(9, 3)) + sheared(2, 2)[0]
    chords = np.array([[7, 1], [5, 3], [6, 2], [8, 0]])  # right left, up down, the ends of d1, d2
    for unit, options in ((False, ()), (False, (False,)), (True, (True,))):
        rays = V[chords] - V[4]
        rays /= np.linalg.norm(rays, axis=2, keepdims=True) if unit else 1
        right, up, d1, d2 = rays[:, 0] - rays[:, 1]
        star = measure.star_angles(V, mesh.grid_quads(2, 2), *options)
        wanted = [a @ b / np.sqrt((a @ a) * (b @ b)) for a, b in ((d1, d2), (right, up))]
        assert star.vertex.tolist() == [4]
        np.testing.assert_allclose(np.cos([star.theta[0], star.theta0[0]]), wanted, atol=1e-12)


def test_parallel_plane_pieces_are_as_far_apart_as_they_are():
    V, Q = sheared(5, 4)
    turn = Rotation.from_rotvec([0.3, 1.1, -2])
    W = V + np.array([0, 0, 0.25])
    assert measure.hausdorff(V, Q, V, Q) == pytest.approx((0, 0), abs=1e-15)
    assert measure.hausdorff(V, Q, W, Q) == pytest.approx((0.25, 0.25), rel=1e-14)
    found = measure.hausdorff(100 * turn.apply(V), Q, 100 * turn.apply(W), Q)
    assert found == pytest.approx((25, 25), rel=1e-12)
    F = np.concatenate([Q[:, [0, 1, 2]], Q[:, [0, 2, 3]]])  # triangles, and a vertex of none
    far = np.concatenate([V, [[50.0, 0, 0]]])
    assert measure.hausdorff(far, F, W, Q, 2) == pytest.approx((0.25, 0.25), rel=1e-14)
    for bad in (0, 1.5, np.nan):
        with pytest.raises(ValueError, match=f"refine = {bad}: a whole number"):
            measure.hausdorff(V, Q, V, Q, bad)


def test_a_part_lies_on_the_whole_not_the_whole_on_the_part_and_refining_finds_the_ground():
    V, Q = sheared(6, 6, v=(0, 1, 0))
    W, R = sheared(7, 2, u=(0.3, 0, 0), v=(0, 1.5, 0))  # 2.1 x 3, its vertices off the grid
    there, back = measure.hausdorff(W, R, V, Q)
    assert there == pytest.approx(0, abs=1e-15)
    assert back == pytest.approx(np.hypot(6 - 2.1, 6 - 3), rel=1e-14)
    assert measure.hausdorff(V, Q, W, R) == (back, there)
    # four vertices of the ground lie on the roof; only points between them are below it
    V, Q = sheared(1, 1, u=(2, 0, 0), v=(0, 3, 0))
    W, R = sheared(2, 1, v=(0, 3, 0))
    W[2:4, 2] = h = 0.75  # slopes 0.75 : 1, their normals (3/5, 0, 4/5)
    assert measure.hausdorff(V, Q, W, R) == pytest.approx((0, h), abs=1e-15)
    assert measure.hausdorff(V, Q, W, R, refine=3).there == pytest.approx(2 / 3 * 0.6, rel=1e-14)
    assert measure.hausdorff(V, Q, W, R, refine=4) == pytest.approx((0.6, h), rel=1e-14)


LATTICE = [(i, j) for i in range(1, 4) for j in range(1, 5 - i)]


@pytest.mark.parametrize("place", LATTICE)
def test_refining_finds_the_point_below_the_top_of_a_flat_tent_wherever_that_is(place):
    """A tent on a triangle: below its top is the farthest point, at the distance of a side."""
    h, (x, y) = 0.01, np.array(place) / 5
    ground, top = np.array([[0, 0, 0], [1, 0, 0], [0, 1.0, 0]]), np.array([[x, y, h]])
    tent = np.concatenate([ground, top]), np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    side = min(x, y, (1 - x - y) / 2**0.5)  # distance from the nearest edge of the ground
    found = measure.hausdorff(ground, np.array([[0, 1, 2]]), *tent, refine=5)
    assert found.there == pytest.approx(h * side / np.hypot(h, side), rel=1e-9)
    assert measure.hausdorff(ground, np.array([[0, 1, 2]]), *tent).there < 1e-15
