"""All contacts of a rock mass: of blocks, across periodic sides, and with walls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.material.elastic import shear_modulus
from jointwave.cases.material.rigid_blocks import welds
from jointwave.cases.material.rock_mass import Stiffness, constrained_modulus
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.periodic import across_periodic, of_all
from jointwave.cases.partition.regions import ROCK, rocks_of
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.rock_mass import RockMass


class Links(NamedTuple):
    """Contacts [c], those of the partition first and in its order.

    blocks : i and j [c, 2]; a wall is a j beyond the last block. start, end : of the edge [c, 2],
    m. normal : from i to j [c, 2]. beside_i, beside_j : the centroids where they touch [c, 2], m.
    column : of the law [c]. kinds : of the columns of sets, `RigidJoints` [columns, 3]. others :
    stiffness of the contacts that no set has, by column after those. walls : names of the fixed
    and the roller sides.
    """

    blocks: np.ndarray
    start: np.ndarray
    end: np.ndarray
    normal: np.ndarray
    beside_i: np.ndarray
    beside_j: np.ndarray
    column: np.ndarray
    kinds: np.ndarray
    others: Stiffness
    walls: tuple[str, ...]


def links_of(scene: RockMass, partition: Partition, further: list[JointSet]) -> Links:
    """Return all contacts of a scene, some by further sets of cuts.

    A fixed side is a wall behind the rock from each block's centroid to the side, as stiff as that
    rock is: half a block. So is intact rock between blocks where no set made the cut. A roller side
    is such a wall without stiffness in shear.
    """
    across = across_periodic(scene, partition.blocks)
    parts = [partition.contacts, *(one.contacts for one in across)]
    beside = [np.zeros(2), *(one.shift for one in across)]
    shift = np.repeat(beside, [len(one) for one in parts], axis=0)
    pairs, start, end, normal, joint_set = (
        of_all(partition.blocks, across, key)
        for key in ("blocks", "start", "end", "normal", "joint_set")
    )
    walls = _walls(scene, partition)
    edges = partition.boundary
    names = [partition.sides[k] for k in edges.side]
    held = np.array([name in walls for name in names], dtype=bool)
    block = edges.blocks[held, 0]
    wall = partition.count + np.array([walls.index(n) for n in names if n in walls], dtype=int)
    centre = (edges.start[held] + edges.end[held]) / 2
    reach = ((centre - partition.centroid[block]) * edges.normal[held]).sum(axis=1)
    kinds, column = _columns(scene, partition, joint_set, pairs, len(further))
    cuts = np.flatnonzero(joint_set == NO_SET)
    column = np.concatenate([column, np.full(len(block), NO_SET)])
    column[column == NO_SET] = len(kinds) + np.arange(len(cuts) + len(block))
    sides = pairs[cuts], start[cuts], normal[cuts], shift[cuts]
    sticks = np.array([getattr(scene.boundaries, one) == "fixed" for one in walls], dtype=float)
    of_walls = _of_walls(scene, partition, block, reach)
    of_walls = of_walls._replace(shear=of_walls.shear * sticks[wall - partition.count])
    others = [welds(scene, partition, further, *sides), of_walls]
    return Links(
        blocks=np.concatenate([pairs, np.stack([block, wall], axis=1)]),
        start=np.concatenate([start, edges.start[held]]),
        end=np.concatenate([end, edges.end[held]]),
        normal=np.concatenate([normal, edges.normal[held]]),
        beside_i=np.concatenate([partition.centroid[pairs[:, 0]], partition.centroid[block]]),
        beside_j=np.concatenate([partition.centroid[pairs[:, 1]] + shift, centre]),
        column=column,
        kinds=kinds,
        others=Stiffness(*map(np.concatenate, zip(*others, strict=True))),
        walls=walls,
    )


def _walls(scene: RockMass, partition: Partition) -> tuple[str, ...]:
    """Return the fixed and the roller sides."""
    present = {partition.sides[k] for k in np.unique(partition.boundary.side)}
    return tuple(name for name in scene.boundaries.sides("fixed", "roller") if name in present)


def _columns(
    scene: RockMass, partition: Partition, joint_set: np.ndarray, pairs: np.ndarray, further: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the kinds of joints, and the kind of each contact [c], NO_SET for none."""
    if not scene.regions:
        sets = len(scene.joint_sets) + further
        return np.stack([np.arange(sets), *np.full((2, sets), ROCK)], axis=1), joint_set
    rows = np.column_stack([joint_set, np.sort(partition.region[pairs], axis=1)])
    found = joint_set != NO_SET
    column = np.full(len(rows), NO_SET)
    kinds, own = np.unique(rows[found], axis=0, return_inverse=True)
    column[found] = own.reshape(-1)  # numpy 2.0 gave it another shape
    return kinds, column


def _of_walls(
    scene: RockMass, partition: Partition, block: np.ndarray, thickness: np.ndarray
) -> Stiffness:
    """Return the stiffness of the rock of some blocks, so thick [n], m."""
    moduli = [
        (constrained_modulus(one), shear_modulus(one.intact_modulus, one.intact_poisson))
        for one in rocks_of(scene)
    ]
    return Stiffness(*(np.array(moduli)[partition.region[block]].T / thickness))
