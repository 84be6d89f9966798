"""Kinematics of a scene in the continuum: its dimension, components of motion, rock."""

from __future__ import annotations

from typing import NamedTuple

from jointwave.cases.effects import is_spatial
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.space.elasticity import Material, Section

MODELS = ("jointed", "equivalent")


class Kinematics(NamedTuple):
    """dim : of the mesh. section : components of motion, and what turns an integral over the mesh
    into one over the rock. plane_sections : whether all of a section moves alike."""

    dim: int
    section: Section
    plane_sections: bool

    @property
    def shears(self) -> bool:
        """Whether the motion has components along joints."""
        return self.section.components > 1


def kinematics(scene: Scene, dim: int | None = None) -> Kinematics:
    """Return how a scene moves; `dim` overrules numerics.continuum.dim."""
    dim = dim or scene.numerics.continuum.dim or least_dimension(scene)
    area, side = scene.pillar.area, scene.pillar.side
    plane_sections = scene.motion.rotation == "none" and dim > 1
    if dim == 1:
        return Kinematics(1, Section(3 if is_spatial(scene) else 1, area), False)
    return Kinematics(dim, Section(dim, side if dim == 2 else 1.0), plane_sections)


def least_dimension(scene: Scene) -> int:
    """Return the least dimension that can represent a scene.

    1 along the axis, or across it where nothing turns; 2 in the plane of x and y; else 3. A mesh of
    the user's own is in 2 or 3.
    """
    if scene.numerics.continuum.mesh is not None:
        return 3 if _leaves_plane(scene) or not is_spatial(scene) else 2
    if not is_spatial(scene) or scene.motion.rotation == "none":
        return 1
    return 3 if _leaves_plane(scene) else 2


def holds(scene: Scene, dim: int) -> str:
    """Return "" if a mesh of this dimension can represent the motion, else the reason."""
    if dim == 1 and is_spatial(scene) and scene.motion.rotation != "none":
        return "a bar does not bend or twist: needs dim 2 or 3, or motion.rotation = 'none'"
    if dim == 2 and _leaves_plane(scene):
        return "the motion leaves the plane of x and y: needs dim 3"
    if is_spatial(scene) and scene.motion.rotation == "finite":
        return "its strains and rotations are small"
    return ""


def _leaves_plane(scene: Scene) -> bool:
    """Return whether anything acts out of the plane of x and y."""
    load, gravity = scene.load, scene.gravity
    if load.arm is not None:
        return bool(load.direction[0] or load.direction[1])
    acts = bool(load.direction[2] or load.at[1])
    return acts or (gravity is not None and bool(gravity.direction[2]))


def materials(scene: Scene, p: Properties, model: str, layers: tuple[int, ...]) -> list[Material]:
    """Return the rock of each segment, intact or homogenised, and the layers that are meshed.

    A layer of thickness h is rock of modulus K_n h that does not widen when it is compressed: held
    by the rock on both sides, a thin layer can not either, and K_n is its whole stiffness.
    Rock with a quality factor has its unrelaxed modulus and no dashpots: those are of joints alone.
    """
    found, relaxes = [], mechanisms_of(scene, model)
    sections = scene.motion.rotation == "none"
    for one, part in zip(p.each, scene.parts, strict=True):
        modulus, poisson = one.modulus, one.poisson
        if model == "jointed":
            assert one.intact_modulus is not None
            modulus, poisson = one.intact_modulus, scene.alone(part).rock.intact_poisson
        eta = one.time_constant or 0.0
        if relaxes is not None:
            modulus, eta = modulus * relaxes.unrelaxed, 0.0
        found.append(Material(modulus, poisson, one.density, eta, sections))
    thickness = layer_thickness(scene, p)
    etas = p.joint_time_constant
    for joint in layers:
        k = _layer_stiffness(scene, p, joint)
        eta = 0.0 if etas is None else float(etas[joint])
        found.append(Material(k * thickness[joint], 0.0, p.density, eta))
    return found


def layer_thickness(scene: Scene, p: Properties) -> dict[int, float]:
    """Return the thickness (m) of every joint that is meshed as a layer of rock."""
    return {
        int(joint): layer.thickness
        for joint, layer in zip(p.soft, scene.soft_layers, strict=True)
        if layer.thickness is not None
    }


def _layer_stiffness(scene: Scene, p: Properties, joint: int) -> float:
    layer = scene.soft_layers[list(p.soft).index(joint)]
    stiffness = layer.own_stiffness(p.spacing)
    assert stiffness is not None
    return stiffness


def refuse(scene: Scene | RockMass, model: str, dim: int | None) -> None:
    """Raise SceneError for a model or dimension that is not there."""
    where = scene.name or scene.title
    if model not in MODELS:
        raise SceneError(where, "model", model, f"must be one of {', '.join(MODELS)}")
    if dim not in (None, 1, 2, 3):
        raise SceneError(where, "dim", dim, "must be 1, 2 or 3")


def impedances(p: JointedRock, components: int) -> list[float]:
    """Return rho c (Pa s/m) of the rock mass for every component of the motion: what absorbs.

    Along the pillar that of the bar, whose sides are free; across it that of the S wave.
    """
    across, along = p.shear_impedance, p.impedance
    return [along] if components == 1 else [across, along, across][:components]
