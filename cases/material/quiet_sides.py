"""Impedances of the dashpots of quiet sides, for plane waves along their normals.

In each region they are those of the effective medium of all joint sets with a spacing, closed by
the stress before any load; at a pillar's ends those of its bar under the prestress. In rock without
such sets they are rho a along the normal and rho b across it.
"""

from math import isfinite
from typing import Any

import numpy as np

from jointwave.cases.geometry.measure import along_and_across
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.effective_medium import compliant, impedance, stiffness, with_joints
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.material.rock_mass import initial_stress
from jointwave.cases.partition.joints import within
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.tables import LEAN

#: Stiffness in Voigt's form (Pa) and density of each rock, and the index of the rock of places [m].
Rocks = tuple[list[tuple[np.ndarray, float]], np.ndarray]


def impedances(
    scene: Any,
    normals: np.ndarray,
    places: np.ndarray,
    region: np.ndarray,
    other: Rocks | None = None,
    more: float = 0.0,
) -> np.ndarray:
    """Return the dashpots of sides with outward normals [m, d] at places [m, d], m, in regions [m]:
    tensors [m, d, d], Pa s/m, that map the velocity of a wave along the normal to its traction.
    other : rocks instead of the scene's rock between joints. more : pressure, Pa, that closes
    joints in addition to the initial stress."""
    if (ends := _ends(scene, normals)) is not None:
        both = [(one.impedance, one.shear_impedance) for _, one, _ in ends]
        return along_and_across(normals, np.array(both).reshape(-1, 2))
    dim, scenes = normals.shape[1], within(scene, scene.joint_sets)
    if other is None:
        own = [(stiffness(elastic_rock(one.rock), [], dim), one.rock.density) for one in scenes]
        other = own, region
    rocks, which = other
    stress = np.zeros((*places.shape, dim))
    if any(one.maximum_closure for one in scene.joint_sets):
        stress = initial_stress(scene, places) + more * np.eye(dim)
    rows = np.column_stack([which, region, stress.reshape(-1, dim**2)])
    _, first, group = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    found = np.zeros((len(normals), dim, dim))
    for k, at in enumerate(first):
        there, (C, density) = group.reshape(-1) == k, rocks[which[at]]
        sets = compliant(scenes[region[at]].joint_sets, stress[at])
        found[there] = impedance(with_joints(C, sets), density, normals[there])
    return found


def borne(scene: AnyScene, normals: np.ndarray) -> np.ndarray:
    """Return whether quiet sides with outward normals [m, d] bear weight along and across their
    normal, tensors [m, d, d] with eigenvalues 1 or 0; d = 1 along a pillar.

    Sides below the rock bear both, sides beside it the normal part, as rock continues there; sides
    above it none. The ends of a pillar bear both or none.
    """
    whole, gravity = np.tile(np.eye(normals.shape[1]), (len(normals), 1, 1)), scene.gravity
    if (ends := _ends(scene, normals)) is not None:
        return whole * np.reshape([bears for *_, bears in ends], (-1, 1, 1))
    if gravity is None or not gravity.acceleration:
        return 0 * whole
    pull = np.array(gravity.direction, dtype=float)
    return along_and_across(normals, ((normals @ pull)[:, None] > (-LEAN, LEAN)).astype(float))


def half_joints(scene: AnyScene, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the half joints in front of matched sides with outward normals [m, d]: normal and
    shear stiffness [m, 2], Pa/m, 0 for other sides, and time constants [m], s."""
    stiffness, eta = np.zeros((len(normals), 2)), np.zeros(len(normals))
    for k, (kind, rock, _) in enumerate(_ends(scene, normals) or ()):
        if kind == "matched" and isfinite(rock.regular_own_stiffness):
            stiffness[k] = 2 * rock.regular_own_stiffness, 2 * rock.regular_own_shear_stiffness
            eta[k] = rock.time_constant or 0.0
    return stiffness, eta


def _ends(scene: AnyScene, normals: np.ndarray) -> list[tuple[str, JointedRock, bool]] | None:
    """Return condition and rock of a pillar's ends with outward normals [m, d], and whether they
    bear its weight; None for a rock mass."""
    if not scene.is_column:
        return None
    p, along = calibrate(scene), normals[:, min(1, normals.shape[1] - 1)]
    kinds, rocks = (scene.ends.start, scene.ends.end), (p.at_start.at_rest, p.at_end.at_rest)
    both = list(zip(kinds, rocks, scene.bears, strict=True))
    return [both[int(one > 0)] for one in along]


def base_traction(impedance: np.ndarray, direction: list[float]) -> np.ndarray:
    """Return the traction [m, d] on a compliant base per m/s of the incoming wave, Pa s/m: twice
    that of the dashpots [m, d, d], which take half of it (Mejia & Dawson, 4th FLAC Symposium,
    2006)."""
    return 2 * impedance @ np.array(direction)
