"""Contacts between blocks, across periodic sides, and with walls, in any dimension."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.measure import Outlines, frames_of, joined
from jointwave.dem.sides.boundaries import facets_on, freedoms, levers


class Contacts(NamedTuple):
    """Contacts [c]: between blocks, then across periodic sides, then with walls.

    blocks : i and j [c, 2]; a wall is a j beyond the last block. area : m^(d-1). frame : normal
    from i to j, then the tangents [c, d, d]. arm : from the centroids of i and j, where they touch,
    to the centre [c, 2, d], m. centre : of block i's face [c, d], m. spread : second moments over
    the area, in the tangents [c, d - 1, d - 1], m2. column : of the law [c]; at first the joint
    set, NO_SET for none. excess : compliance of the rock beside the joint, normal and in shear
    [c, 2], m/Pa; None without. walls : names of fixed or shaken sides. outlines : of the faces, m.
    """

    blocks: np.ndarray
    area: np.ndarray
    frame: np.ndarray
    arm: np.ndarray
    centre: Any = None
    spread: Any = None
    column: Any = None
    excess: Any = None
    walls: tuple[str, ...] = ()
    outlines: Any = None

    def some(self, rows: np.ndarray) -> "Contacts":
        """Return the contacts of these rows, without their outlines."""
        kept = (None if one is None else one[rows] for one in self[:-2])
        return Contacts._make([*kept, self.walls, None])


def contacts_of(
    cut: Blocks,
    across: Sequence[tuple[Facets, np.ndarray]],
    sides: tuple[str, ...],
    walls: tuple[str, ...],
) -> Contacts:
    """Return all contacts of blocks, with the joint set of each.

    across : contacts across pairs of periodic sides, and the shift of their blocks j [d], m.
    sides : names of the boundary's sides, in order. walls : names of those that are walls.
    """
    parts, edges = [(cut.contacts, np.zeros(cut.body.dim)), *across], cut.boundary
    pairs, area, centre, normal, second, joint_set = (
        np.concatenate([getattr(one, key) for one, _ in parts])
        for key in ("blocks", "area", "centroid", "normal", "second_moment", "joint_set")
    )
    shift = np.repeat([one for _, one in parts], [len(one) for one, _ in parts], axis=0)
    held = facets_on(cut, sides, walls)
    block, reach = edges.blocks[held, 0], edges.centroid[held] - cut.centroid[edges.blocks[held, 0]]
    wall = np.array([walls.index(sides[k]) for k in edges.side[held]], dtype=int)
    i, j = (centre - cut.centroid[one] for one in pairs.T)
    area = np.concatenate([area, edges.area[held]])
    frame = frames_of(np.concatenate([normal, edges.normal[held]]))
    spread = np.concatenate([second, edges.second_moment[held]]) / area[:, None, None]
    arms = np.stack([i, j - shift], axis=1), np.stack([reach, np.zeros_like(reach)], axis=1)
    return Contacts(
        blocks=np.concatenate([pairs, np.stack([block, cut.count + wall], axis=1)]),
        area=area,
        frame=frame,
        arm=np.concatenate(arms),
        centre=np.concatenate([centre, edges.centroid[held]]),
        spread=frame[:, 1:] @ spread @ frame[:, 1:].swapaxes(1, 2),
        column=np.concatenate([joint_set, np.full(len(held), NO_SET)]),
        walls=walls,
        outlines=joined([*(one.outlines for one, _ in parts), _some(edges.outlines, held)]),
    )


def _some(pieces: Outlines, rows: np.ndarray) -> Outlines:
    """Return the pieces of these rows."""
    size = np.diff(pieces.first)[rows]
    first = np.append(0, np.cumsum(size))
    at = np.arange(first[-1]) + np.repeat(pieces.first[rows] - first[:-1], size)
    return Outlines(pieces.corners[at], first)


def extents(contacts: Contacts, points: np.ndarray, blocks: int) -> np.ndarray:
    """Return the extent of blocks j behind the centres of faces, and of the faces along their
    tangents [c, d], m: points of blocks i beyond it carry nothing.

    A face extends half a side of the rectangle with its second moments, and at least 1.5 times as
    far as its points, so that corner points leave it no earlier than midpoints. Walls are infinite.

    points : of `law.points_on`. blocks : their number.
    """
    half = np.sqrt(3 * np.diagonal(contacts.spread, axis1=1, axis2=2))
    farthest = 1.5 * np.abs(points[..., :-1]).max(axis=1)
    behind = -2 * (contacts.arm[:, 1] * contacts.frame[:, 0]).sum(axis=1)
    found = np.column_stack([behind, np.maximum(half, farthest)])
    found[contacts.blocks[:, 1] >= blocks] = np.inf
    return found


def jumps_of(frame: np.ndarray, arm: np.ndarray, rotations: int) -> np.ndarray:
    """Return the matrices [c, F, F] from a block's motion to its part of the jump at the centre of
    a face and of the relative rotation; frame : [c, d, d]. arm : [c, d], m."""
    count, dim = arm.shape
    found = np.zeros((count, dim + rotations, dim + rotations))
    found[:, :dim] = frame @ levers(arm).swapaxes(1, 2) @ freedoms(dim, rotations).T
    if rotations:
        found[:, dim:, dim:] = 1.0 if dim == 2 else frame
    return found


def springs_of(
    normal: np.ndarray, shear: np.ndarray, area: np.ndarray, spread: np.ndarray, rotations: int
) -> np.ndarray:
    """Return stiffness matrices of faces for jump and relative rotation [c, F, F], N/m and N m.

    normal, shear : Pa/m [c]. area : [c]. spread : as in `Contacts`.
    """
    dim = spread.shape[1] + 1
    found = np.zeros((len(area), dim + rotations, dim + rotations))
    found[:, 0, 0] = normal * area
    for a in range(1, dim):
        found[:, a, a] = shear * area
    bent = (normal * area)[:, None, None] * spread
    if rotations == 1:
        found[:, 2, 2] = bent[:, 0, 0]
    elif rotations:
        found[:, 3, 3] = shear * area * np.trace(spread, axis1=1, axis2=2)
        found[:, 4:, 4:] = bent[:, ::-1, ::-1] * [[1, -1], [-1, 1]]
    return found
