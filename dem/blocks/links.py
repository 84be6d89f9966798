"""All that touches in a rock mass: blocks, blocks across periodic sides, and walls."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.material.elastic import shear_modulus
from cases.material.rock_mass import Stiffness, centroid_distance, constrained_modulus
from cases.partition.blocks import Partition
from cases.partition.periodic import PAIRS, periodic_contacts
from cases.partition.subdivision import NO_SET

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass


class Links(NamedTuple):
    """Contacts [c], those of the partition first and in its order.

    blocks : i and j [c, 2]; a wall is a j beyond the last block. start, end : of the edge [c, 2],
    m. normal : from i to j [c, 2]. beside_i, beside_j : the centroids where they touch [c, 2], m.
    column : of the law [c]. others : stiffness of the contacts that no set has, by column after
    those of the sets. walls : names of the fixed sides.
    """

    blocks: np.ndarray
    start: np.ndarray
    end: np.ndarray
    normal: np.ndarray
    beside_i: np.ndarray
    beside_j: np.ndarray
    column: np.ndarray
    others: Stiffness
    walls: tuple[str, ...]


def links_of(scene: RockMass, partition: Partition, sets: int) -> Links:
    """Return all contacts of a scene whose columns begin with so many sets.

    A fixed side is a wall behind the rock from each block's centroid to the side, as stiff as that
    rock is: half a block. So is intact rock between blocks where no set made the cut.
    """
    parts, beside = [partition.contacts], [np.zeros(2)]
    for side, (other, axis) in PAIRS.items():
        if getattr(scene.boundaries, side) == "periodic":
            parts.append(periodic_contacts(partition, side))
            beside.append(_extent(partition, other, side, axis))
    pairs = np.concatenate([one.blocks for one in parts])
    shift = np.repeat(beside, [len(one) for one in parts], axis=0)
    start, end, normal, joint_set = (
        np.concatenate([getattr(one, key) for one in parts])
        for key in ("start", "end", "normal", "joint_set")
    )
    walls = _walls(scene, partition)
    edges = partition.boundary
    names = [partition.sides[k] for k in edges.side]
    held = np.array([name in walls for name in names], dtype=bool)
    block = edges.block[held]
    wall = partition.count + np.array([walls.index(n) for n in names if n in walls], dtype=int)
    centre = (edges.start[held] + edges.end[held]) / 2
    reach = ((centre - partition.centroid[block]) * edges.normal[held]).sum(axis=1)
    cuts = joint_set == NO_SET
    apart = np.concatenate([centroid_distance(partition)[cuts[: len(parts[0])]], reach])
    column = np.concatenate([joint_set, np.full(len(block), NO_SET)])
    column[column == NO_SET] = sets + np.arange(len(apart))
    return Links(
        blocks=np.concatenate([pairs, np.stack([block, wall], axis=1)]),
        start=np.concatenate([start, edges.start[held]]),
        end=np.concatenate([end, edges.end[held]]),
        normal=np.concatenate([normal, edges.normal[held]]),
        beside_i=np.concatenate([partition.centroid[pairs[:, 0]], partition.centroid[block]]),
        beside_j=np.concatenate([partition.centroid[pairs[:, 1]] + shift, centre]),
        column=column,
        others=_of_rock(scene, apart),
        walls=walls,
    )


def _walls(scene: RockMass, partition: Partition) -> tuple[str, ...]:
    """Return the fixed sides that there are."""
    present = {partition.sides[k] for k in np.unique(partition.boundary.side)}
    held = scene.boundaries.model_dump()
    return tuple(name for name, kind in held.items() if kind == "fixed" and name in present)


def _extent(partition: Partition, far: str, near: str, axis: int) -> np.ndarray:
    """Return the vector from one periodic side to the other, m."""
    edges, found = partition.boundary, np.zeros(2)
    places = [
        edges.start[edges.side == partition.sides.index(name), axis][0] for name in (far, near)
    ]
    found[axis] = places[0] - places[1]
    return found


def _of_rock(scene: RockMass, thickness: np.ndarray) -> Stiffness:
    """Return the stiffness of intact rock of some thickness [n], m."""
    rock = scene.rock
    shear = shear_modulus(rock.intact_modulus, rock.intact_poisson)
    return Stiffness(constrained_modulus(rock) / thickness, shear / thickness)
