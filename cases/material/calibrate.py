"""Calibration of a pillar: properties shared by engines and exact solutions.

Half of the compliance of a block of thickness S lies on each side of its centre: S / (2 E) of
intact rock and half a joint, 1 / (2 K_n), together S / (2 E_eq). A joint between two segments is
half a joint of each; a matched end supplies the half joint that the end block lacks. Rigid blocks,
jointed rock and the homogenised bar thus have one compliance. Two Kelvin-Voigt elements in series
act as one in slow motion, with time constants weighted by compliance.

Random joints have the thicknesses of their neighbouring blocks, and their own compliance.
"""

from math import inf
from typing import Any
from weakref import ref

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.material.jointed_rock import (
    RIGID,
    JointedRock,
    joint_time_constant,
    mean_of,
    rock_of,
)
from jointwave.cases.material.properties import Properties, strength_of
from jointwave.cases.partition.pillar import blocks_of_pillar, drawn
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.scene import Scene

__all__ = ["Properties", "calibrate"]

#: Cache of the last calibrated scene, while it lives: a run needs its properties several times.
_last: list[tuple[ref[Scene], Properties]] = []


def calibrate(scene: Scene) -> Properties:
    """Return the properties of a scene, with every joint's stiffness, damping, tension and
    strength. They are cached: do not change their arrays."""
    for known, found in _last:
        if known() is scene:
            return found
    found = _properties(scene)
    _last[:] = [(ref(scene, lambda _: _last.clear()), found)]
    return found


def _properties(scene: Scene) -> Properties:
    """Return the properties of a scene from its blocks and the rock of each segment."""
    blocks = blocks_of_pillar(scene)
    law, segment = blocks.contacts.joint_set, blocks.body.region
    y = np.concatenate([[0.0], blocks.contacts.centroid[:, 0], [scene.pillar.length]])
    rocks, weld = tuple(rock_of(scene.alone(one)) for one in scene.parts), law == NO_SET
    changed = np.flatnonzero(law > 0)
    soft = changed[np.argsort(law[changed])]
    laws = [scene.joints, *scene.layers, *[JointLaw()] * bool(weld.any())]
    return Properties(
        contact_y=y,
        segment=segment,
        parts=() if scene.is_uniform else rocks,
        soft=soft,
        weld=weld,
        tension=np.array([one.tension is not False for one in laws])[law],
        end_stress=_at_ends(scene, rocks[0]),
        **_springs(scene, rocks, segment, np.diff(y), soft),
        **vars(mean_of(rocks)),
        **vars(strength_of(laws, law)),
    )


def _at_ends(scene: Scene, rock: JointedRock) -> tuple[float, float]:
    """Return the stress that closes joints at the start and the end before any load, Pa, including
    the weight if an absorbing end alone bears it."""
    gravity, weight, (start, end) = scene.gravity, 0.0, scene.bears
    if gravity is not None and gravity.static and "fixed" not in dict(scene.ends).values():
        along = gravity.acceleration * abs(gravity.direction[1])
        weight = rock.density * along * scene.pillar.length
    return rock.prestress + start * weight, rock.prestress + end * weight


def _springs(
    scene: Scene,
    rocks: tuple[JointedRock, ...],
    segment: np.ndarray,
    thickness: np.ndarray,
    soft: np.ndarray,
) -> dict[str, Any]:
    """Return stiffness and time constants of each joint, soft layers included."""

    def of_blocks(*names: str, absent: float = 0.0) -> np.ndarray:
        values = [[getattr(one, name) for one in rocks] for name in names]
        return np.array([[absent if x is None else x for x in row] for row in values])[:, segment]

    spacing, density, eta = of_blocks("spacing", "density", "time_constant")
    thickness = thickness if scene.scatter and scene.scatter.spacing else spacing
    moduli = of_blocks("modulus", "shear_modulus")
    intact = of_blocks("intact_modulus", "intact_shear_modulus", absent=inf)
    half, half_rock = spacing * (1 / moduli - 1 / intact) / 2, thickness / intact / 2
    own, rock = _of_pairs(half) * _scattered(scene, segment), _of_pairs(half_rock)
    own_eta = _weighted(half[0], eta)
    rock_eta = _weighted(half_rock[0], eta)
    regular, ordinary_eta = 1 / (own[0] + rock[0]), _joined(own[0], own_eta, rock[0], rock_eta)
    apart, areal_mass = _of_pairs(spacing / 2), _of_pairs(density * spacing / 2)

    for j, given, layer in zip(soft, scene.soft_layers, scene.layers, strict=True):
        welded = scene.joints.normal_stiffness if own[0, j] == 0 else None
        if k := given.own_stiffness(apart[j]) or welded:
            own[0, j] = 1 / k
        compliance = own[0, j] + rock[0, j]
        if given.shear_stiffness:
            own[1, j] = 1 / given.shear_stiffness
        elif k and not scene.joints.shear_stiffness:
            own[1, j] = compliance * moduli[0, j] / moduli[1, j] - rock[1, j]
        if layer.viscosity is not None:
            own_eta[j] = layer.viscosity * own[0, j]
        elif scene.damping.rayleigh is not None or layer.damping_ratio is not None:
            of = areal_mass[j], 1 / compliance
            viscous = compliance * joint_time_constant(scene, layer.damping_ratio, *of)
            own_eta[j] = max(0.0, viscous - rock[0, j] * rock_eta[j]) / own[0, j]

    joint_eta = _joined(own[0], own_eta, rock[0], rock_eta)
    known, damped = bool(np.isfinite(intact).all()), bool(eta.any() or joint_eta.any())
    normal, shear = 1 / (own + rock)
    with np.errstate(divide="ignore"):
        own_normal, own_shear = 1 / np.maximum(own, 0.0)
    return {
        "stiffness": normal,
        "shear_stiffness": shear,
        "own_stiffness": own_normal if known else None,
        "own_shear_stiffness": own_shear if known else None,
        "joint_time_constant": joint_eta if damped else None,
        "own_time_constant": own_eta if damped else None,
        "ordinary_time_constant": ordinary_eta,
        "rock_time_constant": rock_eta,
        "regular": regular,
        "half_joint": np.clip(half, 0.0, (1 - 1 / RIGID) * spacing / moduli / 2),
        "rock_between": rock[0],
    }


def _scattered(scene: Scene, segment: np.ndarray) -> np.ndarray:
    """Return each joint's compliance over the mean [N - 1]; each segment has its random stream."""
    if scene.scatter is None or not scene.scatter.compliance:
        return np.ones(len(segment) - 1)
    counts = np.bincount(segment)
    every = [drawn(scene, i, 1, int(count)) for i, count in enumerate(counts)]
    return 1 + scene.scatter.compliance * np.concatenate(every)[:-1]


def _of_pairs(half: np.ndarray) -> np.ndarray:
    """Return the sums of neighbouring values [..., N - 1]."""
    return half[..., 1:] + half[..., :-1]


def _joined(one: np.ndarray, eta: np.ndarray, other: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Return the time constant of two Kelvin-Voigt compliances in series, s."""
    whole = one + other
    viscous = one * eta + other * beta
    return np.divide(viscous, whole, out=np.zeros_like(whole), where=whole > 0)


def _weighted(compliance: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Return the time constant of each pair of neighbours in series [N - 1], s; 0 if rigid."""
    return _joined(compliance[:-1], eta[:-1], compliance[1:], eta[1:])
