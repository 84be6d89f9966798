"""Numbers of a rock mass: dashpots of its joints, initial stress, strength check, block summary."""

from math import inf, radians, sqrt, tan
from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.measure import widths
from jointwave.cases.material import effective_medium
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.joints import region_at, rocks_beside, rocks_of, within
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.scene import blocks_of_scene, partition_bytes
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import REST, RockMass

#: Fractions of the height up to the top at which the overlying density is sampled.
ABOVE = (np.arange(200) + 0.5) / 200
SLACK = 1e-9  # tolerated excess over a strength, over the stress
#: Names of the sizes of blocks and contacts, by the number of dimensions.
SIZES = {2: ("area", "length"), 3: ("volume", "area")}


def set_time_constants(scene: RockMass) -> np.ndarray | None:
    """Return eta of each joint set, normal and shear, s [sets]; None without dashpots.

    The mass in c_n = 2 zeta sqrt(m k_n) is that of the rock from joint to joint: density times the
    spacing, or half of the domain's extent across a single joint. A `viscosity` is c_n itself.
    """
    sets = scene.joint_sets
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
        return np.full(len(sets), beta) if beta else None
    if not any(one.is_damped for one in sets):
        return None
    corners, found = np.array(scene.domain.corners), []
    for one in sets:
        assert one.normal_stiffness is not None
        if one.viscosity is not None:
            found.append(one.viscosity / one.normal_stiffness)
            continue
        extent = float(np.ptp(corners @ one.normal))
        mass = rocks_beside(scene, one)[0].density * (one.spacing or extent / 2)
        found.append(2 * (one.damping_ratio or 0.0) * sqrt(mass / one.normal_stiffness))
    return np.array(found)


def initial_stress(scene: RockMass, places: np.ndarray) -> np.ndarray:
    """Return the stress before any load at places [m, d], m, compression positive, Pa [m, d, d]:
    the prestress and, in a static scene, the weight of the overlying rock, confined."""
    found = np.zeros((*places.shape, places.shape[1]))
    if scene.prestress is not None:
        found += scene.prestress.tensor
    if scene.gravity is not None and scene.gravity.static:
        g, rocks = np.array(scene.gravity.direction), rocks_of(scene)
        up = ((np.array(scene.domain.corners) @ g).min() - places @ g)[:, None] * g
        density, poisson = np.array([[one.density, one.intact_poisson] for one in rocks]).T
        parts = (region_at(scene.regions, places + share * up) for share in ABOVE)
        mean = np.mean([density[part] for part in parts], axis=0)
        weight = mean * scene.gravity.acceleration * np.linalg.norm(up, axis=1)
        side = (poisson / (1 - poisson))[region_at(scene.regions, places), None, None]
        confined = side * np.eye(len(g)) + (1 - side) * np.outer(g, g)
        found += weight[:, None, None] * confined
    return found


def sets_at_rest(scene: RockMass) -> list[effective_medium.JointSet]:
    """Return the compliance of joint sets outside all regions, closed by the initial stress in the
    middle of the domain."""
    middle = np.mean(scene.domain.corners, axis=0)[None]
    sets = within(scene, scene.joint_sets)[-1].joint_sets
    return effective_medium.compliant(sets, initial_stress(scene, middle)[0])


def refuse_beyond_strength(scene: AnyScene) -> None:
    """Raise SceneError if a joint opens or slides under the prestress: the scene would not start in
    equilibrium. With weight, the static state decides that."""
    weighed = scene.gravity is not None and scene.gravity.static
    for one in scene.joint_sets if scene.prestress is not None and not weighed else ():
        if what := beyond_strength(one, scene.prestress.tensor):  # type: ignore[union-attr]
            allowed = f"exceeds the strength of a joint: '{one.name}' {what} under it"
            raise SceneError(scene.where, "prestress", None, allowed)


def beyond_strength(joint: JointSet, sigma: np.ndarray) -> str | None:
    """Return whether a joint "opens" or "slides" under a stress [d, d], Pa; None if it holds."""
    normal, traction = joint.normal, sigma @ joint.normal
    t_n, slack = float(normal @ traction), SLACK * np.abs(sigma).max()
    t_s = float(np.linalg.norm(traction - t_n * normal))
    tensile = inf if joint.tensile_strength is None else joint.tensile_strength
    if t_n < -slack - (0.0 if joint.tension is False else tensile):
        return "opens"
    if joint.friction_angle is None and joint.cohesion is None:
        return None
    limit = (joint.cohesion or 0.0) + t_n * tan(radians(joint.friction_angle or 0.0))
    return "slides" if t_s > max(limit, 0.0) + slack else None


def block_summary(scene: RockMass) -> dict[str, Any]:
    """Return a summary of a rock mass cut into blocks, in SI: sizes, contacts and boundaries, each
    region and last "rock", the number of rigid blocks, and the part of the intact rock's stiffness
    that they cannot represent. Raises SceneError if the rock cannot be cut."""
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
