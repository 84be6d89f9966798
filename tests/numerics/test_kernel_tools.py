"""Parts of kernels: denormals, counters between threads."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from jointwave.numerics.atomic import give_way, peek, post
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


@jitted
def relay(counter, data, thread, rounds):
    """Two threads add to one number in turn, each seeing what the other wrote."""
    for n in range(thread, rounds, 2):
        while peek(counter, 0) < n:
            give_way()
        data[0] = 2.0 * data[0] + n
        post(counter, 0, n + 1)


def test_counters_order_what_threads_write():
    """In turn by the counter, the result is that of one thread: every write was seen."""
    rounds = 40
    counter, data = np.zeros(1, dtype=np.int64), np.zeros(1)
    relay(np.full(1, rounds, dtype=np.int64), np.zeros(1), 0, 0)  # compiles
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda thread: relay(counter, data, thread, rounds), range(2)))
    expected = 0.0
    for n in range(rounds):
        expected = 2.0 * expected + n
    assert data[0] == expected
