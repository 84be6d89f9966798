"""What this machine can do at most, by two loops that do nothing else."""

import numba
import numpy as np
from kernels import ROUNDS, rate

CHAIN = 32  # products and sums on each number between its load and its store


@numba.njit(cache=True, error_model="numpy")
def triad(a, b, c, s):
    """a = b + s c, 24 bytes a number (McCalpin's STREAM)."""
    for i in range(a.size):
        a[i] = b[i] + s * c[i]


@numba.njit(cache=True, error_model="numpy", fastmath={"contract"})
def chain(x, s, c):
    """Products and sums in registers, fused where the machine can."""
    for i in range(x.size):
        value = x[i]
        for _ in range(CHAIN):
            value = s * value + c
        x[i] = value


def bandwidth() -> float:
    """Return bytes a second from and to memory."""
    a, b, c = (np.full(8_000_000, value) for value in (0.0, 1.0, 2.0))
    triad(a, b, c, 3.0)  # compiles
    return max(rate(lambda: triad(a, b, c, 3.0), 24 * a.size) for _ in range(ROUNDS))


def peak() -> float:
    """Return floating-point operations a second of one core."""
    x = np.ones(1024)
    chain(x, 0.5, 0.5)  # compiles
    return max(rate(lambda: chain(x, 0.5, 0.5), 2 * CHAIN * x.size) for _ in range(ROUNDS))
