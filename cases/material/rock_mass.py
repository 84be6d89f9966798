"""The joints of a rock mass in numbers: stiffness, dashpots, and whether they bear a prestress."""

from math import inf, radians, sqrt, tan
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.partition.joints import rocks_beside
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import IntactRock, RockMass

SLACK = 1e-9  # of the stress: tractions that are at a limit


class Stiffness(NamedTuple):
    """Of each contact: normal and shear stiffness [c], Pa/m."""

    normal: np.ndarray
    shear: np.ndarray


def constrained_modulus(rock: IntactRock) -> float:
    """Return the P-wave modulus of intact rock, Pa."""
    poisson = rock.intact_poisson
    return rock.intact_modulus * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))


def set_time_constants(scene: RockMass) -> np.ndarray | None:
    """Return eta of each joint set of a rock mass, normal and in shear, s [sets]; None without any
    dashpot.

    The mass in c_n = 2 zeta sqrt(m k_n) is that of the rock from joint to joint: its density times
    the spacing, or half of the domain's extent across a joint that is alone.
    """
    sets = scene.joint_sets
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
        return np.full(len(sets), beta) if beta else None
    if not any(one.damping_ratio for one in sets):
        return None
    corners, found = np.array(scene.domain.corners), []
    for one in sets:
        assert one.normal_stiffness is not None
        extent = float(np.ptp(corners @ one.normal))
        mass = rocks_beside(scene, one)[0].density * (one.spacing or extent / 2)
        found.append(2 * (one.damping_ratio or 0.0) * sqrt(mass / one.normal_stiffness))
    return np.array(found)


def refuse_beyond_strength(scene: AnyScene) -> None:
    """Raise SceneError where a joint opens or slides under the prestress: the scene would not start
    in equilibrium. Under weight the static state says whether it does."""
    weighed = scene.gravity is not None and scene.gravity.static
    for one in scene.joint_sets if scene.prestress is not None and not weighed else ():
        if what := beyond_strength(one, scene.prestress.tensor):  # type: ignore[union-attr]
            allowed = f"exceeds the strength of a joint: '{one.name}' {what} under it"
            raise SceneError(scene.where, "prestress", None, allowed)


def beyond_strength(joint: JointSet, sigma: np.ndarray) -> str | None:
    """Return whether a joint "opens" or "slides" under a stress [d, d], Pa; None if it carries
    it."""
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
