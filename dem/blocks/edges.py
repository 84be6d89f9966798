"""Points on edges of blocks, and the forces and moments of tractions there.

Quiet sides have the dashpots of Lysmer and Kuhlemeyer: a traction -rho a v_n - rho b v_s at points
of each edge, with the impedances of `cases.material.quiet_sides`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.block_stiffness import jump
from jointwave.cases.material.contact_points import points_of
from jointwave.cases.partition.blocks import BoundaryEdges, Partition

#: Rows of the resultants of tractions on a block: the force, and the sums of arm times force,
#: whose antisymmetric part is the moment about the centroid.
F_X, F_Y, S_XX, S_XY, S_YX, S_YY = range(6)


class EdgePoints(NamedTuple):
    """Points on edges: block [m], place [m, 2] and arm from the centroid [m, 2], m, outward normal
    [m, 2], and the length that each stands for [m], m."""

    block: np.ndarray
    place: np.ndarray
    arm: np.ndarray
    normal: np.ndarray
    length: np.ndarray


def points_on(
    partition: Partition, edges: BoundaryEdges, chosen: np.ndarray, part: np.ndarray | None = None
) -> EdgePoints:
    """Return two Gauss points on each of the chosen edges, bool array [b], exact for functions
    linear along an edge.

    part : start and end along each edge, over its length [b, 2]; absent: all of it.
    """
    index = np.flatnonzero(chosen)
    x, w = points_of("gauss", 2)
    low, high = (np.zeros(len(index)), np.ones(len(index))) if part is None else part[index].T
    which = np.repeat(index, 2)
    t = (low[:, None] + np.outer(high - low, x)).ravel()[:, None]
    place = edges.start[which] * (1 - t) + edges.end[which] * t
    block = edges.block[which]
    length = edges.length[which] * (np.outer(high - low, w)).ravel()
    arm = place - partition.centroid[block]
    return EdgePoints(block, place, arm, edges.normal[which], length)


def gathered(arm: np.ndarray, traction: np.ndarray) -> np.ndarray:
    """Return the resultants of forces [..., m, 2] at arms [m, 2], each [..., m, 6]."""
    found = np.empty((*traction.shape[:-1], 6))
    found[..., : F_Y + 1] = traction
    for place, (i, j) in zip((S_XX, S_XY, S_YX, S_YY), np.ndindex(2, 2), strict=True):
        np.multiply(arm[:, i], traction[..., j], out=found[..., place])
    return found


def on_rows(values: np.ndarray, row: np.ndarray, count: int) -> np.ndarray:
    """Return sums of values [..., m, k] over the points of each row [m]: [..., count, k]."""
    found = np.zeros((*values.shape[:-2], count, values.shape[-1]))
    order = np.argsort(row, kind="stable")
    rows, first = np.unique(row[order], return_index=True)
    if (np.diff(row) < 0).any():  # else they are in order already
        values = values[..., order, :]
    if len(rows):
        found[..., rows, :] = np.add.reduceat(values, first, axis=-2)
    return found


def resultant(sums: np.ndarray) -> np.ndarray:
    """Return force and moment [..., 3] of resultants [..., 6]."""
    moment = sums[..., S_XY] - sums[..., S_YX]
    return np.stack([sums[..., F_X], sums[..., F_Y], moment], axis=-1)


def on_freedoms(resistance: np.ndarray) -> np.ndarray:
    """Return force and moment per velocity [h, 3, 3] of the resultants of dashpots [h, 6, 3]."""
    return np.moveaxis(resultant(np.moveaxis(resistance, 1, -1)), -1, 1)


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
