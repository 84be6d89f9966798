"""Points of contacts as springs: the stiffness of each block against its neighbours, to which the
bound of `dem.contacts.stability` and the rules of points are held."""

import numpy as np

#: The axes that each rotation turns into each other, by the number of dimensions.
TURNS: dict[int, tuple[list[int], list[int]]] = {
    1: ([], []),
    2: ([0], [1]),
    3: ([1, 2, 0], [2, 0, 1]),
}


def block_stiffness(
    count: int, blocks: np.ndarray, frame: np.ndarray, arm: np.ndarray, springs: np.ndarray
) -> np.ndarray:
    """Return the stiffness of each block against its neighbours [count, freedoms, freedoms], N/m of
    displacements, N of rotations, N m; in the plane per metre of thickness.

    blocks : i and j of each point [p, 2]. frame : axes there [p, axes, d]. arm : [p, 2, d], from
    the centroids of i and j, m. springs : of each axis [p, axes], N/m.
    """
    rows = jump(frame[:, None], arm[:, :, None])
    own = np.einsum("pa,psaf,psag->psfg", springs, rows, rows)
    total = np.zeros((count, *own.shape[2:]))
    np.add.at(total, blocks, own)
    return total


def jump(along: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Return what a block's displacements and rotations give of motion along a vector [..., d] at
    the end of an arm [..., d], m: rows [..., freedoms]."""
    along, arm = np.broadcast_arrays(along, arm)
    i, j = TURNS[along.shape[-1]]
    turning = arm[..., i] * along[..., j] - arm[..., j] * along[..., i]
    return np.concatenate([along, turning], axis=-1)
