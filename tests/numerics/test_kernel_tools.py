"""Parts of kernels: denormals."""

import numpy as np
import pytest

from jointwave.numerics.denormals import ARM, X86, flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted


@jitted
def halve(x, out):
    for i in range(x.size):
        out[i] = x[i] * 0.5


@jitted
def halve_flushed(x, out):
    old = flush_denormals()
    for i in range(x.size):
        out[i] = x[i] * 0.5
    restore_denormals(old)


@pytest.mark.skipif(not (X86 or ARM), reason="tiny numbers stay on this kind of processor")
def test_tiny_numbers_are_zero_only_while_asked():
    """2.2e-308 halved is below full precision: zero under the flag, itself before and after."""
    smallest, half = np.full(3, np.finfo(float).tiny), np.zeros(3)
    halve(smallest, half)
    assert (half == smallest / 2).all() and half.all()
    halve_flushed(smallest, half)
    assert not half.any()
    halve(smallest, half)
    assert (half == np.ldexp(smallest, -1)).all() and half.all()
