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


def test_the_printed_theta_parallelograms_have_the_printed_ratio():
    for degrees, lam in ((60, GOLDEN), (45, (2**0.5 + 6**0.5) / 2), (30, (3**0.5 + 7**0.5) / 2)):
        found = parallelogram.ratios(*np.radians([degrees, degrees]))
        assert found == pytest.approx((lam, lam), rel=1e-14)


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


def test_ratio_two_twice_gives_the_printed_arccos_three_quarters():
    assert parallelogram.angles(2, 2) == pytest.approx([np.arccos(0.75)] * 2, rel=1e-14)
    assert parallelogram.angles(0.5, 0.5) == pytest.approx([np.pi - np.arccos(0.75)] * 2)


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


def test_diagonal_ratio_of_lam_equal_mu_is_root_two_for_p():
    _, b, p, q = parallelogram.lengths(1.7, 1.7)
    assert (b, p, q) == pytest.approx((1.7, 2**0.5, 1.7 * 2**0.5), rel=1e-15)


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


def test_is_admissible_is_eq_4_on_random_ratios():
    lam, mu = np.exp(np.random.default_rng(SEED).uniform(-2, 2, (2, 4000)))
    wanted = [literal_eq_4(x, y) for x, y in zip(lam, mu, strict=True)]
    assert 1000 < sum(wanted) < 3000
    np.testing.assert_array_equal(parallelogram.is_admissible(lam, mu), wanted)


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


def test_lam_range_is_the_printed_interval_and_infinite_at_one():
    assert parallelogram.lam_range(3.0) == pytest.approx((0.5, 2.0), rel=1e-15)
    assert parallelogram.lam_range(0.5) == pytest.approx((1 / 3, 3.0), rel=1e-15)
    assert parallelogram.lam_range(1.0) == (0.0, np.inf)
    low, high = parallelogram.lam_range([[1.0, 3.0]])
    np.testing.assert_array_equal(low, [[0.0, 0.5]])
    np.testing.assert_array_equal(high, [[np.inf, 2.0]])
    mu = sympy.Symbol("mu", positive=True)
    low, high = parallelogram.lam_range(mu)
    assert sympy.simplify(low * high) == 1
    assert low.subs(mu, 3) == sympy.Rational(1, 2)


def test_lam_range_for_theta_parallelograms_ends_at_root_two_plus_minus_one():
    for mu in (2**0.5 - 1, 2**0.5 + 1):  # Eq. (9): where lam = mu meets the border
        assert mu == pytest.approx(parallelogram.lam_range(mu)[mu > 1], rel=1e-15)


BAD_RATIOS = [
    (3, 2, r"lam = 3 at mu = 2 .* between 0\.333333 and 3 "),
    (1, -2, r"mu = -2: both must be positive and finite"),
    (np.nan, 1, r"lam = nan, .* positive and finite"),
    (np.inf, 1, r"lam = inf, .* positive and finite"),
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
    assert sympy.simplify(p**2 + q**2 - 2 * (1 + lam**2)) == 0


def test_exact_half_angles_have_the_printed_cosines():
    lam, mu = sympy.sqrt(5), sympy.sqrt(2)
    halves = parallelogram.half_angles(lam, mu)
    for half, cosine in zip(halves, parallelogram.half_cosines(lam, mu), strict=True):
        assert sympy.simplify(sympy.cos(half) - cosine) == 0


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
