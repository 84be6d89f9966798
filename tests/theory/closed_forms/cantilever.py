"""The row of rigid blocks as a cantilever that bends and shears under its own weight.

The blocks hang on a fixed end, and g acts across. Contact j, the wall being j = N, carries the
force S_j = j m g and the moment M_j = m g d j^2 / 2 of the j blocks before it, so it slips by
e_j = S_j / k_s and turns by phi_j = M_j / k_b, at the wall half as much because its spring is that
of half a block; k_s = K'_s A and k_b = K'_n I of the contact points, and block i moves by

    u_i = sum_{j >= i} e_j + phi_j (j - i + 1/2) d,   theta_i = sum_{j >= i} phi_j"""

import numpy as np


def deflection(
    block_count: int, spacing: float, weight: float, shear: float, bending: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the deflection (m) and the rotation (rad) of every block, float arrays [N]. spacing d
    in m, weight m g of a block in N, shear k_s in N/m, bending k_b in N m."""
    j = np.arange(1, block_count + 1)
    softness = np.where(j < block_count, 1.0, 0.5)
    slip = softness * j * weight / shear
    turn = softness * weight * spacing * j**2 / (2 * bending)
    behind = j[None, :] >= j[:, None]
    lever = (j[None, :] - j[:, None] + 0.5) * spacing
    return (behind * (slip + turn * lever)).sum(axis=1), (behind * turn).sum(axis=1)
