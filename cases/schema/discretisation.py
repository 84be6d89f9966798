"""Contradictions within [numerics.continuum], and with the rest of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jointwave.cases.schema.joint import PARTS
from jointwave.cases.schema.values import contradiction

if TYPE_CHECKING:
    from jointwave.cases.schema.joint import SoftLayer
    from jointwave.cases.schema.scene import Scene


#: Forces that depend on velocity or history, for which drifts backwards in time are wrong, and
#: motion that only leapfrog supports.
BEYOND = (
    "dashpots",
    "mass damping",
    "local damping",
    "constant Q",
    "softening",
    "quiet ends",
    "matched ends",
    "shaken base",
    "spatial motion",
)


def check_scheme(scene: Scene) -> None:
    """Raise the first contradiction between the scheme and the effects of the scene."""
    if scene.numerics.dem.scheme == "leapfrog":
        return
    from jointwave.cases.effects import active_effects  # it needs the Scene, which needs this check

    for name in active_effects(scene):
        if name in BEYOND:
            raise contradiction(
                "numerics.dem.scheme",
                scene.numerics.dem.scheme,
                f"does not support {name}, which the scene needs; 'leapfrog' does",
            )


#: Keys of joints that a layer meshed as rock does not take: its shear stiffness is half of K_n.
OF_JOINTS = (
    "shear_stiffness",
    "tension",
    "friction_angle",
    "cohesion",
    *(part.keys[0] for part in PARTS),
)


def check_discretisation(scene: Scene) -> None:
    """Raise the first contradiction between how the rock is meshed and stepped."""
    _check_mesh(scene)
    _check_elements(scene)
    for i, layer in enumerate(scene.soft_layers):
        if layer.thickness is not None:
            _check_layer(f"soft_layers[{i}]", layer, scene)


def _check_mesh(scene: Scene) -> None:
    """A file decides all that would describe the elements that are built."""
    numerics = scene.numerics.continuum
    if numerics.mesh is None:
        return
    if numerics.dim == 1:
        raise contradiction(
            "numerics.continuum.dim", 1, "is a bar, which takes no numerics.continuum.mesh"
        )
    for key in ("cell", "elements_per_block", "elements_across"):
        if key in numerics.model_fields_set:
            raise contradiction(
                f"numerics.continuum.{key}",
                getattr(numerics, key),
                "has no meaning with numerics.continuum.mesh",
            )


def _check_elements(scene: Scene) -> None:
    numerics = scene.numerics.continuum
    if numerics.mass == "consistent" and numerics.scheme == "explicit":
        raise contradiction(
            "numerics.continuum.mass", "consistent", "needs scheme 'implicit' or 'auto'"
        )
    if numerics.mesh is not None:
        return
    if numerics.cell == "simplex" and numerics.order > 2:
        raise contradiction(
            "numerics.continuum.order", numerics.order, "must be 1 or 2 for cell 'simplex'"
        )
    if numerics.mass == "consistent" and numerics.cell == "hexahedron":
        raise contradiction("numerics.continuum.mass", "consistent", "needs cell 'simplex'")


def _check_layer(table: str, layer: SoftLayer, scene: Scene) -> None:
    """A layer with a thickness is meshed as rock between shorter blocks."""
    key, block = f"{table}.thickness", scene.pillar.block
    assert layer.thickness is not None
    if layer.thickness >= block:
        raise contradiction(
            key, layer.thickness, f"must leave rock: less than pillar.block = {block:g}"
        )
    if layer.spacing_stiffness is None and layer.normal_stiffness is None:
        raise contradiction(key, layer.thickness, "needs a spacing_stiffness or normal_stiffness")
    if scene.numerics.continuum.mesh is not None:
        raise contradiction(key, layer.thickness, "cannot be meshed with numerics.continuum.mesh")
    for other in OF_JOINTS:
        value = getattr(layer, other)
        if value is not None and value is not True:
            raise contradiction(
                f"{table}.{other}",
                value,
                "applies to joints; a layer with thickness is rock",
            )
