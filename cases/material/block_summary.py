"""The blocks of a rock mass in numbers: how many, how large, and what lies between them."""

from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.measure import widths
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.joints import rocks_of
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.scene import blocks_of_scene, partition_bytes
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.rock_mass import REST, RockMass

#: What the sizes of blocks and of contacts are, by the number of dimensions.
SIZES = {2: ("area", "length"), 3: ("volume", "area")}


def block_summary(scene: RockMass) -> dict[str, Any]:
    """Cut a rock mass into blocks and return what they are, SI, with each region and last "rock",
    the rest; how many rigid blocks there are, and what part of the intact rock's stiffness they
    cannot have.

    Raises SceneError where the rock cannot be cut.
    """
    found = blocks_of_scene(scene)
    size, contact_size = SIZES[scene.domain.dimension]
    width, sides = widths(found.body, found.body.halves()), shape_of(scene.domain).sides
    number = np.bincount(found.boundary.side, minlength=len(sides))

    def block(one: np.intp) -> dict[str, Any]:
        about = {size: float(found.volume[one]), "width": float(width[one])}
        return about | {"centroid": found.centroid[one].tolist()}

    def of_set(index: int) -> dict[str, Any]:
        own = found.contacts.joint_set == index
        area = float(found.contacts.area[own].sum())
        return {"contacts": int(own.sum()), contact_size: area}

    facts, further = {}, further_sets(scene)
    names = [*(one.name for one in scene.regions), REST]
    for k, (name, rock) in enumerate(zip(names, rocks_of(scene), strict=True)):
        own, elastic = found.body.region % len(names) == k, elastic_rock(rock)
        facts[name] = {
            "blocks": int(own.sum()),
            size: float(found.volume[own].sum()),
            "p_speed": float(elastic.p_speed),
            "s_speed": float(elastic.s_speed),
        }
    try:
        lack = rigid_joints(scene, further).left_over
    except SceneError:  # there are no rigid blocks
        lack = None
    return {
        "blocks": found.count,
        "contacts": len(found.contacts),
        size: float(found.volume.sum()),
        "smallest": block(found.volume.argmin()),
        "largest": block(found.volume.argmax()),
        "regions": facts if scene.regions or scene.in_space else {},
        "joint_sets": {one.name: of_set(k) for k, one in enumerate(scene.joint_sets)},
        "cuts_through_rock": of_set(NO_SET),
        "boundary": {name: int(n) for name, n in zip(sides, number, strict=True) if n},
        "bytes_at_most": partition_bytes(scene),
        "bytes": found.nbytes,
        "rigid_blocks": blocks_of_scene(scene, further).count if further else found.count,
        "rigid_blocks_lack": lack,
    }
