"""Contacts across a periodic boundary: of the blocks at one side with those at the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.partition.blocks import BoundaryEdges, Contacts, Partition
from cases.partition.subdivision import NO_SET, PartitionError

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

#: The sides that a periodic domain joins, and the axis across them.
PAIRS = {"left": ("right", 0), "bottom": ("top", 1)}


class Across(NamedTuple):
    """Contacts across a pair of periodic sides. shift : [2], m, offset of blocks j. sides : names
    of the pair."""

    contacts: Contacts
    shift: np.ndarray
    sides: tuple[str, str]


def across_periodic(scene: RockMass, partition: Partition) -> list[Across]:
    """Return the contacts across the periodic sides of a scene; raises PartitionError where they do
    not fit each other."""
    size = np.ptp(partition.corners, axis=0)
    return [
        Across(periodic_contacts(partition, side), size * np.eye(2)[axis], (side, other))
        for side, (other, axis) in PAIRS.items()
        if getattr(scene.boundaries, side) == "periodic"
    ]


def of_all(partition: Partition, across: list[Across], key: str) -> np.ndarray:
    """Return an array of all contacts, those across periodic sides last."""
    parts = partition.contacts, *(one.contacts for one in across)
    return np.concatenate([getattr(part, key) for part in parts])


def periodic_contacts(partition: Partition, side: str) -> Contacts:
    """Return the contacts across the left or the bottom, with the blocks beyond it moved by the
    domain's extent: block i at the right or the top, block j at the left or the bottom.

    Ends and normals are those at block i, in no order of i and j. Raises PartitionError where no
    joint lies along the sides, which would cut blocks in two, or not the same on both.
    """
    other, axis = PAIRS[side]
    here, there = (_edges(partition, name, 1 - axis) for name in (other, side))
    low, high, i, j = _overlaps(here, there, 1 - axis, partition)
    sets = here.joint_set[i]
    wrong = (sets == NO_SET) | (sets != there.joint_set[j])
    if wrong.any():
        at = here.start[i[np.argmax(wrong)]]
        cause = "is periodic, but no joint of one set runs along both sides"
        raise PartitionError(at, cause, f"boundaries.{side}")
    place = here.start[0, axis]
    start, end = (np.full((len(i), 2), place) for _ in range(2))
    start[:, 1 - axis], end[:, 1 - axis] = (low, high) if axis == 0 else (high, low)
    return Contacts(
        blocks=np.stack([here.block[i], there.block[j]], axis=1),
        start=start,
        end=end,
        normal=here.normal[i],
        length=high - low,
        joint_set=sets,
    )


def _edges(partition: Partition, name: str, axis: int) -> BoundaryEdges:
    """Return the edges of a side, in order along an axis."""
    edges = partition.boundary
    chosen = np.flatnonzero(edges.side == partition.sides.index(name))
    middle = edges.start[chosen, axis] + edges.end[chosen, axis]
    order = chosen[np.argsort(middle, kind="stable")]
    return BoundaryEdges(**{key: array[order] for key, array in vars(edges).items()})


def _overlaps(
    here: BoundaryEdges, there: BoundaryEdges, axis: int, partition: Partition
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return from where to where, m, and which edges of two sides face each other."""
    lows = [np.minimum(x.start[:, axis], x.end[:, axis]) for x in (here, there)]
    ends = [np.maximum(x.start[:, axis], x.end[:, axis]) for x in (here, there)]
    if not all(map(len, lows)):
        raise PartitionError(None, "is periodic, but the domain has no such side", "boundaries")
    places = np.unique(np.concatenate([*lows, *ends]))
    least = 1e-9 * float(np.ptp(partition.corners, axis=0).max())
    wide = np.diff(places) > least
    low, high = places[:-1][wide], places[1:][wide]
    middle = (low + high) / 2
    found = [np.searchsorted(x, middle) - 1 for x in lows]
    both = np.logical_and.reduce(
        [(k >= 0) & (middle < x[k]) for k, x in zip(found, ends, strict=True)]
    )
    return low[both], high[both], found[0][both], found[1][both]
