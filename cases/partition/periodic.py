"""Contacts across a periodic boundary: of the blocks at one side with those at the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError
from jointwave.cases.partition.blocks import BoundaryEdges, Contacts, Partition

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass

#: The sides that a periodic domain joins, and the axis across them.
PAIRS = {"left": ("right", 0), "bottom": ("top", 1)}


class Across(NamedTuple):
    """Contacts across a pair of periodic sides, of a joint set where a joint lies along both sides.
    shift : [2], m, offset of blocks j. sides : names of the pair."""

    contacts: Contacts
    shift: np.ndarray
    sides: tuple[str, str]


def across_periodic(scene: RockMass, partition: Partition) -> list[Across]:
    """Return the contacts across the periodic sides of a scene; raises GeometryError where they do
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

    Ends and normals are those at block i, in no order of i and j. Raises GeometryError where rock
    faces no rock, a joint runs along one of the sides only, or ends at one of them only.
    """
    other, axis = PAIRS[side]
    here, there = (_edges(partition, name, 1 - axis) for name in (other, side))
    low, high, i, j = _overlaps(here, there, side, partition)
    sets = np.where(here.joint_set[i] == there.joint_set[j], here.joint_set[i], NO_SET)
    place = here.start[0, axis]
    start, end = (np.full((len(i), 2), place) for _ in range(2))
    start[:, 1 - axis], end[:, 1 - axis] = (low, high) if axis == 0 else (high, low)
    joint = _is_joint(partition, here.joint_set[i]) | _is_joint(partition, there.joint_set[j])
    wrong = joint & (sets == NO_SET)
    if wrong.any():
        cause = "is periodic, but no joint of one set runs along both sides"
        raise GeometryError(start[np.argmax(wrong)], cause, f"boundaries.{side}")
    _check_ends(partition, side, (low, high), joint)
    return Contacts(
        blocks=np.stack([here.block[i], there.block[j]], axis=1),
        start=start,
        end=end,
        normal=here.normal[i],
        length=high - low,
        joint_set=sets,
    )


def _check_ends(
    partition: Partition, side: str, spans: tuple[np.ndarray, np.ndarray], joint: np.ndarray
) -> None:
    """Raise GeometryError where a joint ends at one of two periodic sides only.

    spans : from where to where along the sides the contacts across them reach, m; joint : which of
    them are joints [contacts], beside which the rock of either side may end as it likes.
    """
    other, axis = PAIRS[side]
    low, high = spans
    least = _least(partition)
    real = partition.contacts.of_joints(len(partition.joint_sets))
    ends = np.concatenate([partition.contacts.start[real], partition.contacts.end[real]])
    owner = np.tile(partition.contacts.joint_set[real], 2)
    corners = partition.corners[:, axis]
    on = [np.abs(ends[:, axis] - place) <= least for place in (corners.min(), corners.max())]
    for one, beyond, name in ((0, 1, other), (1, 0, side)):
        for at, k in zip(ends[on[one]], owner[on[one]], strict=True):
            s = at[1 - axis]
            touches = ~joint & (low - least <= s) & (s <= high + least)
            within = low.min() + least < s < high.max() - least
            partners = ends[on[beyond] & (owner == k)][:, 1 - axis]
            if touches.any() and within and not (np.abs(partners - s) <= least).any():
                cause = (
                    f"is periodic, but a joint of {partition.joint_sets[k]!r} ends there and not "
                    f"at the same place on the {name}"
                )
                raise GeometryError(at, cause, f"boundaries.{side}")


def _is_joint(partition: Partition, sets: np.ndarray) -> np.ndarray:
    """Return which indices of sets are those of joints, not of cuts through rock, bool array."""
    return (sets != NO_SET) & (sets < len(partition.joint_sets))


def _least(partition: Partition) -> float:
    """Return the length below which places along a side are one, m."""
    return 1e-9 * float(np.ptp(partition.corners, axis=0).max())


def _edges(partition: Partition, name: str, axis: int) -> BoundaryEdges:
    """Return the edges of a side, in order along an axis."""
    edges = partition.boundary
    chosen = np.flatnonzero(edges.side == partition.sides.index(name))
    middle = edges.start[chosen, axis] + edges.end[chosen, axis]
    order = chosen[np.argsort(middle, kind="stable")]
    return BoundaryEdges(**{key: array[order] for key, array in vars(edges).items()})


def _overlaps(
    here: BoundaryEdges, there: BoundaryEdges, side: str, partition: Partition
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return from where to where, m, and which edges of two sides face each other."""
    axis = 1 - PAIRS[side][1]
    lows = [np.minimum(x.start[:, axis], x.end[:, axis]) for x in (here, there)]
    ends = [np.maximum(x.start[:, axis], x.end[:, axis]) for x in (here, there)]
    if not all(map(len, lows)):
        raise GeometryError(None, "is periodic, but the domain has no such side", "boundaries")
    places = np.unique(np.concatenate([*lows, *ends]))
    wide = np.diff(places) > _least(partition)
    low, high = places[:-1][wide], places[1:][wide]
    middle = (low + high) / 2
    found = [np.searchsorted(x, middle) - 1 for x in lows]
    one, other = ((k >= 0) & (middle < x[k]) for k, x in zip(found, ends, strict=True))
    both = one & other
    if (one != other).any():
        k = np.argmax(one != other)
        at = (here if one[k] else there).start[0].copy()
        at[axis] = middle[k]
        name = side if one[k] else PAIRS[side][0]
        cause = f"is periodic, but rock there faces none on the {name}"
        raise GeometryError(at, cause, f"boundaries.{side}")
    return low[both], high[both], found[0][both], found[1][both]
