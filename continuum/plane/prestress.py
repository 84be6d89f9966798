"""The prestress of a rock mass: whether its joints carry it, and what it may set in motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.errors import SceneError
from cases.material.strength import UNLIMITED
from continuum.plane.rock import joint_set_of, stress_of

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass
    from continuum.plane.rock import PlaneDiscrete

SLACK = 1e-9  # of the stress: tractions that are at a limit


def refuse_beyond_strength(scene: RockMass, discrete: PlaneDiscrete) -> None:
    """Raise SceneError where a joint opens or slides under the prestress: the scene would not start
    in equilibrium."""
    joints, jumps = discrete.joints, discrete.jumps
    if joints is None or jumps is None or joints.prestress is None:
        return
    law, (t_n, t_s) = joints.law, joints.prestress
    slack = SLACK * float(np.abs(joints.prestress).max())
    tensile = 0.0 if law.tensile_strength is None else law.tensile_strength
    pulled = np.zeros(t_n.shape, dtype=bool)
    if law.carries_tension is not None or law.tensile_strength is not None:
        holds = False if law.carries_tension is None else law.carries_tension
        pulled = (t_n < -slack - tensile) & ~np.broadcast_to(holds, t_n.shape)
    limit = np.full(t_n.shape, UNLIMITED)
    if law.cohesion is not None or law.friction is not None:
        friction = 0.0 if law.friction is None else law.friction
        limit = (0.0 if law.cohesion is None else law.cohesion) + friction * np.maximum(t_n, 0.0)
    for wrong, what in ((pulled, "opens"), (np.abs(t_s) > limit + slack, "slides")):
        if wrong.any():
            name = scene.joint_sets[joint_set_of(discrete)[jumps.joint[wrong.argmax()]]].name
            allowed = f"is more than joints carry: '{name}' {what} under it"
            raise SceneError(scene.where, "prestress", None, allowed)


def prestressed(scene: RockMass, discrete: PlaneDiscrete, pushing: float) -> float:
    """Return the root of twice the energy (sqrt(J/m)) that a prestress keeps in rock and joints,
    and that rock gives off by pushing on both sides of joints that open, so long (s/sqrt(kg))."""
    stress, joints = stress_of(scene), discrete.joints
    least = np.linalg.eigvalsh(discrete.materials[0].stiffness).min()
    stored = float(stress @ stress) / least * float(discrete.partition.area.sum())
    if joints is None:
        return float(np.sqrt(stored))
    size = float(np.abs(stress).max())
    softest = min(np.min(joints.law.normal_stiffness), np.min(joints.law.shear_stiffness))
    length = float(joints.area.sum())
    stored += 4 * size**2 * length / softest
    return float(np.sqrt(stored)) + pushing * 4 * size * length
