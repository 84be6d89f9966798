"""Loops over ranges, and arrays that a function is given, as our lowering writes them.

Each loop must count as Python's does, also where the range is empty, has steps, is used twice or
is not all of a loop; arrays must keep as many references as they had.
"""

import sys

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from joints.formula import formula, kernel_options


def from_to(n, m):
    total = 0
    for i in range(n, m):
        total = 3 * total + i
    return total


def in_steps(n, m):
    total = 0
    for i in range(m, n, -2):
        total = 3 * total + i
    return total


def bounds_that_change(n, m):
    total = 0
    for i in range(n):
        n = i
        m += 1
        for k in range(n, m):
            total += k * i
            m = i
    return total + n + m


def last_number(n, m):
    i = -7
    for i in range(n, m):  # noqa: B007
        pass
    return i


def range_used_twice(n, m):
    both, total = range(n, m), 0
    for i in both:
        for k in both:
            total = total + 2 * i - k
    return total + len(both)


def left_and_continued(n, m):
    total = 0
    for i in range(n, m):
        if i == 2:
            continue
        if i > 5:
            break
        total += i
    else:
        total += 100
    return total


def one_of_two(n, m):
    total = 0
    for i in range(n) if m > 3 else range(m):
        total += i + 1
    return total


FUNCTIONS = (
    from_to, in_steps, bounds_that_change, last_number, range_used_twice, left_and_continued,
    one_of_two,
)  # fmt: skip


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.__name__)
def test_loops_count_as_in_python(function):
    part = formula(function)

    @numba.njit(**kernel_options)
    def kernel(n, m):
        return part(n, m)

    for n in (-2, 0, 1, 4, 9):
        for m in (-3, 0, 3, 5, 8):
            assert kernel(n, m) == function(n, m)


def summed(a, b):
    one, total = a, 0.0
    both = one, b
    for i in range(one.size):
        total += one[i] * both[1][i]
        one[i] = total
    return total


def handed_back(a, b):
    other = a if a[0] > 0.0 else b
    return other


def rows(a, b):
    held, total = np.zeros((2, 3)), 0.0
    for i in range(2):
        row = held[i]
        row[:] = a + i * b
        total += row.sum()
    return held[1], total


@pytest.mark.parametrize("function", [summed, handed_back, rows], ids=lambda f: f.__name__)
def test_references_are_kept_and_released(function):
    part = formula(function)

    @numba.njit(**kernel_options)
    def kernel(a, b):
        return part(a, b)

    a, b = np.arange(1.0, 4.0), np.ones(3)
    expected = function(a.copy(), b.copy())
    before = sys.getrefcount(a), sys.getrefcount(b)
    kernel(a.copy(), b.copy())
    _nrt_python.memsys_enable_stats()
    try:
        found = kernel(a, b)
        np.testing.assert_equal(found, expected)
        del found
        kept = rtsys.get_allocation_stats()
    finally:
        _nrt_python.memsys_disable_stats()
    assert (sys.getrefcount(a), sys.getrefcount(b)) == before
    assert kept.mi_alloc == kept.mi_free > 0
