"""Scenes that the continuum can simulate, and the reasons why it refuses others."""

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.law_parts import PARTS, UNLIMITED
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.joints import resolved_joints

MODELS = ("jointed", "equivalent")
#: Keys of a joint set that the effective medium does not support.
NONLINEAR = ("friction_angle", "cohesion", "damping_ratio", *(part.keys[0] for part in PARTS))

Reasons = list[tuple[bool, str]]  #: whether each reason applies, and its text


def refuse(scene: AnyScene, model: str, dim: int | None) -> None:
    """Raise SceneError for a model or dimension that is unknown or cannot represent the scene."""
    if model not in MODELS:
        raise SceneError(scene.where, "model", model, f"must be one of {', '.join(MODELS)}")
    if dim not in (None, 1, 2, 3):
        raise SceneError(scene.where, "dim", dim, "must be 1, 2 or 3")
    if why := applies(scene, model, dim):
        raise SceneError(scene.where, "model", model, why)


def applies(scene: AnyScene, model: str = "jointed", dim: int | None = None) -> str:
    """Return "" if this model can simulate the scene, else the reason; dim : of a pillar's mesh."""
    reasons = _of_pillar(scene, model, dim) if scene.is_column else _of_rock_mass(scene, model)
    return next((why for there, why in reasons if there), "")


def _of_rock_mass(scene: RockMass, model: str) -> Reasons:
    damped = scene.rock.quality_factor is not None
    reasons = [
        (scene.damping.local is not None, "the continuum has no local damping"),
        (damped and bool(scene.waves), "[[waves]] do not support a quality_factor"),
    ]
    if model == "jointed":
        return reasons
    sets = [one for one in scene.joint_sets if one.spacing is not None]
    reasons += [
        (not sets, "no joint set has a spacing: there is nothing to homogenise"),
        (damped, "the effective medium has no quality_factor"),
    ]
    for one in sets:
        for key in NONLINEAR:
            has = getattr(one, key) is not None
            reasons.append((has, f"homogenised joints have no {key} (set '{one.name}')"))
        reasons.append((one.tension is False, f"homogenised joints do not open (set '{one.name}')"))
    return reasons


def dimension_of(scene: Scene, dim: int | None = None) -> int:
    """Return the dimension of a pillar's mesh: as given, or the least that can represent the scene.

    1 for axial motion or without rotations; 2 in the plane of x and y; else 3. Of a file, 2 or 3.
    """
    if given := dim or scene.numerics.continuum.dim:
        return given
    spatial = scene.is_spatial
    if scene.numerics.continuum.mesh is not None:
        return 2 if spatial and not _leaves_plane(scene) else 3
    if not spatial or scene.motion.rotation == "none":
        return 1
    return 3 if _leaves_plane(scene) else 2


def _leaves_plane(scene: Scene) -> bool:
    """Return whether load or gravity acts out of the plane of x and y."""
    load, gravity = scene.load, scene.gravity
    if load.arm is not None:
        return bool(load.direction[0] or load.direction[1])
    acts = bool(load.direction[2] or load.at[1])
    return acts or (gravity is not None and bool(gravity.direction[2]))


def _of_pillar(scene: Scene, model: str, dim: int | None) -> Reasons:
    p, mesh, spatial = calibrate(scene), dimension_of(scene, dim), scene.is_spatial
    rotation, damped = scene.motion.rotation, scene.rock.quality_factor is not None
    bar = "a bar does not bend or twist: needs dim 2 or 3, or motion.rotation = 'none'"
    plane = "the motion leaves the plane of x and y: needs dim 3"
    layers = any(one.thickness for one in scene.soft_layers)
    fixed = scene.ends.start == "fixed" and not scene.shakes_base
    reasons = [
        (mesh == 1 and spatial and rotation != "none", bar),
        (mesh == 2 and _leaves_plane(scene), plane),
        (spatial and rotation == "finite", "its strains and rotations are small"),
        (p.local_damping is not None, "the continuum has no local damping"),
        (damped and layers, "a soft layer with a thickness has no quality_factor"),
        (fixed and bool(scene.load.amplitude), "the load acts on a fixed face"),
    ]
    shears = spatial or mesh > 1
    if model == "jointed":
        reasons.append((not p.intact_modulus, "the jointed rock needs rock.intact_modulus"))
    else:
        reasons += _beyond_the_homogenised(scene, p, shears)
    if not shears or any(there for there, _ in reasons):
        return reasons
    joints = resolved_joints(scene, model, shears)
    stiffness = joints.shear_stiffness[joints.number]
    stiffer = "a joint stiffer than the others in shear cannot be added to the homogenised rock"
    softer = "intact rock is softer in shear than the rock mass"
    return [(not np.isfinite(stiffness).all(), softer), (bool((stiffness < 0).any()), stiffer)]


def _beyond_the_homogenised(scene: Scene, p: Properties, shears: bool) -> Reasons:
    ordinary = np.setdiff1d(np.arange(p.block_count - 1), p.soft)
    several = scene.rock.quality_factor is not None and len(p.each) > 1
    stiffer = "a joint stiffer than the others cannot be added to the homogenised bar"
    reasons = [
        (several, "homogenised segments have no common quality_factor"),
        (not p.tension[ordinary].all(), "a homogenised bar has no joints without tension"),
    ]
    if p.maximum_closure is not None:
        stiffens = p.maximum_closure < UNLIMITED
        closes = bool(stiffens[ordinary].any())
        reasons.append((closes, "a homogenised bar has no ordinary joints with closure"))
    slides = shears and p.cohesion is not None and p.cohesion < UNLIMITED
    fails = (slides | p.across() | np.zeros_like(p.tension))[ordinary].any()
    rubs = shears and p.cohesion is None and p.friction is not None
    return [
        *reasons,
        (bool((p.excess_compliance < 0).any()), stiffer),
        (bool(p.damps_alone.any()), "a homogenised bar cannot damp a single ordinary joint"),
        (bool(fails), "a homogenised bar has no joints that slide or break"),
        (rubs, "a homogenised bar has no joints that slide"),
    ]
