"""Packed arguments of kernels, and pointers to arrays."""

import gc
from typing import NamedTuple

import numba
import numpy as np
import pytest

from jointwave.joints.formula import formula
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.jit import jitted


class Inner(NamedTuple):
    """A number and an array."""

    factor: float
    values: np.ndarray


class Outer(NamedTuple):
    """Numbers, and what holds others."""

    count: int
    large: bool
    inner: Inner
    absent: None = None


@formula
def scale(outer, table, result, limit, start):
    """What is absent is not compiled."""
    for i in range(start, outer.count):
        row = table[i]
        for k in range(row.size):
            result[i, k] = outer.inner.factor * row[k] + outer.inner.values[i]
    if limit is not None:
        result[0, 0] = limit
    return outer.large, table.size, table.shape, result.shape[1], outer.absent is None


@jitted
def scaled(given, start):
    return scale(*unpacked(given), start)


def given(limit=None, table=None):
    outer = Outer(2, True, Inner(-1.5, np.array([1.0, 2.0])))
    table = np.arange(6.0).reshape(2, 3) if table is None else table
    result = np.zeros((2, 3))
    return Packed(outer, table, result, limit), result


def test_numbers_arrays_and_tuples_arrive_as_they_are():
    packed, result = given()
    assert scaled(packed, 0) == (True, 6, (2, 3), 3, True)
    assert (result == -1.5 * np.arange(6.0).reshape(2, 3) + [[1.0], [2.0]]).all()


@pytest.mark.parametrize("limit", [np.pi, -0.0, np.inf, 5e-324])
def test_a_number_keeps_all_its_bits(limit):
    packed, result = given(limit)
    scaled(packed, 2)
    assert result[0, 0].tobytes() == np.float64(limit).tobytes()


def test_a_kernel_compiles_once_for_what_it_is_given():
    """What is absent is another kernel; other values and sizes are not."""
    kernel = numba.njit(scaled.__wrapped__)
    kernel(given()[0], 2)
    kernel(given(1.0)[0], 2)
    assert len(kernel.signatures) == 2
    kernel(given(table=np.zeros((9, 1)))[0], 2)
    kernel(given(2.0)[0], 2)
    assert len(kernel.signatures) == 2


def test_arrays_live_as_long_as_the_packed_arguments():
    """Nothing else holds the table here."""
    packed, result = given(table=np.full((2, 3), 7.0))
    gc.collect()
    np.full((500, 2, 3), -1.0)
    scaled(packed, 0)
    assert (result == -1.5 * 7.0 + np.array([[1.0], [2.0]])).all()


@pytest.mark.parametrize("value", [np.zeros((2, 3)).T, np.zeros(6)[::2], "text", [1.0], 1j, {}])
def test_what_kernels_cannot_take_is_refused(value):
    with pytest.raises(TypeError):
        Packed(1.0, value)


@jitted
def shifted(given):
    first, second = unpacked(given)
    for i in range(second.size):
        second[i] = first[0]


@pytest.mark.parametrize("distinct", [False, True])
def test_arrays_that_overlap_are_read_again(distinct):
    """Whoever says that they do not overlap gives none twice."""
    values = np.array([3.0, 1.0, 2.0])
    other = values.copy() if distinct else values
    shifted(Packed(values, other, distinct=distinct))
    assert (other == 3.0).all()
