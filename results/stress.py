"""Stress components: xx, yy, xy in the plane; xx, yy, zz, xy, yz, xz in space."""

import numpy as np

from jointwave.results.labels import AXES


def stress_components(dim: int) -> dict[str, tuple[int, int]]:
    """Return the names of the stress components in `dim` dimensions, with their tensor indices."""
    pairs = [*((k, k) for k in range(dim)), *((0, 1), (1, 2), (0, 2))[: dim * (dim - 1) // 2]]
    return {AXES[i] + AXES[j]: (i, j) for i, j in pairs}


def tensors(stress: np.ndarray) -> np.ndarray:
    """Return stress tensors [..., d, d] from their components [..., 1, 3 or 6]."""
    dim = {1: 1, 3: 2, 6: 3}[stress.shape[-1]]
    found = np.empty((*stress.shape[:-1], dim, dim))
    for k, (i, j) in enumerate(stress_components(dim).values()):
        found[..., i, j] = found[..., j, i] = stress[..., k]
    return found
