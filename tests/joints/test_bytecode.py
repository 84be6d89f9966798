"""Branches that are never taken are not translated, and all others as Python takes them.

What numba cannot translate at all, an import, stands where no branch must lead.
"""

from itertools import product
from typing import NamedTuple

import numba
import pytest
from numba.core.errors import UnsupportedBytecodeError

from joints.formula import KNOWN, flags, formula, kernel_options

pytestmark = pytest.mark.skipif(
    numba.version_info.short not in KNOWN, reason="this numba translates all"
)


@flags
class Parts(NamedTuple):
    soft: bool
    damped: bool


def of_closure(a, b, n, parts):
    """Return a function that asks for two flags, a number and a tuple of its closure."""

    def asked(x, y):
        total = 0.0
        if a and b:
            total += x
        if a or (b and x > 1.0):
            total += 10.0 * x
        if not a:
            total -= 1.0
        elif not b:
            total -= 2.0
        else:
            total -= 4.0
        if n:
            total += n
        for i in range(3):
            if parts.soft and i == 1:
                continue
            total += 100.0 if parts.damped else 200.0
            while b:
                total *= 2.0
                break
        if y is None and not parts.soft:
            total += 0.5
        return total

    return asked


@pytest.mark.parametrize("a, b, soft, damped", list(product([False, True], repeat=4)))
def test_branches_are_those_that_python_takes(a, b, soft, damped):
    """Whatever the flags, of conditions with and, or and not, in loops and selections."""
    function = of_closure(a, b, 3 * a, Parts(soft, damped))
    kernel = numba.njit(**kernel_options)(function)
    for given in ((0.5, None), (2.0, None), (2.0, 1.0)):
        assert kernel(*given) == function(*given)


def imports(absent, parts):
    def asked(x, array):
        if absent:
            import os
        if parts.soft:
            import os
        if x > 0.0 and not parts.damped:
            import os
        if array is not None:
            import os  # noqa: F401
        return 2.0 * x

    return asked


def test_what_is_absent_is_not_translated():
    """Behind flags of a closure and of its tuples, and behind arguments that are None."""
    kernel = numba.njit(**kernel_options)(imports(False, Parts(False, True)))
    assert kernel(1.5, None) == 3.0
    for present in ((True, (False, True)), (False, (True, True)), (False, (False, False))):
        kernel = numba.njit(**kernel_options)(imports(present[0], Parts(*present[1])))
        with pytest.raises(UnsupportedBytecodeError):
            kernel(1.5, None)


@formula
def given(parts, x):
    if parts.soft:
        import os  # noqa: F401
    return -x if parts.damped else x


def test_flags_that_are_given_are_known():
    """Of a formula that takes them as an argument."""
    damped, free, soft = Parts(False, True), Parts(False, False), Parts(True, True)

    @numba.njit(**kernel_options)
    def both(x):
        return given(damped, x) + 10.0 * given(free, x)

    @numba.njit(**kernel_options)
    def refused(x):
        return given(soft, x)

    assert both(1.0) == 9.0
    with pytest.raises(UnsupportedBytecodeError):
        refused(1.0)


def changed(x, limit, parts):
    if x > 1.0:
        limit = 2.0
    total = x
    for _ in range(2):
        if limit is not None:
            total += limit
        else:
            total -= 1.0
        limit = None
    return total


def test_arguments_that_change_are_not_taken_for_known():
    """One that is None at first may be a number later."""
    kernel = numba.njit(**kernel_options)(changed)
    found = [kernel(x, 3.0, None) for x in (0.5, 2.0)]
    assert found == [changed(x, 3.0, None) for x in (0.5, 2.0)]
