"""`parallelogram` against drawn parallelograms, exact rationals, 50 digits and sympy."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from inetlib import parallelogram

GOLDEN = (1 + 5**0.5) / 2
DIGITS = mpmath.workdps(50)
angle = st.floats(0.01, np.pi - 0.01)
SEED = 20240601


def drawn(lam, theta):
    """Corners A, B, C, D as complex numbers: B at 0, C at 1, A at distance lam."""
    B, C, A = 0, 1, lam * np.exp(1j * theta)
    return A, B, C, A + C - B


def between(start, end):
    """The oriented angle from one complex number to another, in (-pi, pi]."""
    return np.angle(end / start)


def random_angles(count, margin=0.01):
    return np.random.default_rng(SEED).uniform(margin, np.pi - margin, (2, count))


rng = np.random.default_rng(SEED)  # sides and an angle, without the functions under test
LAM, THETA = np.exp(rng.uniform(-2, 2, 1000)), rng.uniform(0.05, np.pi - 0.05, 1000)
A, B, C, D = drawn(LAM, THETA)
MU, THETA0 = abs(D - B) / abs(C - A), between(D - B, A - C)


def equal_ratio(theta):
    """lam of the drawn parallelogram with AOD = ABC, by bisection: AOD falls as lam grows."""
    low, high = np.full_like(theta, 0.1), np.full_like(theta, 9.0)
    for _ in range(60):
        middle = (low + high) / 2
        a, b, c, d = drawn(middle, theta)
        above = between(d - b, a - c) > theta
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return middle


EQUAL = rng.uniform(0.05, np.pi - 0.05, 1000)  # theta = theta0, drawn as well
RATIO = equal_ratio(EQUAL)
A1, B1, C1, D1 = drawn(RATIO, EQUAL)
lam_, mu_ = sympy.symbols("lam mu", positive=True)


def same(one, other):
    return sympy.simplify(sympy.factor(one - other, deep=True)) == 0


def exact_ratios(theta, theta0):
    """The admissible root of two quadratics, put to the proof by the cosine rule: 50 digits."""
    theta, theta0 = mpmath.mpf(theta), mpmath.mpf(theta0)
    x = mpmath.cot(theta0) * mpmath.sin(theta)  # lam - 1/lam = 2x
    y = mpmath.cot(theta) * mpmath.sin(theta0)  # mu - 1/mu = 2y
    lam, mu = x + mpmath.sqrt(x * x + 1), y + mpmath.sqrt(y * y + 1)
    for found, wanted in zip(exact_angles(lam, mu), (theta, theta0), strict=True):
        assert abs(found - wanted) < mpmath.mpf("1e-30")
    return lam, mu


def exact_angles(lam, mu):
    """By the cosine rule at 50 digits, from the lengths 1, lam, p, q."""
    lam, mu = mpmath.mpf(lam), mpmath.mpf(mu)
    p2 = 2 * (1 + lam**2) / (1 + mu**2)
    half, half_q = mpmath.sqrt(p2) / 2, mu * mpmath.sqrt(p2) / 2
    theta = mpmath.acos((1 + lam**2 - p2) / (2 * lam))
    theta0 = mpmath.acos((half**2 + half_q**2 - 1) / (2 * half * half_q))
    return theta, theta0  # AOD is opposite to AD = 1


def relative(value, exact):
    return float(abs(mpmath.mpf(float(value)) / exact - 1))


def test_100000_random_angles_survive_the_way_to_ratios_and_back():
    theta, theta0 = random_angles(100_000)
    back = parallelogram.angles(*parallelogram.ratios(theta, theta0))
    np.testing.assert_allclose(back, (theta, theta0), rtol=0, atol=1e-12)


def test_b1_the_ratios_of_two_angles_have_these_angles_by_symbols():
    angles = sympy.symbols("theta theta0", positive=True)
    lam, mu = (ratio.rewrite(sympy.log) for ratio in parallelogram.ratios(*angles))
    for cosine, one in zip(parallelogram.cosines(lam, mu), angles, strict=True):
        assert sympy.simplify(cosine**2 - sympy.cos(one) ** 2) == 0
    larger = np.array(parallelogram.ratios(THETA, THETA0)[::-1]) > 1  # mu > 1: theta < 90 degrees
    np.testing.assert_array_equal(larger, np.cos([THETA, THETA0]) > 0)


@pytest.mark.parametrize(
    ("theta", "theta0", "lam", "mu"),
    [
        (60, 45, 2.18890, 1.48837),
        (80, 45, 2.38832, 1.13242),
        (50, 50, 1.83156, 1.83156),
        (90, 90, 1, 1),
        (90, 45, 1 + 2**0.5, 1),
        (45, 90, 1, 1 + 2**0.5),
        (np.degrees(np.arctan(2)), 45, 5**0.5, 2**0.5),
    ],
)
def test_known_angles_have_the_known_ratios(theta, theta0, lam, mu):
    found = parallelogram.ratios(np.radians(theta), np.radians(theta0))
    assert found == pytest.approx((lam, mu), abs=6e-6)


def test_angles_are_those_of_the_drawn_parallelogram():
    np.testing.assert_allclose(parallelogram.angles(LAM, MU), (THETA, THETA0), atol=1e-11)
    logs = parallelogram.log_ratios(THETA, THETA0)
    np.testing.assert_allclose(logs, np.log([LAM, MU]), atol=1e-10)


def test_half_cosines_as_printed_are_the_cosines_of_the_drawn_half_angles():
    halves = np.array([between(D - B, A - B), between(C - B, D - B)])
    np.testing.assert_allclose(parallelogram.half_angles(LAM, MU), halves, atol=1e-11)
    np.testing.assert_allclose(parallelogram.half_cosines(LAM, MU), np.cos(halves), atol=1e-11)


def test_cosines_as_printed_are_the_cosines_of_the_drawn_angles():
    cosines = parallelogram.cosines(LAM, MU)
    np.testing.assert_allclose(cosines, np.cos([THETA, THETA0]), atol=1e-11)


def test_lengths_are_those_of_the_drawn_parallelogram():
    a, *others = parallelogram.lengths(LAM, MU)
    assert a == 1
    np.testing.assert_allclose(others, [abs(A - B), abs(C - A), abs(D - B)], rtol=1e-12)


def test_diagonals_are_those_of_the_drawn_parallelogram():
    found = parallelogram.diagonals(3.5, 3.5 * LAM, THETA)
    np.testing.assert_allclose(found, [3.5 * abs(C - A), 3.5 * abs(D - B)], rtol=1e-12)


def test_eq_2_the_squares_of_the_diagonals_are_twice_those_of_the_sides():
    a, b, theta = sympy.symbols("a b theta", positive=True)
    p, q = parallelogram.diagonals(a, b, theta)
    assert same(p**2 + q**2, 2 * (a**2 + b**2))
    a, b, p, q = parallelogram.lengths(lam_, mu_)
    assert same(p**2 + q**2, 2 * (a**2 + b**2)) and (a, b) == (1, lam_) and same(q, mu_ * p)
    for p, q in (parallelogram.diagonals(1, LAM, THETA), parallelogram.lengths(LAM, MU)[2:]):
        np.testing.assert_allclose(p**2 + q**2, abs(B - C) ** 2 * 2 + abs(A - B) ** 2 * 2)
        np.testing.assert_allclose(q / p, abs(B - D) / abs(A - C), rtol=1e-10)


def test_eq_7_equal_angles_and_only_they_have_the_diagonals_root_two_and_root_two_lam():
    root = sympy.sqrt(2)
    lengths = parallelogram.lengths(lam_, lam_)
    assert all(map(same, lengths, (1, lam_, root, root * lam_)))
    p = parallelogram.lengths(lam_, mu_)[2]
    assert sympy.solve(p - root, mu_) == [lam_]
    np.testing.assert_allclose(abs(A1 - C1), 2**0.5, rtol=1e-11)
    np.testing.assert_allclose(abs(B1 - D1), 2**0.5 * RATIO, rtol=1e-11)
    assert abs(abs(A - C) / 2**0.5 - 1)[abs(THETA - THETA0) > 0.1].min() > 1e-3


def test_eq_8_one_ratio_fixes_the_one_angle_and_back():
    assert all(same(x, (lam_ - 1 / lam_) / 2) for x in parallelogram.cosines(lam_, lam_))
    np.testing.assert_allclose((RATIO - 1 / RATIO) / 2, np.cos(EQUAL), atol=1e-12)
    np.testing.assert_allclose(parallelogram.ratios(EQUAL, EQUAL), [RATIO, RATIO], rtol=1e-12)
    np.testing.assert_allclose(parallelogram.angles(RATIO, RATIO), [EQUAL, EQUAL], atol=1e-11)
    for degrees, lam in ((60, GOLDEN), (45, (2**0.5 + 6**0.5) / 2), (30, (3**0.5 + 7**0.5) / 2)):
        assert equal_ratio(np.radians([degrees])) == pytest.approx(lam, rel=1e-14)  # as printed
        assert parallelogram.ratios(*np.radians([degrees, degrees])) == pytest.approx((lam, lam))
    for lam, angle in ((2, np.arccos(0.75)), (0.5, np.pi - np.arccos(0.75))):
        assert parallelogram.angles(lam, lam) == pytest.approx([angle, angle], rel=1e-14)


def test_eq_9_the_one_ratio_runs_from_root_two_minus_to_root_two_plus_one():
    ends = [sympy.solve(parallelogram.cosines(lam_, lam_)[0] - end, lam_) for end in (-1, 1)]
    assert ends == [[sympy.sqrt(2) - 1], [sympy.sqrt(2) + 1]]
    assert parallelogram.lam_range(ends[0][0])[0].equals(ends[0][0])  # where lam = mu meets (4)
    assert parallelogram.lam_range(ends[1][0])[1].equals(ends[1][0])
    low, high = 2**0.5 - 1, 2**0.5 + 1
    assert low < RATIO.min() < 1.01 * low and 0.99 * high < RATIO.max() < high
    lam = np.exp(np.random.default_rng(SEED).uniform(-1.5, 1.5, 1000))
    found = parallelogram.is_admissible(lam, lam)
    np.testing.assert_array_equal(found, (low < lam) & (lam < high))
    np.testing.assert_array_equal(found, [constructed(x, x) for x in lam])


def test_eq_10_the_half_angles_of_equal_angles():
    root = sympy.sqrt(2)
    printed = root * (3 * lam_**2 - 1) / (4 * lam_**2), root * (1 + lam_**2) / (4 * lam_)
    assert all(map(same, parallelogram.half_cosines(lam_, lam_), printed))
    assert all(map(same, map(sympy.cos, parallelogram.half_angles(lam_, lam_)), printed))
    halves = between(D1 - B1, A1 - B1), between(C1 - B1, D1 - B1)
    for formula, half in zip(printed, halves, strict=True):
        values = sympy.lambdify(lam_, formula)(RATIO)
        np.testing.assert_allclose(values, np.cos(half), atol=1e-11)
    np.testing.assert_allclose(parallelogram.half_angles(RATIO, RATIO), halves, atol=1e-10)


def test_app_a1_the_triangles_abd_and_odc_are_similar_exactly_where_the_angles_are_equal():
    """Three sides of each, as lengths of `lengths` by symbols and as drawn: one quotient."""
    a, b, p, q = parallelogram.lengths(lam_, lam_)
    for long, short in ((b, q / 2), (q, b), (a, p / 2)):
        assert same(long / short, sympy.sqrt(2))

    def quotients(a, b, c, d):
        middle = (a + c) / 2
        long, short = (a - b, b - d, d - a), (middle - d, d - c, c - middle)
        return np.array([abs(x) / abs(y) for x, y in zip(long, short, strict=True)])

    np.testing.assert_allclose(quotients(A1, B1, C1, D1), 2**0.5, rtol=1e-11)
    others = np.ptp(quotients(A, B, C, D), axis=0)
    assert others[abs(THETA - THETA0) > 0.1].min() > 1e-3


EXTREME = [1e-6, 1e-5, 1e-3, 0.1, 1, np.pi / 2, 2, 3, np.pi - 1e-3, np.pi - 1e-6]
BAD_RHO = [0, 1, 1 - 1j, complex(np.nan, 1), complex(np.inf, 1)]


@pytest.mark.parametrize("theta", EXTREME)
def test_ratios_keep_their_digits_at_angles_close_to_0_and_pi(theta):
    lam, mu = parallelogram.ratios(theta, np.array(EXTREME))
    p, _ = parallelogram.diagonals(1, 1, theta)
    with DIGITS:
        for k, theta0 in enumerate(EXTREME):
            exact = exact_ratios(float(theta), float(theta0))
            assert relative(lam[k], exact[0]) < 1e-14
            assert relative(mu[k], exact[1]) < 1e-14
        assert relative(p, 2 * mpmath.sin(mpmath.mpf(float(theta)) / 2)) < 1e-15


def near_border(gap):
    """Admissible ratios a relative distance of about `gap` inside the border of Eq. (4)."""
    for mu in (1.3, 1.5, 2.0, 3.0, 50.0, 0.3, 0.05, 1.0001):
        low, high = abs(mu - 1) / (mu + 1), (mu + 1) / abs(mu - 1)
        yield from ((low * (1 + gap), mu), (high * (1 - gap), mu))


def factors(lam, mu):
    """The four distances from the border, exact for the doubles given."""
    lam, mu = mpmath.mpf(lam), mpmath.mpf(mu)
    return [
        lam * (mu + 1) - (mu - 1),
        (mu + 1) - lam * (mu - 1),
        mu * (lam + 1) - (1 - lam),
        lam * (mu - 1) + (mu + 1),
    ]


def angle_error(lam, mu):
    """Error of theta and theta0 relative to the angle or its supplement, whichever is less.

    The supplement of an angle near pi cannot be known better than the spacing of doubles
    there, 4.4e-16; that much is taken off."""
    worst = 0
    for found, exact in zip(parallelogram.angles(lam, mu), exact_angles(lam, mu), strict=True):
        off = abs(mpmath.mpf(float(found)) - exact)
        if exact > mpmath.pi / 2:
            off = max(off - mpmath.mpf(4.5e-16), 0)
        worst = max(worst, float(off / min(exact, mpmath.pi - exact)))
    return worst


@pytest.mark.parametrize("gap", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12])
def test_angles_lose_digits_only_as_the_rounding_of_the_ratios_themselves_would(gap):
    """At any distance from the border; nine digits are left at 1e-5.

    An angle near 0 is proportional to the root of the product of the four factors.  One last
    place of lam and of mu changes a factor by up to eps (lam + 1) (mu + 1), so rounded ratios
    determine the angle no better than `lost`; the formula must not lose much more."""
    eps = np.finfo(float).eps
    with DIGITS:
        for lam, mu in near_border(gap):
            error, size = angle_error(lam, mu), (lam + 1) * (mu + 1)
            lost = eps * sum(size / float(w) for w in factors(lam, mu))
            assert error < 2 * eps + 2 * lost, (lam, mu)
            assert error < 1e-9 or min(factors(lam, mu)) <= 1e-5 * size, (lam, mu)


@given(angle, angle)
def test_reciprocal_ratios_belong_to_supplementary_angles(theta, theta0):
    lam, mu = parallelogram.ratios(theta, theta0)
    turned = parallelogram.angles(1 / lam, 1 / mu)
    assert turned == pytest.approx((np.pi - theta, np.pi - theta0), abs=1e-11)


@given(angle, angle)
def test_mirror_images_invert_one_ratio_and_interchanged_angles_have_interchanged_ratios(a, b):
    lam, mu = parallelogram.ratios(a, b)
    assert parallelogram.angles(1 / lam, mu) == pytest.approx((a, np.pi - b), abs=1e-11)
    assert parallelogram.angles(lam, 1 / mu) == pytest.approx((np.pi - a, b), abs=1e-11)
    assert parallelogram.ratios(b, a) == (mu, lam)
    assert parallelogram.angles(mu, lam) == pytest.approx((b, a), abs=1e-11)


@given(angle)
def test_equal_angles_give_equal_ratios_and_supplements_give_reciprocals(theta):
    lam, mu = parallelogram.ratios(theta, theta)
    assert lam == pytest.approx(mu, rel=1e-14)
    assert lam == pytest.approx(np.cos(theta) + np.sqrt(1 + np.cos(theta) ** 2), rel=1e-13)
    lam, mu = parallelogram.ratios(theta, np.pi - theta)
    assert lam * mu == pytest.approx(1, rel=1e-11)


def literal_eq_4(lam, mu):
    """Eq. (4) word for word, in exact rational arithmetic; an upper bound over 0 is infinite."""
    lam, mu = Fraction(lam), Fraction(mu)

    def within(x, y):
        low = abs(y - 1) / (y + 1)
        return low < x and (y == 1 or x < (y + 1) / abs(y - 1))

    return lam > 0 and mu > 0 and within(lam, mu) and within(mu, lam)


def constructed(lam, mu):
    """Whether a triangle of the sides 1, lam and p closes, in exact rational arithmetic.

    A = x + iy with |A| = lam and |A - 1| = p, over B = 0 and C = 1; then D = A + 1."""
    lam, mu = Fraction(lam), Fraction(mu)
    p2 = 2 * (1 + lam**2) / (1 + mu**2)
    x = (1 + lam**2 - p2) / 2
    assert 1 + 2 * x + lam**2 == mu**2 * p2  # |D - B| = mu |C - A|
    return lam**2 > x**2


def test_eq_4_and_is_admissible_tell_which_parallelograms_can_be_constructed():
    lam, mu = np.exp(np.random.default_rng(SEED).uniform(-2, 2, (2, 4000)))
    wanted = [constructed(x, y) for x, y in zip(lam, mu, strict=True)]
    assert 1000 < sum(wanted) < 3000
    assert [literal_eq_4(x, y) for x, y in zip(lam, mu, strict=True)] == wanted
    np.testing.assert_array_equal(parallelogram.is_admissible(lam, mu), wanted)
    low, high = parallelogram.lam_range(mu)
    np.testing.assert_array_equal((low < lam) & (lam < high), wanted)


def test_is_admissible_near_and_on_the_border_of_ones_nonsense_scalars_and_arrays():
    for mu in (1.1, 1.5, 2.0, 7.0, 0.9, 0.2):
        low, high = abs(mu - 1) / (mu + 1), (mu + 1) / abs(mu - 1)
        for gap in (1e-3, 1e-9, 1e-14):
            for lam in (low * (1 - gap), low * (1 + gap), high * (1 - gap), high * (1 + gap)):
                assert parallelogram.is_admissible(lam, mu) == literal_eq_4(lam, mu), (lam, mu)
                assert parallelogram.is_admissible(mu, lam) == literal_eq_4(lam, mu), (lam, mu)
    for border in ((3.0, 2.0), (2.0, 3.0), (0.5, 3.0)):
        assert not parallelogram.is_admissible(*border)
    for other in (1e-12, 1e-3, 1, 1e3, 1e12):
        assert parallelogram.is_admissible(other, 1) and parallelogram.is_admissible(1, other)
    assert parallelogram.is_admissible(1, 1) is True
    for bad in (0.0, -0.0, -1.0, np.nan, np.inf, -np.inf):
        for ratios in ((bad, 1.0), (1.0, bad), (bad, bad)):
            assert parallelogram.is_admissible(*ratios) is False
    found = parallelogram.is_admissible(np.array([[0.2], [1.0], [4.0]]), [1.0, 2.0])
    np.testing.assert_array_equal(found, [[True, False], [True, True], [True, False]])
    assert parallelogram.is_admissible([], []).shape == (0,)


def test_eq_6_the_range_ends_where_the_triangle_of_two_sides_and_a_diagonal_collapses():
    mu = 1 + sympy.Symbol("x", positive=True)
    twice = 2 * (1 + lam_**2)  # (1 + mu^2) p^2
    ends = sympy.solve(twice - (1 + mu**2) * (1 - lam_) ** 2, lam_)  # p = |1 - lam|
    assert sorted(map(str, map(sympy.factor, ends))) == sorted(
        str(sympy.factor(end)) for end in parallelogram.lam_range(mu)
    )
    printed = (mu - 1) / (mu + 1), (mu + 1) / (mu - 1)
    assert all(map(same, parallelogram.lam_range(mu), printed))
    other = sympy.expand((1 + mu**2) * (1 + lam_) ** 2 - twice)  # p < 1 + lam always
    assert all(term.is_positive for term in other.args)
    longer = MU > 1
    low, high = (MU[longer] - 1) / (MU[longer] + 1), (MU[longer] + 1) / (MU[longer] - 1)
    assert (low < LAM[longer]).all() and (LAM[longer] < high).all() and longer.sum() > 300
    np.testing.assert_array_equal(longer, np.cos(THETA) > 0)
    np.testing.assert_allclose(parallelogram.lam_range(MU[longer]), (low, high), rtol=1e-15)
    for part in np.random.default_rng(SEED).uniform(1e-6, 1, (500, 3)):
        m = 1 + 9 * part[0]
        start, stop = (m - 1) / (m + 1), (m + 1) / (m - 1)
        assert constructed(start + part[1] * (stop - start) * (1 - 1e-9), m)
        assert not constructed(start * part[2], m) and not constructed(stop / part[2], m)


def test_the_range_is_infinite_at_one_and_takes_arrays():
    assert parallelogram.lam_range(1.0) == (0.0, np.inf)
    low, high = parallelogram.lam_range([[1.0, 3.0, 0.5]])
    np.testing.assert_allclose(low, [[0.0, 0.5, 1 / 3]], rtol=1e-15)
    np.testing.assert_allclose(high, [[np.inf, 2.0, 3.0]], rtol=1e-15)


BAD_RATIOS = [
    (3, 2, r"lam = 3 at mu = 2 .* between 0\.333333 and 3 "),
    (1, -2, r"mu = -2: both must be positive and finite"),
    (np.nan, 1, r"lam = nan, .* positive and finite"),
    (np.inf, 1, r"lam = inf, .* positive and finite"),
    (1, np.inf, r"mu = inf: both must be positive and finite"),
    (0, 1, r"lam = 0, mu = 1: both must be positive and finite"),
    (1, 0, r"lam = 1, mu = 0: both must be positive and finite"),
    ([1, 2, 2], [1, 1, 9], r"lam = 2 at mu = 9 .* between 0\.8 and 1\.25 "),
    ([1, 1], [1, 1, 1], "broadcast"),
]
BAD_ANGLES = [0, -1, 3.1416, 60, np.nan, np.inf]
RANGE = "theta{} = {:.6g} rad: .* strictly between 0 and pi"
WRONG = [
    *(
        (getattr(parallelogram, name), (lam, mu), words)
        for name in ("angles", "half_angles", "cosines", "lengths", "rho")
        for lam, mu, words in BAD_RATIOS
    ),
    *((parallelogram.ratios, (bad, 1), RANGE.format("", bad)) for bad in BAD_ANGLES),
    *((parallelogram.log_ratios, (1, [1, x, 1]), RANGE.format(0, x)) for x in BAD_ANGLES),
    *((parallelogram.diagonals, (1, 1, bad), RANGE.format("", bad)) for bad in BAD_ANGLES),
    (parallelogram.diagonals, (1, -2, 1), "b = -2: a positive finite number"),
    (parallelogram.diagonals, (np.nan, 2, 1), "a = nan: a positive finite number"),
    (parallelogram.lam_range, ([1, 0],), "mu = 0: a positive finite number"),
    (parallelogram.check_whole, ("n", 2.5, 2), "n = 2.5: a whole number, 2 or more"),
    (parallelogram.check_whole, ("n", 0), "n = 0: a whole number, 1 or more"),
    (parallelogram.check_whole, ("n", float("nan")), "n = nan: a whole number"),
    *((parallelogram.from_rho, (r,), "upper half") for x in BAD_RHO for r in (x, [1j, x])),
    (parallelogram.diagonal_ratio, ([1j, 1],), "rho = 1"),
]


@pytest.mark.parametrize(("function", "arguments", "words"), WRONG)
def test_numbers_out_of_range_are_named_together_with_the_range(function, arguments, words):
    with pytest.raises(ValueError, match=words):
        function(*arguments)


def test_arrays_broadcast_agree_with_scalars_and_are_left_as_they_were():
    theta, theta0 = np.array([[0.4], [1.2], [2.7]]), np.array([0.3, 1.9])
    lam, mu = parallelogram.ratios(theta, theta0)
    assert lam.shape == mu.shape == (3, 2)
    assert (lam[2, 1], mu[2, 1]) == parallelogram.ratios(2.7, 1.9)
    before = lam.copy(), mu.copy()
    back = parallelogram.angles(lam, mu)
    np.testing.assert_allclose(back[0], np.broadcast_to(theta, (3, 2)), rtol=1e-13)
    np.testing.assert_allclose(back[1], np.broadcast_to(theta0, (3, 2)), rtol=1e-13)
    np.testing.assert_array_equal((lam, mu), before)
    np.testing.assert_array_equal(theta, [[0.4], [1.2], [2.7]])
    assert parallelogram.ratios([], [])[0].shape == (0,)


@pytest.mark.parametrize("number", [float, int, np.float32, np.float64, Fraction])
def test_every_kind_of_number_gives_scalars(number):
    one, two = number(1), number(2)
    results = [
        *parallelogram.angles(two, two),
        *parallelogram.ratios(one, two),
        *parallelogram.half_angles(two, two),
        *parallelogram.cosines(two, two),
        *parallelogram.half_cosines(two, two),
        *parallelogram.lengths(two, two),
        *parallelogram.lam_range(two),
        *parallelogram.diagonals(one, two, one),
    ]
    assert all(np.ndim(value) == 0 and isinstance(value, (int, float)) for value in results)


def test_exact_numbers_give_exact_ones_and_symbols_the_cosine_rule():
    lam, mu = sympy.sqrt(5), sympy.sqrt(2)
    theta, theta0 = parallelogram.angles(lam, mu)
    assert [sympy.simplify(sympy.tan(x)) for x in (theta, theta0)] == [2, 1]
    assert theta.free_symbols == set() and not theta.has(sympy.Float)
    assert parallelogram.cosines(lam, mu) == (1 / sympy.sqrt(5), 1 / sympy.sqrt(2))
    assert sympy.simplify(parallelogram.rho(lam, mu) - (1 + sympy.I) / 2) == 0
    for ratio in parallelogram.ratios(sympy.pi / 3, sympy.pi / 3):
        assert sympy.simplify(ratio.rewrite(sympy.log)) == sympy.GoldenRatio.expand(func=True)
    lam, mu, theta = sympy.symbols("lam mu theta", positive=True)
    _, b, p, q = parallelogram.lengths(lam, mu)
    cos_theta, cos_theta0 = parallelogram.cosines(lam, mu)
    assert sympy.simplify(1 + b**2 - 2 * b * cos_theta - p**2) == 0
    assert sympy.simplify((p**2 + q**2 - 2 * p * q * cos_theta0) / 4 - 1) == 0
    p, q = parallelogram.diagonals(1, lam, theta)
    assert sympy.simplify(p**2 - (1 + lam**2 - 2 * lam * sympy.cos(theta))) == 0
    assert sympy.simplify(q**2 - (1 + lam**2 + 2 * lam * sympy.cos(theta))) == 0


@pytest.mark.parametrize(
    "name", ["angles", "half_angles", "cosines", "half_cosines", "rho", "ratios", "log_ratios"]
)
def test_formulas_on_symbols_and_on_floats_are_the_same(name):
    function = getattr(parallelogram, name)
    symbols = sympy.symbols("x y", positive=True)
    compiled = sympy.lambdify(symbols, function(*symbols), "numpy")
    numbers = random_angles(50, margin=0.1) if "ratios" in name else (LAM[:50], MU[:50])
    np.testing.assert_allclose(compiled(*numbers), function(*numbers), rtol=1e-8, atol=1e-9)


def test_rho_is_the_quotient_of_the_drawn_diagonals_and_has_the_whole_shape():
    rho = (A - C) / (D - B)
    np.testing.assert_allclose(parallelogram.rho(LAM, MU), rho, atol=1e-11)
    found = parallelogram.diagonal_ratio(rho)
    np.testing.assert_allclose(found, LAM * np.exp(1j * THETA), rtol=1e-10)
    shape = parallelogram.from_rho(rho)
    np.testing.assert_allclose(shape, (LAM, MU, THETA, THETA0), rtol=1e-10)
    assert shape._fields == ("lam", "mu", "theta", "theta0")
    assert parallelogram.from_rho(1j) == pytest.approx((1, 1, np.pi / 2, np.pi / 2), rel=1e-15)
    r = sympy.Symbol("r")  # an involution
    once = parallelogram.diagonal_ratio(1 / r)
    assert sympy.simplify(parallelogram.diagonal_ratio(1 / once) - r) == 0
