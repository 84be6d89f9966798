"""The critical step of rigid blocks in the plane, bounded block by block.

Leapfrog without damping is stable up to 2 / omega, omega the highest natural frequency. The energy
of a spring between two blocks, k (a - b)^2, is at most 2 k a^2 + 2 k b^2, so that the stiffness
matrix is at most twice its own diagonal blocks K_i, each that of block i with its neighbours held:

    max_i lambda(K_i, M_i)  <=  omega^2  <=  2 max_i lambda(K_i, M_i).

The lower bound is the motion of one block alone. The step that follows from the upper one is thus
never above the critical step and at most 30 % below it; in a square lattice where translation is
fastest it is equal to it.
"""

import numpy as np

from jointwave.cases.material.contact_points import ContactPoints
from jointwave.cases.material.rock_mass import Stiffness


def block_stiffness(
    count: int,
    blocks: np.ndarray,
    normals: np.ndarray,
    points: ContactPoints,
    stiffness: Stiffness,
) -> np.ndarray:
    """Return the stiffness of each block against its neighbours [count, 3, 3], N/m2 for
    displacements along x and y, and N for the rotation, per metre of thickness.

    blocks : i and j of contacts [c, 2]. normals : unit vectors from i to j [c, 2].
    """
    total = np.zeros((count, 3, 3))
    normal = normals[points.contact]
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    for side in (0, 1):
        block, arm = blocks[points.contact, side], points.arm[:, side]
        for along, k in ((normal, stiffness.normal), (tangent, stiffness.shear)):
            row = jump(along, arm)
            weight = k[points.contact] * points.length
            np.add.at(total, block, weight[:, None, None] * row[:, :, None] * row[:, None, :])
    return total


def jump(along: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Return what a block's displacements and rotation give of motion along a vector [p, 2] at the
    end of an arm [p, 2], m: rows [p, 3]."""
    turning = arm[:, 0] * along[:, 1] - arm[:, 1] * along[:, 0]
    return np.concatenate([along, turning[:, None]], axis=1)
