"""Motion that the prestress of a rock mass may cause."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from continuum.plane.rock import stress_of

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass
    from continuum.plane.rock import PlaneDiscrete


def prestressed(scene: RockMass, discrete: PlaneDiscrete, pushing: float, relaxed: float) -> float:
    """Return the root of twice the energy (sqrt(J/m)) that a prestress keeps in rock and joints,
    and that rock gives off by pushing on both sides of joints that open, so long (s/sqrt(kg)).

    relaxed : what the rock keeps of its stiffness in the end.
    """
    stress, joints, of_all = stress_of(scene), discrete.joints, discrete.body.communicator
    softest = min(np.linalg.eigvalsh(one.stiffness).min() for one in discrete.materials)
    least = relaxed * softest
    stored = float(stress @ stress) / least * float(discrete.partition.area.sum())
    size, softness = float(np.abs(stress).max()), 0.0
    if joints is not None:
        law = joints.law
        softness = max(np.max(1 / law.normal_stiffness), np.max(1 / law.shear_stiffness))
    length = of_all.sum(0.0 if joints is None else float(joints.area.sum()))
    stored += 4 * size**2 * length * of_all.largest(softness)
    return float(np.sqrt(stored)) + pushing * 4 * size * length
