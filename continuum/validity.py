"""Scenes that the continuum can simulate, and the reasons why not others."""

from __future__ import annotations

import numpy as np

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.joints import resolved_joints
from jointwave.continuum.plane.validity import applies as of_rock_mass
from jointwave.continuum.space.kinematics import holds, kinematics
from jointwave.joints.shear import UNLIMITED


def applies(scene: Scene | RockMass, model: str = "jointed", dim: int | None = None) -> str:
    """Return "" if this model can simulate the scene, else the reason."""
    if not isinstance(scene, Scene):
        return of_rock_mass(scene, model)
    p, motion = calibrate(scene), kinematics(scene, dim)
    reason = holds(scene, motion.dim) or _beyond(scene, p)
    if reason:
        return reason
    if model == "jointed":
        reason = "" if p.intact_modulus else "the jointed rock needs rock.intact_modulus"
    else:
        reason = _beyond_the_homogenised(scene, p, motion.shears)
    if reason:
        return reason
    joints = resolved_joints(p, model, motion.shears)
    return _beyond_shear(joints.shear_stiffness[joints.number]) if motion.shears else ""


def _beyond_shear(stiffness: np.ndarray) -> str:
    if not np.isfinite(stiffness).all():
        return "intact rock is softer in shear than the rock mass"
    if (stiffness < 0).any():
        return "a joint stiffer than the others in shear cannot be added to the homogenised rock"
    return ""


def _beyond(scene: Scene, p: Properties) -> str:
    if p.local_damping is not None:
        return "the continuum has no local damping"
    if scene.rock.quality_factor is not None and any(one.thickness for one in scene.soft_layers):
        return "a soft layer with a thickness has no quality_factor"
    if scene.ends.start == "fixed" and not scene.shakes_base and scene.load.amplitude:
        return "the load acts on a fixed face"
    return ""


def _beyond_the_homogenised(scene: Scene, p: Properties, shears: bool) -> str:
    if scene.rock.quality_factor is not None and len(p.each) > 1:
        return "homogenised segments have no common quality_factor"
    ordinary = np.setdiff1d(np.arange(p.block_count - 1), p.soft)
    if not p.tension[ordinary].all():
        return "a homogenised bar has no joints without tension"
    if p.maximum_closure is not None:
        stiffens = p.maximum_closure < UNLIMITED
        if stiffens[ordinary].any() or (p.excess_compliance[stiffens] == 0).any():
            return "a homogenised bar has no ordinary joints with closure"
    if (p.excess_compliance < 0).any():
        return "a joint stiffer than the others cannot be added to the homogenised bar"
    if p.damps_alone.any():
        return "a homogenised bar cannot damp a single ordinary joint"
    slides = shears and p.cohesion is not None and p.cohesion < UNLIMITED
    if (slides | p.across() | np.zeros_like(p.tension))[ordinary].any():
        return "a homogenised bar has no joints that slide or break"
    if shears and p.cohesion is None and p.friction is not None:
        return "a homogenised bar has no joints that slide"
    return ""
