"""Goals against the definition of the ratios, and what they refuse."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from inetlib import parallelogram
from inetlib.solver.goal import aim, freedom, logs, towards

ANGLE = st.floats(0.2, 2.9)
LOG = st.floats(-0.8, 0.8)


@given(ANGLE, LOG)
def test_a_given_angle_is_kept_whatever_the_freedom_and_slopes_are_differences(angle, s):
    h = 1e-5
    for k, goal in enumerate((aim(theta=angle), aim(theta0=angle))):
        lam, mu = np.exp(logs(goal, [s])[0])
        assert abs(parallelogram.angles(lam, mu)[k] - angle) < 1e-9
    some = aim(), aim(equal=True), aim(lam=1.2), aim(mu=0.7)
    for goal in (aim(theta=angle), aim(theta0=angle), *some):
        k = 2 if goal.kind == "free" else 1
        point = np.array([s, 0.1])[:k]
        _, slopes = logs(goal, point)
        for j, e in enumerate(h * np.eye(k)):
            up, down = (logs(goal, point + sign * e)[0] for sign in (1, -1))
            np.testing.assert_allclose(slopes[:, j], (up - down) / (2 * h), atol=1e-8)


@given(ANGLE, ANGLE)
def test_two_given_angles_are_lemma_1_and_have_no_freedom(theta, theta0):
    goal = aim(theta, theta0)
    found, slopes = logs(goal, [])
    np.testing.assert_allclose(parallelogram.angles(*np.exp(found)), (theta, theta0), atol=1e-9)
    assert slopes.shape == (2, 0)


def test_pairs_of_an_angle_and_a_ratio():
    lam, mu = parallelogram.ratios(1.1, 0.8)
    for kwargs in ({"lam": lam, "theta": 1.1}, {"mu": mu, "theta0": 0.8}, {"lam": lam, "mu": mu}):
        np.testing.assert_allclose(aim(**kwargs).values, (1.1, 0.8), atol=1e-12)
    assert aim(equal=True, theta=1.0) == aim(1.0, 1.0)
    golden = aim(equal=True, lam=(1 + np.sqrt(5)) / 2)
    np.testing.assert_allclose(golden.values, np.pi / 3, atol=1e-12)


def test_freedom_finds_the_nearest_point_of_the_goal_inside_the_range_of_eq_4():
    assert freedom(aim(1.0, 1.0), (0.1, 0.3)).size == 0
    np.testing.assert_allclose(freedom(aim(equal=True), (0.1, 0.3)), [0.2])
    np.testing.assert_allclose(freedom(aim(theta=1.0), (0.1, 0.3)), [0.1])
    np.testing.assert_allclose(freedom(aim(theta0=1.0), (0.1, 0.3)), [0.3])
    np.testing.assert_allclose(freedom(aim(lam=2.0), (0.1, 0.3)), [0.3])
    np.testing.assert_allclose(freedom(aim(mu=2.0), (0.1, 0.3)), [0.1])
    np.testing.assert_allclose(freedom(aim(), (0.1, 0.3)), [0.1, 0.3])
    for goal in (aim(), aim(equal=True), aim(lam=3.0), aim(mu=0.3)):
        for near in ((2.0, 1.5), (-3.0, 2.0), (0.5, -4.0)):
            lam, mu = np.exp(logs(goal, freedom(goal, near))[0])
            assert parallelogram.is_admissible(lam, mu)


def test_the_way_has_small_strides_and_ends_at_the_goal():
    goal = aim(1.0, 2.0)
    way = towards(goal, (1.5, 1.5), 0.2)
    values = np.array([(1.5, 1.5), *(g.values for g in way)])
    assert way[-1] is goal
    assert np.abs(np.diff(values, axis=0)).max() <= 0.2 + 1e-12
    assert len(way) == 3
    assert towards(aim(), (), 0.2) == [aim()]


def test_theta_equal_to_theta0_is_said_by_the_goal_and_not_by_a_last_bit():
    after = np.nextafter(1.1, 4)
    one = aim(1.1, 1.1)
    assert one.equal and aim(equal=True).equal
    assert aim(1.1, after) == aim(1.1, after, equal=True) == one
    assert aim(after, 1.1).equal and aim(lam=1.2, mu=np.nextafter(1.2, 2)).equal
    assert not aim(1.1, 1.1 + 1e-8).equal
    assert not (aim(theta=1.1).equal or aim().equal or aim(lam=1.1).equal)
    for start in ((1.5, 1.5), (1.5, np.nextafter(1.5, 4)), (1.6, 1.4)):
        way = towards(one, start, 0.2)
        assert all(goal.equal for goal in way) and way[-1] is one
    assert not any(goal.equal for goal in towards(aim(1.0, 2.0), (1.5, 1.5), 0.2))


@pytest.mark.parametrize(
    ("kwargs", "words"),
    [
        ({"theta": 0.0}, "between 0 and pi"),
        ({"theta0": np.pi}, "between 0 and pi"),
        ({"theta": np.nan}, "between 0 and pi"),
        ({"theta": 60}, "theta = 60"),
        ({"lam": 0.0}, "positive"),
        ({"mu": np.inf}, "positive"),
        ({"lam": 5.0, "mu": 3.0}, "Eq. 4"),
        ({"lam": 1.5, "theta0": 1.0}, "two nets"),
        ({"mu": 1.5, "theta": 1.0}, "two nets"),
        ({"theta": 1.0, "theta0": 1.0, "mu": 1.0}, "drop"),
        ({"theta": 1.0, "theta0": 1.1, "equal": True}, "equal=True"),
    ],
)
def test_refused(kwargs, words):
    with pytest.raises(ValueError, match=words):
        aim(**kwargs)
