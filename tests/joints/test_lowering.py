"""Loops, arithmetic, fields, flags and arrays given to a function, as our lowering writes them.

Each loop must count as Python's does, also where the range is empty, has steps, is used twice or
is not all of a loop; operators must give what numpy gives, also of NaN, infinity, -0 and whole
numbers that overflow; arrays must keep as many references as they had. Calls must pass tuples, and
hand on exceptions, as Python's do.
"""

import operator
import os
import subprocess
import sys
from itertools import product
from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from joints.compiler.calls import raises
from joints.compiler.lowering import INSTRUCTIONS
from joints.formula import KNOWN, formula, kernel_options

ours = pytest.mark.skipif(
    numba.version_info.short not in KNOWN, reason="this numba writes its own code"
)


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


REALS = np.nan, np.inf, -np.inf, 0.0, -0.0, 1.5, -2.5, 5e-324, 1.7e308
WHOLES = 0, 1, -1, 7, 2**62, -(2**63), 2**63 - 1


@pytest.mark.parametrize("op", sorted(INSTRUCTIONS[numba.int64], key=lambda op: op.__name__))
def test_operators_give_what_numpy_gives(op):
    part = formula(lambda a, b: op(a, b))

    @numba.njit(**kernel_options)
    def kernel(a, b):
        return part(a, b)

    with np.errstate(all="ignore"):
        for kind, numbers in ((np.float64, REALS), (np.int64, WHOLES)):
            for a, b in product(map(kind, numbers), repeat=2):
                found, expected = kernel(a, b), op(a, b)
                assert isinstance(found, bool) == isinstance(expected, np.bool_)
                np.testing.assert_equal(found, expected)
                assert np.signbit(found) == np.signbit(expected) or np.isnan(expected)


def test_numbers_of_two_types_meet_as_in_python():
    part = formula(lambda a, b: (a - b, a * b, a < b, a == b, a != b))

    @numba.njit(**kernel_options)
    def kernel(a, b):
        return part(a, b)

    for a, b in ((2, 2.0), (2.5, 2), (True, 1), (True, 0.5), (3, False)):
        assert kernel(a, b) == (a - b, a * b, a < b, a == b, a != b)


class Both(NamedTuple):
    array: np.ndarray
    number: float
    pair: tuple[int, float]


def test_fields_are_those_of_the_tuple_and_keep_their_references():
    part = formula(lambda both: (both.array, both.number * both.pair[1], both.pair[0]))

    @numba.njit(**kernel_options)
    def kernel(both):
        return part(both)

    both = Both(np.arange(3.0), 0.5, (4, 8.0))
    before = sys.getrefcount(both.array)
    array, product_of_two, first = kernel(both)
    np.testing.assert_equal(array, both.array)
    assert (product_of_two, first) == (4.0, 4)
    del array
    after = sys.getrefcount(both.array)
    assert after == before


def test_a_flag_is_known_where_it_is_given_and_where_it_is_a_variable():
    inner = formula(lambda x, flag: x + 1.0 if flag else x - 1.0)
    part = formula(lambda x, flag: (inner(x, True), inner(x, False), inner(x, flag)))

    @numba.njit(**kernel_options)
    def kernel(x, flag):
        return part(x, flag)

    assert kernel(2.0, True) == (3.0, 1.0, 3.0)
    assert kernel(2.0, False) == (3.0, 1.0, 1.0)


@ours
def test_what_unpacks_arguments_is_not_optimised_but_the_kernel_is():
    @numba.njit(**kernel_options)
    def kernel(a):
        return a[0] + operator.mul(a[1], 2.0)

    assert kernel(np.array([1.0, 2.0])) == 5.0
    code = next(iter(kernel.inspect_llvm().values()))
    marks = dict(
        line.split("attributes ")[1].split(" = ")
        for line in code.splitlines()
        if line.startswith("attributes")
    )
    heads = [line for line in code.splitlines() if line.startswith("define")]
    unpacks = [head for head in heads if "7cpython" in head]
    others = [head for head in heads if "kernel" in head and head not in unpacks]
    assert unpacks and others

    def optimised(head):
        return not any("optnone" in marks[name] for name in marks if f" {name} " in f"{head} ")

    assert not any(map(optimised, unpacks))
    assert all(map(optimised, others))


