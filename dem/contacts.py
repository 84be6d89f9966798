"""Contacts between blocks, across periodic sides, and with walls, in any dimension."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.measure import Outlines
from jointwave.dem.boundaries import freedoms, levers


class Contacts(NamedTuple):
    """Contacts [c], those of the blocks first and in their order.

    blocks : i and j [c, 2]; a wall is a j beyond the last block. area : m^(d-1). centre : [c, d],
    m, that of block i's face. frame : [c, d, d], the normal from i to j, then the tangents. arm :
    [c, 2, d], from the centroids of i and j, where they touch, to the centre. spread : second
    moments over the area, in the frame's tangents [c, d - 1, d - 1], m2. column : of the law [c].
    walls : names of the sides or ends that stand still, or are shaken. outlines : corners of the
    faces between blocks, m; None of rectangles along the tangents.
    """

    blocks: np.ndarray
    area: np.ndarray
    centre: np.ndarray
    frame: np.ndarray
    arm: np.ndarray
    spread: np.ndarray
    column: np.ndarray
    walls: tuple[str, ...]
    outlines: Outlines | None = None


def extents(contacts: Contacts, points: np.ndarray, blocks: int) -> np.ndarray:
    """Return how far blocks j reach behind the centres of faces, and these along their tangents
    [c, d], m: points of blocks i that move on beyond carry nothing.

    A face reaches as far as the rectangle with its second moments, and half as far again as its
    points: corners leave it as late as midpoints do. Walls reach everywhere.

    points : as `columns.points_on` has them. blocks : their number.
    """
    half = np.sqrt(3 * np.diagonal(contacts.spread, axis1=1, axis2=2))
    farthest = 1.5 * np.abs(points[..., :-1]).max(axis=1)
    behind = -2 * (contacts.arm[:, 1] * contacts.frame[:, 0]).sum(axis=1)
    found = np.column_stack([behind, np.maximum(half, farthest)])
    found[contacts.blocks[:, 1] >= blocks] = np.inf
    return found


def jumps_of(frame: np.ndarray, arm: np.ndarray, rotations: int) -> np.ndarray:
    """Return the matrices [c, F, F] that make the motion of blocks their part of the jump at the
    centres of faces with these frames [c, d, d], and of the rotation; arm : [c, d], m."""
    count, dim = arm.shape
    found = np.zeros((count, dim + rotations, dim + rotations))
    found[:, :dim] = frame @ levers(arm).swapaxes(1, 2) @ freedoms(dim, rotations).T
    if rotations:
        found[:, dim:, dim:] = 1.0 if dim == 2 else frame
    return found


def springs_of(
    normal: np.ndarray, shear: np.ndarray, area: np.ndarray, spread: np.ndarray, rotations: int
) -> np.ndarray:
    """Return the stiffness of faces against their jumps and rotations [c, F, F], N/m and N m.

    normal, shear : Pa/m [c]. area : [c]. spread : as in `Contacts`.
    """
    dim = spread.shape[1] + 1
    found = np.zeros((len(area), dim + rotations, dim + rotations))
    found[:, 0, 0] = normal * area
    for a in range(1, dim):
        found[:, a, a] = shear * area
    if rotations:
        bent = (normal * area)[:, None, None] * spread
        found[:, -1, -1] = bent[:, 0, 0]
    if rotations == 3:
        found[:, 3, 3] = shear * area * np.trace(spread, axis1=1, axis2=2)
        found[:, 4, 4], found[:, 4, 5], found[:, 5, 4] = (
            bent[:, 1, 1],
            -bent[:, 0, 1],
            -bent[:, 0, 1],
        )
    return found
