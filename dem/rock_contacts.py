"""All contacts of a rock mass: of blocks, across periodic sides, and with walls."""

from __future__ import annotations

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.measure import joined
from jointwave.cases.geometry.periodic import Across, of_all
from jointwave.cases.material.rigid_blocks import welds
from jointwave.cases.material.rock import shear_modulus
from jointwave.cases.material.rock_mass import Stiffness, constrained_modulus
from jointwave.cases.partition.joints import ROCK, rocks_of
from jointwave.cases.partition.scene import across_periodic
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.contacts import Contacts
from jointwave.dem.receivers import frames_of


def contacts_of(
    scene: RockMass, blocks: Blocks, sides: tuple[str, ...], further: list[JointSet]
) -> tuple[Contacts, np.ndarray, Stiffness]:
    """Return all contacts of a scene, some by further sets of cuts; sides : names of the boundary's
    sides, in order. With them, of the columns of their law, the kinds of those of sets, as
    `RigidJoints` has them [columns, 3], and the stiffness of the others, after those.

    A fixed side is a wall behind the rock from each block's centroid to the side, as stiff as that
    rock is: half a block. So is intact rock between blocks where no set made the cut. A roller side
    is such a wall without stiffness in shear.
    """
    across = across_periodic(scene, blocks)
    pairs, area, centre, normal, second, joint_set, shift = _between(blocks, across)
    walls, held, wall = _at_walls(scene, blocks, sides)
    edges, block = blocks.boundary, blocks.boundary.blocks[held, 0]
    kinds, column = _columns(scene, blocks, joint_set, pairs, len(further))
    cuts = np.flatnonzero(joint_set == NO_SET)
    column = np.concatenate([column, np.full(len(block), NO_SET)])
    column[column == NO_SET] = len(kinds) + np.arange(len(cuts) + len(block))
    welded = pairs[cuts], centre[cuts], normal[cuts], shift[cuts]
    others = welds(scene, blocks, further, *welded), _of_walls(scene, blocks, held, walls, wall)
    area = np.concatenate([area, edges.area[held]])
    frame = frames_of(np.concatenate([normal, edges.normal[held]]))
    second = np.concatenate([second, edges.second_moment[held]]) / area[:, None, None]
    i, j = (centre - blocks.centroid[one] for one in pairs.T)
    reach = edges.centroid[held] - blocks.centroid[block]
    arms = np.stack([i, j - shift], axis=1), np.stack([reach, np.zeros_like(reach)], axis=1)
    found = Contacts(
        blocks=np.concatenate([pairs, np.stack([block, blocks.count + wall], axis=1)]),
        area=area,
        centre=np.concatenate([centre, edges.centroid[held]]),
        frame=frame,
        arm=np.concatenate(arms),
        spread=frame[:, 1:] @ second @ frame[:, 1:].swapaxes(1, 2),
        column=column,
        walls=walls,
        outlines=joined([blocks.contacts.outlines, *(one.contacts.outlines for one in across)]),
    )
    return found, kinds, Stiffness(*map(np.concatenate, zip(*others, strict=True)))


def _between(blocks: Blocks, across: list[Across]) -> tuple[np.ndarray, ...]:
    """Return pairs, area, centroid, normal, second moments and joint set of the contacts of blocks,
    and by which blocks j stand elsewhere, across periodic sides [c, d], m."""
    beside = [np.zeros(blocks.body.dim), *(one.shift for one in across)]
    number = [len(blocks.contacts), *(len(one.contacts) for one in across)]
    keys = "blocks", "area", "centroid", "normal", "second_moment", "joint_set"
    found = (of_all(blocks, across, key) for key in keys)
    return *found, np.repeat(beside, number, axis=0)


def _at_walls(
    scene: RockMass, blocks: Blocks, sides: tuple[str, ...]
) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Return the names of the fixed and the roller sides, the boundary facets on them, and the wall
    of each."""
    present = {sides[k] for k in np.unique(blocks.boundary.side)}
    walls = tuple(one for one in scene.boundaries.sides("fixed", "roller") if one in present)
    number = np.array([walls.index(name) if name in walls else -1 for name in sides])
    wall = number[blocks.boundary.side]
    held = np.flatnonzero(wall >= 0)
    return walls, held, wall[held]


def _columns(
    scene: RockMass, blocks: Blocks, joint_set: np.ndarray, pairs: np.ndarray, further: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the kinds of joints, and the kind of each contact [c], NO_SET for none."""
    if not scene.regions:
        sets = len(scene.joint_sets) + further
        return np.stack([np.arange(sets), *np.full((2, sets), ROCK)], axis=1), joint_set
    rows = np.column_stack([joint_set, np.sort(blocks.body.region[pairs], axis=1)])
    found = joint_set != NO_SET
    column = np.full(len(rows), NO_SET)
    kinds, own = np.unique(rows[found], axis=0, return_inverse=True)
    column[found] = own.reshape(-1)  # numpy 2.0 gave it another shape
    return kinds, column


def _of_walls(
    scene: RockMass, blocks: Blocks, held: np.ndarray, walls: tuple[str, ...], wall: np.ndarray
) -> Stiffness:
    """Return the stiffness of the rock between the centroids of blocks and their boundary facets
    `held`, on these walls: on rollers none in shear."""
    edges, block = blocks.boundary, blocks.boundary.blocks[held, 0]
    reach = ((edges.centroid[held] - blocks.centroid[block]) * edges.normal[held]).sum(axis=1)
    moduli = np.array(
        [
            (constrained_modulus(one), shear_modulus(one.intact_modulus, one.intact_poisson))
            for one in rocks_of(scene)
        ]
    )
    sticks = np.array([getattr(scene.boundaries, one) == "fixed" for one in walls], dtype=float)
    normal, shear = moduli[blocks.body.region[block]].T / reach
    return Stiffness(normal, shear * sticks[wall])
