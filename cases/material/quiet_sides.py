"""Impedances of the dashpots of quiet sides: rho a and rho b of the waves along their normals.

The speeds are, region by region, those of the intact rock where `numerics.dem.block` cuts it, since
a lattice has them at its sides, else those of the effective medium of the joint sets.
"""

from math import isfinite

import numpy as np

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.effective_medium import compliant, speeds, stiffness
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.joints import within
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.tables import LEAN


def impedances(scene: RockMass, normals: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Return rho a and rho b of the dashpots of sides of outward normals [m, d], of rock in these
    regions [m]: [m, 2], Pa s/m; as rigid blocks have them."""
    smeared = scene.numerics.dem.block is None
    return medium_impedances(scene, normals, region, smeared)


def borne(scene: AnyScene, normals: np.ndarray) -> np.ndarray:
    """Return whether quiet sides of outward normals [m, d] bear what gravity puts on them along
    their normal and along themselves, 1 or 0 [m, 2]; d = 1 along a pillar.

    Both below the rock, the first beside it: there is rock beyond, too. None above it. The ends of
    a pillar bear both or none.
    """
    gravity = scene.gravity
    if gravity is None or not gravity.acceleration:
        return np.zeros((len(normals), 2))
    pull = np.array(gravity.direction, dtype=float)
    lean = normals @ (pull[1:2] if normals.shape[1] == 1 else pull[: normals.shape[1]])
    least = -LEAN, -LEAN if scene.is_column else LEAN
    return (lean[:, None] > least).astype(float)


def half_joints(scene: AnyScene, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the half joints in front of matched sides of outward normals [m, d]: normal and shear
    stiffness [m, 2], Pa/m, 0 of other sides, and time constants [m], s."""
    stiffness, eta = np.zeros((len(normals), 2)), np.zeros(len(normals))
    for k, (kind, rock) in enumerate(_ends(scene, normals)):
        if kind == "matched" and isfinite(rock.regular_own_stiffness):
            stiffness[k] = 2 * rock.regular_own_stiffness, 2 * rock.regular_own_shear_stiffness
            eta[k] = rock.time_constant or 0.0
    return stiffness, eta


def _ends(scene: AnyScene, normals: np.ndarray) -> list[tuple[str, JointedRock]]:
    """Return condition and rock of a pillar's ends of outward normals [m, d]; none of others."""
    if not scene.is_column:
        return []
    p, along = calibrate(scene), normals[:, min(1, normals.shape[1] - 1)]
    start, end = (scene.ends.start, p.at_start), (scene.ends.end, p.at_end)
    return [start if one < 0 else end for one in along]


def medium_impedances(
    scene: AnyScene, normals: np.ndarray, region: np.ndarray, smeared: bool = True
) -> np.ndarray:
    """Return the same of the effective medium of all sets that have a spacing, in space rho b of
    the mean of both S speeds, and of a pillar's bar; smeared : whether there is one, else of the
    intact rock."""
    if scene.is_column:
        ends = [(one.impedance, one.shear_impedance) for _, one in _ends(scene, normals)]
        return np.array(ends).reshape(-1, 2)
    found, scenes = np.zeros((len(normals), 2)), within(scene, scene.joint_sets)
    for own in np.unique(region):
        there = region == own
        found[there] = _of_one_rock(scenes[own], normals[there], smeared)
    return found


def _of_one_rock(scene: RockMass, normals: np.ndarray, smeared: bool) -> np.ndarray:
    rock, density, dim = elastic_rock(scene.rock), scene.rock.density, normals.shape[1]
    sets = compliant(scene.joint_sets, dim)
    if not smeared or not sets or not len(normals):
        return np.tile([rock.p_impedance, rock.s_impedance], (len(normals), 1))
    found, shapes = speeds(stiffness(rock, sets, dim), density, normals)
    longitudinal = np.abs((shapes * normals[:, :, None]).sum(axis=1)).argmax(axis=1)
    p = np.arange(dim) == longitudinal[:, None]
    s = found[~p].reshape(len(normals), dim - 1).mean(axis=1)
    return density * np.stack([found[p], s], axis=1)


def base_traction(normals: np.ndarray, impedance: np.ndarray, direction: list[float]) -> np.ndarray:
    """Return the tractions [m, d] on a compliant base for each m/s that comes up, Pa s/m.

    2 rho a of its normal component and 2 rho b of the other: the dashpots take half of them, and
    the other half enters (Mejia & Dawson, 4th FLAC Symposium, 2006). normals : [m, d]. impedance :
    [m, 2].
    """
    moved = np.array(direction)
    along = (normals @ moved)[:, None] * normals
    return 2 * (impedance[:, :1] * along + impedance[:, 1:] * (moved - along))
