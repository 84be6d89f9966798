"""The properties of a pillar of segments, or of random joints: those of each segment, combined.

A block of thickness S has half of its compliance on either side of its centre: S / (2 E) of intact
rock and half a joint, 1 / (2 K_n), together S / (2 E_eq). A joint between two segments is half a
joint of each, so that rigid blocks, jointed rock and the homogenised bar have one compliance, and a
matched end the other half. Two Kelvin-Voigt elements in series are one for slow motion, with the
time constants weighted by the compliances.

Joints at random have their own thickness of block before and behind, and their own compliance.

The pillar as a whole is known by its mean density and compliance: the uniform one that it is for
long waves (Backus, J. Geophys. Res. 67, 1962). Only estimates and drawings use these.
"""

from math import inf, sqrt
from typing import Any

import numpy as np

from jointwave.cases.material.contacts import contacts, drawn, welds
from jointwave.cases.material.properties import Properties, of_bar
from jointwave.cases.material.strength import strength_of
from jointwave.cases.material.uniform import calibrate_uniform
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.scene import Scene


def calibrate_layered(scene: Scene) -> Properties:
    """Return the properties of a scene with segments or random joints."""
    parts = tuple(calibrate_uniform(scene.alone(one)) for one in scene.parts)
    segment = np.repeat(np.arange(len(parts)), [one.block_count for one in parts])
    whole = _as_one(scene, parts)
    return Properties(parts=parts, segment=segment, **_joints(scene, parts, segment), **whole)


def _joints(scene: Scene, parts: tuple[Properties, ...], segment: np.ndarray) -> dict[str, Any]:
    """Return what the properties have of each contact and joint."""
    y, weld, eta = contacts(scene), welds(scene), _constants(parts)[segment]
    intact = np.array([one.intact_modulus or inf for one in parts])[segment]
    half, half_rock = _half_joints(parts)[segment], np.diff(y) / (2 * intact)
    own, rock = _of_pairs(half) * _scattered(scene, segment), _of_pairs(half_rock)
    compliance = own + rock
    own_eta = _weighted(half, eta)
    joint_eta = _joined(own, own_eta, rock, _weighted(half_rock, eta))
    ordinary = {"regular": 1 / compliance, "ordinary_time_constant": joint_eta.copy()}
    spacing, areal = (
        _of_pairs(np.array(of)[segment] / 2)
        for of in ([one.spacing for one in parts], [one.block_mass / one.area for one in parts])
    )
    soft = np.array([np.abs(y[1:-1] - one.y).argmin() for one in scene.layers], dtype=np.int64)
    for j, given, layer in zip(soft, scene.soft_layers, scene.layers, strict=True):
        if k := given.own_stiffness(spacing[j]):
            own[j], compliance[j] = 1 / k, 1 / k + rock[j]
            weld[j] = False
        if scene.damping.rayleigh is not None:
            own_eta[j] = joint_eta[j] = scene.damping.rayleigh.coefficients[1]
        elif layer.damping_ratio is not None:
            own_eta[j] = joint_eta[j] = 2 * layer.damping_ratio * sqrt(areal[j] * compliance[j])
    which = np.where(weld, 1 + len(soft), 0)
    which[soft] = 1 + np.arange(len(soft))
    laws = (scene.joints, *scene.layers, JointLaw())
    tension = np.array([law.tension is not False for law in laws])[which]
    known, damped = all(one.intact_modulus for one in parts), bool(eta.any() or joint_eta.any())
    with np.errstate(divide="ignore"):
        own_stiffness = 1 / own
    shears = _shear(parts, segment, known)
    return {
        "contact_y": y,
        "rock_between": rock,
        "soft": soft,
        "weld": weld,
        **ordinary,
        "tension": tension,
        "stiffness": 1 / compliance,
        "own_stiffness": own_stiffness if known else None,
        "joint_time_constant": joint_eta if damped else None,
        "own_time_constant": own_eta if damped else None,
        **shears,
        **vars(strength_of(laws, which)),
    }


def _half_joints(parts: tuple[Properties, ...]) -> np.ndarray:
    """Return half of the compliance of each segment's joints, m/Pa: (4)."""
    whole = [one.spacing * (1 / one.modulus - 1 / (one.intact_modulus or inf)) for one in parts]
    return np.array(whole) / 2


def _scattered(scene: Scene, segment: np.ndarray) -> np.ndarray:
    """Return the compliance of each joint over its mean [N - 1]: those of a segment, with the one
    behind it, are a stream of random numbers."""
    if scene.scatter is None or not scene.scatter.compliance:
        return np.ones(len(segment) - 1)
    counts = np.bincount(segment)
    every = [drawn(scene, i, 1, int(count)) for i, count in enumerate(counts)]
    return 1 + scene.scatter.compliance * np.concatenate(every)[:-1]


def _joined(one: np.ndarray, eta: np.ndarray, other: np.ndarray, beta: np.ndarray) -> np.ndarray:
    """Return the time constant of two compliances in series, each with its own, s."""
    whole = one + other
    viscous = one * eta + other * beta
    return np.divide(viscous, whole, out=np.zeros_like(whole), where=whole > 0)


def _shear(parts: tuple[Properties, ...], segment: np.ndarray, known: bool) -> dict[str, Any]:
    """Return the stiffness of joints along them, which axial motion leaves out."""
    half = np.array([one.spacing / (2 * one.shear_modulus) for one in parts])[segment]
    shear = 1 / _of_pairs(half)
    return {"shear_stiffness": shear, "own_shear_stiffness": shear if known else None}


def _as_one(scene: Scene, parts: tuple[Properties, ...]) -> dict[str, Any]:
    """Return the numbers of the uniform pillar that the segments are for long waves."""
    length, count = scene.pillar.length, sum(one.block_count for one in parts)
    share = np.array([one.block_count * one.spacing for one in parts]) / length
    intact = [one.intact_modulus for one in parts]
    modulus, shear = (
        float(1 / (share / np.array(of)).sum())
        for of in ([one.modulus for one in parts], [one.shear_modulus for one in parts])
    )
    density = float(share @ [one.density for one in parts])
    eta, first = float(_constants(parts).max()), parts[0]
    return {
        **of_bar(density, first.side, length / count, modulus, shear),
        "block_count": count,
        "poisson": max((one.poisson for one in parts), key=abs),
        "intact_modulus": float(1 / (share / np.array(intact)).sum()) if all(intact) else None,
        "time_constant": eta or None,
        "mass_damping": first.mass_damping,
        "local_damping": first.local_damping,
    }


def _constants(parts: tuple[Properties, ...]) -> np.ndarray:
    """Return the time constant of each segment, s."""
    return np.array([one.time_constant or 0.0 for one in parts])


def _of_pairs(half: np.ndarray) -> np.ndarray:
    """Return the sum of two neighbours [N - 1]."""
    return half[1:] + half[:-1]


def _weighted(compliance: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Return the time constant of each pair of neighbours in series, 0 of rigid ones [N - 1], s."""
    return _joined(compliance[:-1], eta[:-1], compliance[1:], eta[1:])
