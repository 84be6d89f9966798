"""Sums over blocks or freedoms, as kernels take them."""

from math import fsum

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from numerics.jit import jitted
from numerics.sums import total


@jitted
def summed(x, y, z):
    """Return what `total` does, for Python."""
    return total(x, y, z)


def every(values):
    """Return a strategy of three arrays of one length, the second and third None now and then."""
    return st.integers(0, 40).flatmap(
        lambda n: st.tuples(
            arrays(float, n, elements=values),
            *[st.none() | arrays(float, n, elements=values) for _ in range(2)],
        )
    )


@given(every(st.integers(-1000, 1000)))
def test_whole_numbers_are_summed_exactly(factors):
    """Each once, whatever the length is over four."""
    expected = np.prod([x for x in factors if x is not None], axis=0).sum()
    assert summed(*factors) == expected


@given(every(st.floats(-1e6, 1e6)))
def test_sums_differ_from_exact_ones_by_rounding_alone(factors):
    """Two products and n additions, each off by at most 2^-53 of the sum of magnitudes."""
    terms = np.prod([x for x in factors if x is not None], axis=0)
    bound = (terms.size + 2) * 2.0**-53 * np.abs(terms).sum() + 1e-300
    assert abs(summed(*factors) - fsum(terms)) <= bound


@pytest.mark.parametrize("n", [5, 100])
def test_what_is_no_number_shows(n):
    for place in range(n):
        x = np.ones(n)
        x[place] = np.nan
        assert np.isnan(summed(x, None, None))
