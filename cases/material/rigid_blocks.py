"""The stiffness of joints between rigid blocks, which carry the compliance of the rock as well.

Every direction of joints gets an excess compliance Z0 (1/Pa, normal and shear, not negative) that
together come nearest to the intact rock (`rigid_fit`), and a contact between blocks

    1 / K' = 1 / K + Z0 h,

h the distance of lines of its direction: never stiffer than the joint itself. A cut through intact
rock has K = inf. Of one set it is equation (6) with the modulus of confined rock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.errors import SceneError
from cases.material.effective_medium import intact
from cases.material.rigid_fit import nearest_stiffness
from cases.material.rock import elastic_rock
from cases.partition.joints import direction_of
from cases.partition.lattice import by_direction

if TYPE_CHECKING:
    from cases.schema.joint_set import JointSet
    from cases.schema.rock_mass import RockMass


class RigidJoints(NamedTuple):
    """Of each joint set and then of each set of cuts [sets]: K'_n and K'_s, Pa/m, and what of it is
    the rock's own compliance, normal and in shear [2, sets], m/Pa.

    left_over : the part of the intact rock's stiffness that rigid blocks cannot have, over all.
    """

    normal: np.ndarray
    shear: np.ndarray
    excess: np.ndarray
    left_over: float


def rigid_joints(scene: RockMass, further: list[JointSet]) -> RigidJoints:
    """Return the stiffness between rigid blocks; further : the cuts of `partition.lattice`.

    A joint that is alone among sets adds its own compliance to theirs, and nothing else. Raises
    SceneError where all joints are alone and no rock is cut.
    """
    sets = [*scene.joint_sets, *further]
    spaced = [group for group in by_direction(sets) if any(one.spacing for one in group)]
    if why := against(scene):
        raise SceneError(scene.where, "numerics.dem.block", None, why)
    normals = [direction_of(group[0].dip)[::-1] * [-1, 1] for group in spaced]
    fit = nearest_stiffness(intact(elastic_rock(scene.rock), 2), np.array(normals))
    excess, index = np.zeros((len(sets), 2)), {one.name: k for k, one in enumerate(sets)}
    for group, one in zip(spaced, fit.sets, strict=True):
        apart = _apart([index[member.name] for member in group], sets, len(scene.joint_sets))
        for k, distance in apart.items():
            excess[k] = np.array([one.normal_compliance, one.shear_compliance]) * distance
    real = [(one.normal_stiffness, one.shear_stiffness) for one in scene.joint_sets]
    own = np.array([*real, *([(np.inf, np.inf)] * len(further))], dtype=float)
    with np.errstate(divide="ignore"):
        normal, shear = (1 / (1 / own + excess)).T
    return RigidJoints(normal, shear, excess.T, fit.left_over)


def against(scene: RockMass) -> str | None:
    """Return why a scene is none of rigid blocks, None where it is one."""
    if scene.domain.given is not None:
        return "cannot make rigid blocks of the cells of domain.mesh"
    if scene.numerics.dem.block is not None or any(one.spacing for one in scene.joint_sets):
        return None
    has = "has only joints that are alone" if scene.joint_sets else "has no joints"
    return (
        f"is needed, m: rigid blocks carry waves by the joints between them, and this domain {has}"
    )


def _apart(group: list[int], sets: list[JointSet], real: int) -> dict[int, float]:
    """Return the distance of lines beside each set of one direction, m: those of a lattice hold
    the first set, or the joint, that it is made for. A joint alone without one has none."""
    cuts = [k for k in group if k >= real]
    spaced = [k for k in group if k < real and sets[k].spacing]
    lines = [*cuts, *spaced[1:]] if cuts else spaced
    distance = 1 / sum(1 / (sets[k].spacing or np.inf) for k in lines)
    return dict.fromkeys(group if cuts else spaced, distance)
