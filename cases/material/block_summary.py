"""The blocks of a rock mass in numbers: how many, how large, and what lies between them."""

from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.regions import rocks_of
from jointwave.cases.partition.scene import partition_bytes, partition_of
from jointwave.cases.schema.region import REST
from jointwave.cases.schema.rock_mass import RockMass


def block_summary(scene: RockMass) -> dict[str, Any]:
    """Cut a rock mass into blocks and return what they are, SI.

    rigid_blocks_lack : the part of the intact rock's stiffness that rigid blocks cannot have; None
    where there are no rigid blocks. Raises SceneError where the rock cannot be cut.
    """
    found, further = partition_of(scene), further_sets(scene)
    sides = np.bincount(found.boundary.side, minlength=len(found.sides))
    try:
        lack = rigid_joints(scene, further).left_over
    except SceneError:
        lack = None
    return {
        "blocks": found.count,
        "rigid_blocks": partition_of(scene, further).count if further else found.count,
        "area": float(found.area.sum()),
        "smallest": _block(found, int(np.argmin(found.area))),
        "largest": _block(found, int(np.argmax(found.area))),
        "regions": _regions(scene, found) if scene.regions else {},
        "joint_sets": {name: _of_set(found, k) for k, name in enumerate(found.joint_sets)},
        "cuts_through_rock": _of_set(found, NO_SET),
        "boundary": {name: int(n) for name, n in zip(found.sides, sides, strict=True) if n},
        "bytes": found.nbytes,
        "bytes_at_most": partition_bytes(scene),
        "rigid_blocks_lack": lack,
    }


def _regions(scene: RockMass, found: Partition) -> dict[str, Any]:
    """Return what each region is, with what is left as "rock"."""
    facts, names = {}, [*(one.name for one in scene.regions), REST]
    for k, (name, rock) in enumerate(zip(names, rocks_of(scene), strict=True)):
        own, elastic = found.region % len(names) == k, elastic_rock(rock)
        size = {"blocks": int(own.sum()), "area": float(found.area[own].sum())}
        facts[name] = size | {"p_speed": float(elastic.p_speed), "s_speed": float(elastic.s_speed)}
    return facts


def _of_set(found: Partition, index: int) -> dict[str, Any]:
    own = found.contacts.joint_set == index
    return {"contacts": int(own.sum()), "length": float(found.contacts.length[own].sum())}


def _block(found: Partition, one: int) -> dict[str, Any]:
    return {"area": float(found.area[one]), "centroid": found.centroid[one].tolist()}
