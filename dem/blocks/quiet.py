"""Quiet sides: dashpots of Lysmer and Kuhlemeyer on the edges of the blocks there.

A traction -rho a v_n - rho b v_s at points of each edge, with the impedances of
`cases.material.quiet_sides`.
"""

import numpy as np

from cases.material.rigid_step import jump
from dem.blocks.edges import EdgePoints, gathered, on_rows


def dashpots(points: EdgePoints, impedance: np.ndarray, row: np.ndarray, count: int) -> np.ndarray:
    """Return the resultants of each row's quiet edges per velocity of its block, with the sign of a
    resistance [count, 6, 3].

    impedance : [m, 2], Pa s/m. row : of each point [m].
    """
    tangent = np.stack([-points.normal[:, 1], points.normal[:, 0]], axis=1)
    traction = np.zeros((3, len(row), 2))
    for along, Z in zip((points.normal, tangent), impedance.T, strict=True):
        felt = jump(along, points.arm)  # of a velocity of the block [m, 3]
        traction += (Z * points.length)[:, None] * felt.T[:, :, None] * along
    return np.moveaxis(on_rows(gathered(points.arm, traction), row, count), 0, -1)
