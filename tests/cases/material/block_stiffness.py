"""Motion at contact points that follows from displacements and rotations of rigid blocks."""

import numpy as np

#: The axes that each rotation turns into each other, by the number of dimensions.
TURNS: dict[int, tuple[list[int], list[int]]] = {
    1: ([], []),
    2: ([0], [1]),
    3: ([1, 2, 0], [2, 0, 1]),
}


def jump(along: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Return what a block's displacements and rotations give of motion along a vector [..., d] at
    the end of an arm [..., d], m: rows [..., freedoms]."""
    along, arm = np.broadcast_arrays(along, arm)
    i, j = TURNS[along.shape[-1]]
    turning = arm[..., i] * along[..., j] - arm[..., j] * along[..., i]
    return np.concatenate([along, turning], axis=-1)
