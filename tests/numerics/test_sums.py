"""Sums over blocks or freedoms, as kernels take them."""

from math import fsum

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from jointwave.numerics.jit import jitted
from jointwave.numerics.sums import total_of


@jitted
def summed(x):
    """Return what `total_of` does, for Python."""
    return total_of(x)


@given(arrays(float, st.integers(0, 40), elements=st.integers(-1000, 1000)))
def test_whole_numbers_are_summed_exactly(x):
    """Each once, whatever the length is over four."""
    assert summed(x) == x.sum()


@given(arrays(float, st.integers(0, 40), elements=st.floats(-1e6, 1e6)))
def test_sums_differ_from_exact_ones_by_rounding_alone(x):
    """n additions, each off by at most 2^-53 of the sum of magnitudes."""
    bound = x.size * 2.0**-53 * np.abs(x).sum() + 1e-300
    assert abs(summed(x) - fsum(x)) <= bound


@pytest.mark.parametrize("n", [5, 100])
def test_what_is_no_number_shows(n):
    for place in range(n):
        x = np.ones(n)
        x[place] = np.nan
        assert np.isnan(summed(x))
