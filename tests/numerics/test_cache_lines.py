"""Where arrays lie that kernels load register by register."""

import numpy as np
import pytest

from numerics.cache_lines import CACHE_LINE, zeros


@pytest.mark.parametrize("first", [0, 1, 7, 8])
@pytest.mark.parametrize("shape", [1, 7, 100, 4097, (3, 8), (2, 5, 7)])
def test_zeros_start_on_a_cache_line_where_loops_do(shape, first):
    """However often: no register then straddles two lines."""
    kept = [zeros(shape, first) for _ in range(20)]
    for vector in kept:
        assert (vector.ctypes.data + 8 * first) % CACHE_LINE == 0
        assert vector.shape == np.zeros(shape).shape and vector.dtype == float
        assert vector.flags.c_contiguous and not vector.any()


def test_arrays_do_not_overlap_and_may_be_empty():
    assert not any(zeros(9).ctypes.data % CACHE_LINE for _ in range(20))
    one, two = zeros(9, 1), zeros(9, 1)
    one[:] = 1.0
    assert not two.any() and zeros(0).size == zeros((0, 8), 1).size == 0
