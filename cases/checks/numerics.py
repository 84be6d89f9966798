"""Contradictions of [numerics] of a pillar with the rest of the scene."""

from collections.abc import Iterator

from jointwave.cases.effects import active_effects
from jointwave.cases.schema.joint import SoftLayer
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.values import contradiction

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
#: Keys of joints that a layer meshed as rock does not take: its shear stiffness is half of K_n.
OF_JOINTS = ["shear_stiffness", "tension", "friction_angle", "cohesion"]
OF_JOINTS += [part.keys[0] for part in PARTS]

Wrong = tuple[str, object, str]  # key, value, what is allowed


def check_scheme(scene: Scene) -> None:
    """Raise the first contradiction between the scheme and the effects of the scene."""
    key, scheme = "numerics.dem.scheme", scene.numerics.dem.scheme
    if scheme == "leapfrog":
        return
    for name in active_effects(scene):
        if name in BEYOND:
            allowed = f"does not support {name}, which the scene needs; 'leapfrog' does"
            raise contradiction(key, scheme, allowed)


def check_discretisation(scene: Scene) -> None:
    """Raise the first contradiction between how the rock is meshed and stepped."""
    layers = {f"soft_layers[{i}]": one for i, one in enumerate(scene.soft_layers)}
    for key, value, allowed in _of_elements(scene):
        raise contradiction(f"numerics.continuum.{key}", value, allowed)
    for table, layer in layers.items():
        for key, value, allowed in _of_layer(layer, scene) if layer.thickness is not None else ():
            raise contradiction(f"{table}.{key}", value, allowed)


def _of_elements(scene: Scene) -> Iterator[Wrong]:
    """Yield what contradicts in [numerics.continuum]: a file decides all that would describe the
    elements that are built."""
    numerics = scene.numerics.continuum
    consistent = numerics.mass == "consistent"
    if consistent and numerics.scheme == "explicit":
        yield "mass", "consistent", "needs scheme 'implicit' or 'auto'"
    if numerics.mesh is not None:
        if numerics.dim == 1:
            yield "dim", 1, "is a bar, which takes no numerics.continuum.mesh"
        for key in ("cell", "elements_per_block", "elements_across"):
            if (value := getattr(numerics, key)) != type(numerics).model_fields[key].default:
                yield key, value, "has no meaning with numerics.continuum.mesh"
    elif numerics.cell == "simplex" and numerics.order > 2:
        yield "order", numerics.order, "must be 1 or 2 for cell 'simplex'"
    elif consistent and numerics.cell == "hexahedron":
        yield "mass", "consistent", "needs cell 'simplex'"


def _of_layer(layer: SoftLayer, scene: Scene) -> Iterator[Wrong]:
    """Yield what contradicts in a layer with a thickness, meshed as rock between shorter blocks."""
    block, thick = scene.pillar.block, layer.thickness
    if thick is not None and thick >= block:
        yield "thickness", thick, f"must leave rock: less than pillar.block = {block:g}"
    if layer.spacing_stiffness is None and layer.normal_stiffness is None:
        yield "thickness", thick, "needs a spacing_stiffness or normal_stiffness"
    if scene.numerics.continuum.mesh is not None:
        yield "thickness", thick, "cannot be meshed with numerics.continuum.mesh"
    for key in OF_JOINTS:
        if (value := getattr(layer, key)) is not None and value is not True:
            yield key, value, "applies to joints; a layer with thickness is rock"
