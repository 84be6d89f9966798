"""Variables that a formula uses more than once keep their values and types apart.

Each function, compiled by the passes of a formula, must give what Python gives. They are what
splitting live ranges can get wrong: names whose types differ from use to use, values that meet
after a branch, are carried around loops, are swapped, or are constants in one branch alone.
"""

import numba
import numpy as np
import pytest

from joints.formula import formula


def two_types(x, n):
    value = n
    total = value + 1
    value = x * 0.5
    return total + value


def meets_after_a_branch(x, n):
    y = 1
    if x > 0.0:
        y = 2.5 * x
    return y + n


def carried_around_a_loop(x, n):
    before, now = 0.0, 1.0
    for _ in range(n):
        before, now = now, before + x * now
    return now - before


def two_loops_with_one_index(x, n):
    total = 0.0
    for i in range(n):
        total += i * x
    for i in range(3):
        total = total * 0.5 + i
    return total


def nested_and_reset(x, n):
    total = 0.0
    for i in range(n):
        part = 0.0
        for k in range(i):
            part += k * x
            if part > 3.0:
                part = -1.0
        total += part
    return total


def left_early(x, n):
    found = -1
    for i in range(n):
        if i * x > 2.0:
            found = i
            break
    return found


def a_tuple_and_then_a_number(x, n):
    pair = (x, n)
    pair = pair[0] + pair[1]
    return pair


def assigned_from_itself(x, n):
    x = x + 1.0
    x = x * x if n > 2 else x
    x -= n
    return x


FUNCTIONS = [
    two_types,
    meets_after_a_branch,
    carried_around_a_loop,
    two_loops_with_one_index,
    nested_and_reset,
    left_early,
    a_tuple_and_then_a_number,
    assigned_from_itself,
]


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f.__name__)
def test_a_compiled_formula_is_python(function):
    inner = formula(function)

    @numba.njit(error_model="numpy")
    def kernel(xs, ns, found):
        for i in range(xs.size):
            found[i] = inner(xs[i], ns[i])

    xs, ns = np.array([-1.5, 0.0, 0.5, 2.0, 7.0]), np.array([0, 1, 2, 5, 9])
    found = np.empty(xs.size)
    kernel(xs, ns, found)
    assert found.tolist() == [float(function(x, n)) for x, n in zip(xs, ns, strict=True)]


def test_names_of_types_that_do_not_meet_are_refused_where_their_uses_do():
    """The pass renames; it does not make a value of two types of what a branch left open."""

    @formula
    def either(x):
        y = (x, x)
        if x > 0.0:
            y = x
        return y

    @numba.njit
    def kernel(x):
        return either(x)

    with pytest.raises(numba.TypingError):
        kernel(1.0)