class Numbers(NamedTuple):
    a: float
    b: int
    c: float


class Mixed(NamedTuple):
    numbers: Numbers
    array: np.ndarray
    known: bool


def weighed(numbers, x, both):
    return numbers.a * x + numbers.b, (numbers.c, numbers.b + both[1]), both[0] and x > 0.0


def through_another(mixed, x):
    first, (second, third), positive = part_of_another(mixed.numbers, x, (mixed.known, 2))
    mixed.array[0] += first
    return second - mixed.array[0], third, positive


part_of_another = formula(weighed)


def test_tuples_reach_a_formula_and_come_back_whole():
    part = formula(through_another)

    @numba.njit(**kernel_options)
    def kernel(mixed, x):
        return part(mixed, x)

    for known, x in product((True, False), (0.5, -3.0)):
        arrays = np.arange(2.0), np.arange(2.0)
        found, expected = (
            function(Mixed(Numbers(2.5, 3, -1.0), array, known), x)
            for function, array in zip((kernel, through_another), arrays, strict=True)
        )
        assert found == expected
        np.testing.assert_array_equal(*arrays)


def counted(first, last, step):
    total = 0
    for i in range(first, last, step):
        total += i
    return total


def twice(first, last, step):
    return counted_by_step(first, last, step) + counted_by_step(last, first, -step)


counted_by_step = formula(counted)


@pytest.mark.parametrize("function", [counted, twice], ids=lambda f: f.__name__)
def test_what_a_formula_raises_reaches_the_caller_of_the_kernel(function):
    part = formula(function)

    @numba.njit(**kernel_options)
    def kernel(first, last, step):
        return part(first, last, step)

    assert kernel(1, 8, 3) == function(1, 8, 3)
    with pytest.raises(ValueError, match="must not be zero"):
        kernel(1, 8, 0)


@ours
def test_nothing_looks_for_an_exception_where_a_formula_never_raises(monkeypatch):
    found = []

    def noted(function):
        found.append(raises(function))
        return found[-1]

    monkeypatch.setattr("joints.compiler.lowering.raises", noted)
    part = formula(lambda x: 2.0 * x if x > 0.0 else x)
    numba.njit(lambda x: part(x), **kernel_options)(1.0)
    assert found == [False]

    @formula
    def first_of(n):
        for i in range(0, 1, n):
            return i

    numba.njit(lambda n: first_of(n), **kernel_options)(1)
    assert found == [False, True]


def test_a_formula_may_return_nothing():
    part = formula(lambda x: x if x > 0.0 else None)

    @numba.njit(**kernel_options)
    def kernel(x):
        found = part(x)
        return -1.0 if found is None else 2.0 * found

    assert (kernel(3.0), kernel(-3.0)) == (6.0, -1.0)


KERNELS = """
import sys
from joints.formula import apart
from numerics.jit import jitted_for

def kernel_for(factor):
    @apart
    def part(x):
        return factor * x

    @jitted_for(factor)
    def kernel(x):
        return part(x)

    return kernel

print(*(kernel_for(float(factor))(1.0) for factor in sys.argv[1:]))
"""


def test_kernels_of_two_processes_call_their_own_functions(tmp_path):
    """Both processes number the part alike; a third one loads both kernels from the cache."""
    file = tmp_path / "kernels.py"
    file.write_text(KERNELS)
    place = os.environ | {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    for factors in (["2"], ["3"], ["2", "3"], ["3", "2"]):
        found = subprocess.check_output([sys.executable, file, *factors], env=place, text=True)
        assert found.split() == [f"{factor}.0" for factor in factors]
    assert len(list(tmp_path.rglob("*.nbc"))) == 2
