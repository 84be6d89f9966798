"""The blocks of a rock mass in numbers: how many, how large, and what lies between them."""

from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.measure import widths
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.regions import rocks_of
from jointwave.cases.partition.scene import (
    blocks_of_scene,
    partition_bytes,
    partition_of,
    shape_of,
)
from jointwave.cases.schema.region import REST
from jointwave.cases.schema.rock_mass import RockMass


def block_summary(scene: RockMass) -> dict[str, Any]:
    """Cut a rock mass into blocks and return what they are, SI.

    rigid_blocks_lack : the part of the intact rock's stiffness that rigid blocks cannot have; None
    where there are no rigid blocks. Raises SceneError where the rock cannot be cut.
    """
    if scene.in_space:
        return _in_space(scene)
    found, further = partition_of(scene), further_sets(scene)
    sides = np.bincount(found.boundary.side, minlength=len(found.sides))
    try:
        lack = rigid_joints(scene, further).left_over
    except SceneError:
        lack = None
    return {
        "blocks": found.count,
        "contacts": len(found.contacts),
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
    x = found.corners_of(one)
    along = np.roll(x, -1, axis=0) - x
    across = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    width = float(np.ptp(x @ across.T, axis=0).min())
    where = found.centroid[one].tolist()
    return {"area": float(found.area[one]), "width": width, "centroid": where}


def _in_space(scene: RockMass) -> dict[str, Any]:
    """Return the blocks of a scene in space, and the speeds of the waves of its intact rock."""
    found, facts = blocks_of_scene(scene), dict[str, Any]()
    width, contacts, outer = widths(found.body, found.body.halves()), found.contacts, found.boundary
    for name, one in (("smallest", found.volume.argmin()), ("largest", found.volume.argmax())):
        size = {"volume": float(found.volume[one]), "width": float(width[one])}
        facts[name] = size | {"centroid": found.centroid[one].tolist()}
    names = [*(one.name for one in scene.regions), REST]
    for k, (name, rock) in enumerate(zip(names, rocks_of(scene), strict=True)):
        own, speed = found.body.region % len(names) == k, elastic_rock(rock)
        size = {"blocks": int(own.sum()), "volume": float(found.volume[own].sum())}
        speeds = {"p_speed": float(speed.p_speed), "s_speed": float(speed.s_speed)}
        facts.setdefault("regions", {})[name] = size | speeds
    for k, name in enumerate([*(one.name for one in scene.joint_sets), "cuts through rock"]):
        own = contacts.joint_set == (k if k < len(scene.joint_sets) else NO_SET)
        size = {"contacts": int(own.sum()), "area": float(contacts.area[own].sum())}
        facts.setdefault("joint_sets", {})[name] = size
    sides = shape_of(scene.domain).sides
    number = np.bincount(outer.side, minlength=len(sides))
    return {
        "blocks": found.count,
        "contacts": len(contacts),
        "volume": float(found.volume.sum()),
        **facts,
        "boundary": {name: int(n) for name, n in zip(sides, number, strict=True) if n},
    }
