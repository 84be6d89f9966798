"""Tractions on the boundary of blocks, in one, two or three dimensions.

Their resultants on a block are the force, d numbers, and the sums of arm times force x_i F_j, d^2
numbers; the antisymmetric part of these is the moment about the centroid, the symmetric part gives
the mean stress. A quiet or matched side has the dashpots of Lysmer and Kuhlemeyer (1969), a
traction -Z v, with the impedances of `cases.material.quiet_sides`.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.measure import Moments, Outlines, outline_moments

#: Axes of each rotation, from the first towards the second, by the number of rotations.
TURNS: dict[int, list[tuple[int, int]]] = {0: [], 1: [(0, 1)], 3: [(1, 2), (2, 0), (0, 1)]}


class BoundaryPoints(NamedTuple):
    """Points on the boundary: block [m], ascending, place and arm from the block's centroid [m, d],
    m, outward normal [m, d], and area [m], m^(d-1)."""

    block: np.ndarray
    place: np.ndarray
    arm: np.ndarray
    normal: np.ndarray
    area: np.ndarray


def facets_on(blocks: Blocks, sides: tuple[str, ...], names: Sequence[str]) -> np.ndarray:
    """Return the indices of boundary facets on named sides; sides : all names, in order."""
    chosen = [k for k, name in enumerate(sides) if name in names]
    return np.flatnonzero(np.isin(blocks.boundary.side, chosen))


def points_on(
    blocks: Blocks, facets: np.ndarray, parts: Outlines | None = None, share: float = 1.0
) -> BoundaryPoints:
    """Return 2^(d-1) points on each boundary facet, exact for functions up to quadratic.

    They lie one standard deviation of the area from the centroid, to both sides along the first
    edge and across it: on a rectangle they are Gauss points.

    facets : indices. parts : part of each facet; absent: all of it. share : second moments of the
    points over those of the facet.
    """
    edge = blocks.boundary
    size, centroid, second = (
        Moments(edge.area[facets], edge.centroid[facets], edge.second_moment[facets])
        if parts is None
        else outline_moments(parts)
    )
    variance, axes = np.linalg.eigh(share * second / size[:, None, None])
    deviation = (axes * np.sqrt(np.maximum(variance, 0.0))[:, None]) @ axes.swapaxes(1, 2)
    tangents = _tangents(edge.normal[facets], edge.outlines, facets)
    signs = np.array(list(product((-1.0, 1.0), repeat=tangents.shape[1])))
    place = centroid[:, None] + signs @ (tangents @ deviation)
    which = np.repeat(facets, len(signs))
    place, block = place.reshape(-1, centroid.shape[1]), edge.blocks[which, 0]
    area = np.repeat(size / len(signs), len(signs))
    return BoundaryPoints(block, place, place - blocks.centroid[block], edge.normal[which], area)


def _tangents(normal: np.ndarray, outlines: Outlines, facets: np.ndarray) -> np.ndarray:
    """Return orthogonal unit vectors in facets [m, d - 1, d], the first along the first edge."""
    if normal.shape[1] == 1:
        return np.zeros((len(facets), 0, 1))
    first = outlines.first[facets]
    along = outlines.corners[first + 1] - outlines.corners[first]
    along /= np.linalg.norm(along, axis=1)[:, None]
    return np.stack([along] if normal.shape[1] == 2 else [along, np.cross(normal, along)], axis=1)


def freedoms(dim: int, rotations: int) -> np.ndarray:
    """Return the matrix [F, d + d^2] from resultants to a block's forces and moments; its transpose
    maps the block's velocities to that of the centroid and the gradient d v_j / d x_i."""
    found = np.zeros((dim + rotations, dim + dim**2))
    found[:dim, :dim] = np.eye(dim)
    for row, (i, j) in enumerate(TURNS[rotations], start=dim):
        found[row, dim + i * dim + j], found[row, dim + j * dim + i] = 1.0, -1.0
    return found


def levers(arm: np.ndarray) -> np.ndarray:
    """Return matrices [m, d + d^2, d] from forces at the ends of arms [m, d] to resultants."""
    count, dim = arm.shape
    force = np.tile(np.eye(dim), (count, 1, 1))
    moments = (arm[:, :, None, None] * np.eye(dim)).reshape(count, dim**2, dim)
    return np.concatenate([force, moments], axis=1)


def resultants(arm: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return the resultants of forces [..., m, d] at the ends of arms [m, d]: [..., m, d + d^2]."""
    return (levers(arm) @ force[..., None])[..., 0]


def summed(values: np.ndarray, row: np.ndarray, count: int) -> np.ndarray:
    """Return sums [..., count, k] of values [..., m, k] over points of ascending rows [m]."""
    found = np.zeros((*values.shape[:-2], count, values.shape[-1]))
    rows, first = np.unique(row, return_index=True)
    if len(rows):
        found[..., rows, :] = np.add.reduceat(values, first, axis=-2)
    return found


def dashpots(
    points: BoundaryPoints, impedance: np.ndarray, row: np.ndarray, count: int
) -> np.ndarray:
    """Return the resistance of dashpots at points [count, d + d^2, d + d^2]: resultants per
    velocity and velocity gradient of the block of each row.

    impedance : at the points [m, d, d], Pa s/m. row : of each point [m].
    """
    to = levers(points.arm)
    found = to @ (impedance * points.area[:, None, None]) @ to.swapaxes(1, 2)
    return summed(found.swapaxes(0, 1), row, count).swapaxes(0, 1)
