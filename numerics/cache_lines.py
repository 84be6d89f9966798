"""Aligned arrays: no vector register of a row straddles two cache lines."""

from math import prod

import numpy as np

CACHE_LINE = 64  # bytes, as long as the widest vector register
NUMBERS = CACHE_LINE // 8


def zeros(shape: int | tuple[int, ...], first: int = 0) -> np.ndarray:
    """Return contiguous zeros with item `first`, where loops start, at the start of a cache line.

    Otherwise every or every second register straddles two lines, and steps take up to 1/3 longer.
    """
    room = np.zeros(prod(np.atleast_1d(shape).tolist()) + NUMBERS)
    start = -(room.ctypes.data // room.itemsize + first) % NUMBERS
    return room[start : start + room.size - NUMBERS].reshape(shape)
