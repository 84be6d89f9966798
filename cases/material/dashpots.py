"""The time constant of every joint's dashpot, from damping ratios or Rayleigh's beta."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass
    from jointwave.cases.schema.scene import Scene


class Dashpots(NamedTuple):
    """Time constants eta = viscosity / stiffness, s.

    time_constant : of the rock and its ordinary joints; None without dashpots.
    joint_time_constant : float array [N - 1], of each joint; None without any dashpot.
    """

    time_constant: float | None
    joint_time_constant: np.ndarray | None


def dashpots(scene: Scene, soft: np.ndarray, regular: float, stiffness: np.ndarray) -> Dashpots:
    """Return the dashpots of all joints.

    A damping ratio zeta gives c_n = 2 zeta sqrt(m k_n), hence eta = 2 zeta sqrt(m / k_n), with m
    the block's mass; Rayleigh's beta is the eta of all.

    Parameters
    ----------
    soft : int array, the joints of the soft layers. regular : K'_n of an ordinary joint, Pa/m.
    stiffness : float array [N - 1], K'_n, Pa/m.
    """
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
        return Dashpots(beta, np.full(len(stiffness), beta)) if beta else Dashpots(None, None)
    areal_mass = scene.rock.density * scene.pillar.length / scene.pillar.block_count
    ratios = [scene.joints.damping_ratio, *(layer.damping_ratio for layer in scene.layers)]
    if all(ratio is None for ratio in ratios):
        return Dashpots(None, None)

    def eta(ratio: float | None, k: float) -> float:
        return 2 * (ratio or 0.0) * sqrt(areal_mass / k)

    etas = np.full(len(stiffness), eta(ratios[0], regular))
    for j, ratio in zip(soft, ratios[1:], strict=True):
        etas[j] = eta(ratio, stiffness[j])
    return Dashpots(None if ratios[0] is None else eta(ratios[0], regular), etas)


def set_time_constants(scene: RockMass) -> np.ndarray | None:
    """Return eta of each joint set of a rock mass, normal and in shear, s [sets]; None without any
    dashpot.

    The mass in c_n = 2 zeta sqrt(m k_n) is that of the rock from joint to joint: its density times
    the spacing, or half of the domain's extent across a joint that is alone.
    """
    from jointwave.cases.partition.joints import direction_of
    from jointwave.cases.partition.regions import rocks_beside

    sets = scene.joint_sets
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
        return np.full(len(sets), beta) if beta else None
    if not any(one.damping_ratio for one in sets):
        return None
    corners = np.array(scene.domain.corners)

    def eta(ratio: float, dip: float, spacing: float | None, k: float, density: float) -> float:
        normal = direction_of(dip)[::-1] * [-1, 1]
        apart = spacing or float(np.ptp(corners @ normal)) / 2
        return 2 * ratio * sqrt(density * apart / k)

    return np.array(
        [
            eta(
                s.damping_ratio or 0.0,
                s.dip,
                s.spacing,
                s.normal_stiffness or 0.0,
                rocks_beside(scene, s)[0].density,
            )
            for s in sets
        ]
    )
