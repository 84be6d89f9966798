"""Contact points of a face between two blocks, and their shares of its area."""

from typing import Literal

import numpy as np


def face_points(
    side: float, n: int, rule: Literal["midpoint", "gauss"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x (m), z (m) and area (m2) of the n x n contact points of a square face, each [n * n].

    midpoint: the centres of n x n equal cells, as in Guo & Li (2002), (2), for n = 2; they carry
    1 - 1/n^2 of the face's bending stiffness. gauss: tensor product of the n Gauss-Legendre points,
    which for n >= 2 carry all of it. Both are symmetric to the last bit.
    """
    at, share = (2 * np.arange(n) + 1 - n) / n, np.full(n, 2 / n)  # on -1 .. 1
    if rule == "gauss":
        at, share = np.polynomial.legendre.leggauss(n)
    at, share = side / 2 * at, side / 2 * share
    x, z = np.meshgrid(at, at, indexing="ij")
    return x.ravel(), z.ravel(), np.outer(share, share).ravel()
