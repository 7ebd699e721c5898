"""`ties`: numbers equal up to rounding are decided by index, all others by their size."""

import numpy as np
import pytest

from inetlib import ties
from inetlib.drawings import patches

HALVES = np.array([0, 0, 1, 1, 2, 2, 3, 3, 4])  # of 0, 0.5, 1, ...: halves go down


def noisy(seed, values):
    return values * (1 + 1e-13 * np.random.default_rng(seed).standard_normal(np.shape(values)))


@pytest.mark.parametrize("seed", range(8))
def test_equal_numbers_are_decided_by_index(seed):
    values = noisy(seed, np.array([2.0, 3.0, 1.0, 3.0, 1.0, 3.0]))
    assert ties.first_largest(values) == 1
    assert ties.first_smallest(values) == 2
    np.testing.assert_array_equal(ties.ranks(values, 1e-9), [1, 2, 0, 2, 0, 2])
    assert ties.at_most(values[1], values[3]) and ties.at_most(values[3], values[1])
    np.testing.assert_array_equal(ties.nearest_whole(noisy(seed, np.arange(9) / 2)), HALVES)


def test_numbers_about_zero_need_a_scale():
    values = np.array([1e-17, 0.0, 2e-16, 1.0])
    assert ties.first_smallest(values) == 1
    assert ties.first_smallest(values, 1.0) == 0
    assert ties.first_largest(values[:3], 1.0) == 0


def test_other_numbers_are_decided_by_size():
    values = np.array([1.0, 1.0 + 1e-7, 1.0 - 1e-7])
    assert ties.first_largest(values) == 1
    assert ties.first_smallest(values) == 2
    assert not ties.at_most(values[1], values[0])
    np.testing.assert_array_equal(ties.ranks(values, 1e-9), [1, 2, 0])
    np.testing.assert_array_equal(ties.nearest_whole([0.5 + 1e-8, -0.5 - 1e-8, 2.4]), [1, -1, 2])


def test_the_next_multiple_is_the_number_itself_up_to_rounding():
    for noise in (-1e-13, 0.0, 1e-13):
        assert patches.next_multiple(30 * (1 + noise), 5) == 30
    assert patches.next_multiple(30 + 1e-6, 5) == 35
    assert patches.next_multiple(1.15, 0.1) == pytest.approx(1.2)
