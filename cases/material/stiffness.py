"""The elastic constants of the rock mass and the stiffness of every joint, equations (4) to (7)."""

from math import inf
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.elastic import (
    equivalent_modulus,
    joint_stiffness,
    modulus_from_speeds,
    rigid_block_shear_stiffness,
    rigid_block_stiffness,
    shear_modulus,
)
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import Rock


class RockMass(NamedTuple):
    """The homogenised rock mass: E_eq (Pa), Poisson's ratio, G (Pa)."""

    modulus: float
    poisson: float
    shear_modulus: float


class Stiffness(NamedTuple):
    """Float arrays [N - 1], Pa/m.

    stiffness, shear_stiffness : K'_n, K'_s between rigid blocks.
    own_stiffness, own_shear_stiffness : the joints' own K_n and K_s, (6) inverted; None without
        intact_modulus; infinite where the rock alone is as soft as rock and joint should be.
    """

    stiffness: np.ndarray
    shear_stiffness: np.ndarray
    own_stiffness: np.ndarray | None
    own_shear_stiffness: np.ndarray | None


def equivalent_constants(rock: Rock) -> tuple[float, float] | None:
    """Return Young's modulus (Pa) and Poisson's ratio that [rock] gives the rock mass; None where
    its joints do."""
    if rock.p_speed and rock.s_speed:
        return modulus_from_speeds(rock.p_speed, rock.s_speed, rock.density)
    if rock.equivalent_modulus is None or rock.equivalent_poisson is None:
        return None
    return rock.equivalent_modulus, rock.equivalent_poisson


def rock_mass(scene: Scene, spacing: float) -> RockMass:
    """Return the rock mass with joints at this spacing (m).

    A stiffness that the joints give decides the modulus that otherwise decides the stiffness.
    """
    joints, (intact, intact_shear) = scene.joints, _intact(scene.rock)
    modulus, poisson = equivalent_constants(scene.rock) or (intact, _poisson(scene.rock))
    if joints.normal_stiffness:
        modulus = equivalent_modulus(joints.normal_stiffness, intact, spacing)
    shear = shear_modulus(modulus, poisson)
    if joints.shear_stiffness:
        shear = equivalent_modulus(joints.shear_stiffness, intact_shear, spacing)
    return RockMass(modulus, poisson, shear)


def stiffness(scene: Scene, soft: np.ndarray, spacing: float, mass: RockMass) -> Stiffness:
    """Return the stiffness of all joints; `soft` are those of the soft layers."""
    (intact, intact_shear), count = _intact(scene.rock), scene.pillar.block_count - 1
    own = np.full(count, joint_stiffness(mass.modulus, intact, spacing))
    normal = np.full(count, mass.modulus / spacing)
    shear = np.full(count, mass.shear_modulus / spacing)
    for j, layer in zip(soft, scene.soft_layers, strict=True):
        given = layer.own_stiffness(spacing)
        if given:
            own[j] = given
            normal[j] = rigid_block_stiffness(given, intact, spacing)
        if layer.shear_stiffness:
            shear[j] = rigid_block_stiffness(layer.shear_stiffness, intact_shear, spacing)
        elif given and not scene.joints.shear_stiffness:
            shear[j] = rigid_block_shear_stiffness(normal[j], mass.poisson)
    if not scene.rock.intact_modulus:
        return Stiffness(normal, shear, None, None)
    with np.errstate(divide="ignore"):
        own_shear = 1 / np.maximum(1 / shear - spacing / intact_shear, 0.0)
    return Stiffness(normal, shear, own, own_shear)


def _poisson(rock: Rock) -> float:
    given = rock.equivalent_poisson
    return rock.intact_poisson if given is None else given


def _intact(rock: Rock) -> tuple[float, float]:
    """Return Young's and shear modulus of the intact rock, Pa; infinite if not given."""
    modulus = rock.intact_modulus or inf
    return modulus, shear_modulus(modulus, rock.intact_poisson)
