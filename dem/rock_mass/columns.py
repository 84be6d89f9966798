"""The law of the contacts of a rock mass: one column for each joint set, each set of cuts, and
every other contact."""

from __future__ import annotations

import numpy as np

from jointwave.cases.material.contact_points import CUT
from jointwave.cases.material.rigid_blocks import RigidJoints
from jointwave.cases.material.rock_mass import Stiffness, set_time_constants
from jointwave.cases.material.strength import strength_of
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.columns import Columns, Rule
from jointwave.joints.law import law, stiffest, uniform


def columns(scene: RockMass, joints: RigidJoints, others: Stiffness) -> Columns:
    """Return the law of a scene's contacts.

    joints : of the sets. others : of further contacts, in separate columns, always linear.
    """
    sets, made = scene.joint_sets, len(joints.normal)
    normal = np.concatenate([joints.normal, others.normal])
    shear = np.concatenate([joints.shear, others.shear])
    which = np.full(len(normal), len(sets))
    which[:made] = np.minimum(joints.kinds[:, 0], len(sets))
    tension = np.array([*(one.tension is not False for one in sets), True])[which]
    strengths = strength_of([*sets, JointLaw()], which).strengths()
    stiffens, rock = "maximum_closure" in strengths, None
    if stiffens:  # rock's share of the compliance, at most all but a billionth of it
        rock = np.minimum(np.resize(joints.excess[0], len(normal)), (1 - 1e-9) / normal)
        rock[which == len(sets)] = 0.0
    found = law(normal, None, tension, shear_stiffness=shear, rock_compliance=rock, **strengths)
    eta = _time_constants(scene, normal, shear, which)
    if eta is not None:
        viscosities = uniform(eta[0] * normal), uniform(eta[1] * shear)
        found = found._replace(normal_viscosity=viscosities[0], shear_viscosity=viscosities[1])
    fails = not tension.all() or bool(strengths)
    most = np.array([np.resize(one, len(normal)) for one in stiffest(found, scene)])
    return Columns(found, normal, shear, most, eta, _rules(scene, which), fails)


def _time_constants(
    scene: RockMass, normal: np.ndarray, shear: np.ndarray, which: np.ndarray
) -> np.ndarray | None:
    """Return viscosity over stiffness, normal and in shear [2, columns], s; None without any.

    A dashpot eta K of a joint within a contact of K' is one of eta K'^2 / K across the contact, to
    the first order in omega eta: rock beside the joint takes a part of its motion.
    """
    own = set_time_constants(scene)
    if own is None:
        return None
    sets, rayleigh = scene.joint_sets, scene.damping.rayleigh
    if rayleigh is not None:
        return np.full((2, len(normal)), rayleigh.coefficients[1])
    eta = np.zeros((2, len(normal)))
    for row, whole, key in zip(
        eta, (normal, shear), ("normal_stiffness", "shear_stiffness"), strict=True
    ):
        stiffness = np.array([*(getattr(one, key) for one in sets), np.inf])
        row[:] = np.append(own, 0.0)[which] * whole / stiffness[which]
    return eta


def _rules(scene: RockMass, which: np.ndarray) -> list[Rule]:
    """Return the rules of all columns, one where they are the same."""
    of_sets = [*((one.point_rule, one.contact_points) for one in scene.joint_sets), CUT]
    named: list[Rule] = [of_sets[k] for k in which]
    return named[:1] if len(set(named)) == 1 else named
