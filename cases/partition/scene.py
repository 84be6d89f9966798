"""The partition of a rock-mass scene, and what it takes, known before it is made."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from cases.errors import SceneError
from cases.partition.blocks import Partition
from cases.partition.cut import cut
from cases.partition.faults import PartitionError
from cases.partition.joints import direction_of
from cases.partition.periodic import PAIRS, periodic_contacts
from cases.size import LIMIT, memory, spoken

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cases.schema.domain import Domain
    from cases.schema.joint_set import JointSet
    from cases.schema.rock_mass import RockMass

#: Bytes of memory for each block while a domain is cut.
OF_BLOCK = 2500


def partition_of(scene: RockMass, further: Sequence[JointSet] = ()) -> Partition:
    """Return the blocks of a rock mass.

    further : sets of cuts through intact rock, beyond the scene's own sets; their contacts have
    indices beyond those of the partition's `joint_sets`.

    Raises SceneError, in one line with place and cause, where it cannot be cut into convex blocks,
    periodic sides do not fit each other, or the blocks would take more memory than a run may.
    """
    refuse_too_many(scene, further)
    try:
        found = cut(scene.domain, scene.joint_sets, further, scene.regions)
        for side in PAIRS:
            if getattr(scene.boundaries, side) == "periodic":
                periodic_contacts(found, side)  # whether its sides fit each other
        return found
    except PartitionError as error:
        raise SceneError(scene.where, error.key, None, str(error)) from None


def block_count(domain: Domain, sets: list[JointSet]) -> float:
    """Return about how many blocks a domain is cut into: one more than there are joints, and
    crossings of joints, openings left out."""
    if domain.given is not None:
        return float(domain.given.number)
    corners = np.array(domain.corners)
    size = float(np.hypot(*np.ptp(corners, axis=0)))
    x, y = corners.T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    count = 1.0
    for one in sets:
        normal = direction_of(one.dip)[::-1] * [-1, 1]
        count += float(np.ptp(corners @ normal)) / one.spacing if one.spacing else 1.0
    for one, other in combinations(sets, 2):
        (a, b), (c, d) = direction_of(one.dip), direction_of(other.dip)
        sine = abs(float(a * d - b * c))
        if one.spacing and other.spacing:
            count += area * sine / (one.spacing * other.spacing)
        else:
            count += size * sine / (one.spacing or other.spacing or size)
    return count


def partition_bytes(scene: RockMass, further: Sequence[JointSet] = ()) -> float:
    """Return what cutting a rock mass into blocks takes, bytes."""
    return OF_BLOCK * block_count(scene.domain, [*scene.joint_sets, *further])


def refuse_too_many(scene: RockMass, further: Sequence[JointSet] = ()) -> None:
    """Raise SceneError where the blocks would take more memory than a run may."""
    size, limit = partition_bytes(scene, further), memory()
    if size <= limit:
        return
    spaced = [(one.spacing, i) for i, one in enumerate(scene.joint_sets) if one.spacing]
    spacing, index = min(spaced, default=(None, 0))
    key = f"joint_sets[{index}].spacing"
    if further:
        key, spacing = "numerics.dem.block", scene.numerics.dem.block
    blocks = block_count(scene.domain, [*scene.joint_sets, *further])
    raise SceneError(
        scene.where,
        key,
        spacing,
        f"gives about {blocks:,.0f} blocks, which would take about {spoken(size)} of memory; "
        f"here are {spoken(limit)} (the environment's {LIMIT}, in GB, else the machine's)",
    )
