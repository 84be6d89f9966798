"""The blocks of a partition that a point lies in, and the contact that is nearest to it."""

import numpy as np

from jointwave.cases.geometry import locate
from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.partition.blocks import Partition


def block_at(partition: Partition, points: np.ndarray) -> np.ndarray:
    """Return the block that each point (float array [m, 2], m) lies in, or OUTSIDE; of blocks that
    share it, the first."""
    found = locate.blocks_at(partition.blocks, points)
    return np.array([one[0] if len(one) else OUTSIDE for one in found], dtype=np.int64)


def sides_at(partition: Partition, points: np.ndarray) -> list[list[int]]:
    """Return the blocks that each point (float array [m, 2], m) is read in, as the geometry's
    `sides_at` does."""
    return locate.sides_at(partition.blocks, points, len(partition.joint_sets))


def contact_at(partition: Partition, points: np.ndarray) -> np.ndarray:
    """Return the contact of a joint set that is nearest to each point (float array [m, 2], m)."""
    return locate.contact_at(partition.blocks, points, len(partition.joint_sets))
