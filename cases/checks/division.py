"""Contradictions of how a pillar is divided: segments and random joints, layers, elements."""

from collections.abc import Iterator

from jointwave.cases.checks.rules import Wrong, within
from jointwave.cases.effects import active_effects, off_axis
from jointwave.cases.material.jointed_rock import equivalent_constants
from jointwave.cases.partition.pillar import block_ends, welds
from jointwave.cases.schema.joint import SoftLayer
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import CLOSE

#: Forces that depend on velocity or history, for which drifts backwards in time are wrong, and
#: motion that only leapfrog supports.
BEYOND = (
    "dashpots",
    "mass damping",
    "local damping",
    "softening",
    "quiet ends",
    "matched ends",
    "shaken base",
    "spatial motion",
)
#: Keys of joints that a layer meshed as rock does not take: its shear stiffness is half of K_n.
OF_JOINTS = ["shear_stiffness", "tension", "friction_angle", "cohesion"]
OF_JOINTS += [part.keys[0] for part in PARTS]


def of_scheme(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions between the scheme and the effects of the scene."""
    scheme = scene.numerics.dem.scheme
    for name in active_effects(scene) if scheme != "leapfrog" else ():
        if name in BEYOND:
            allowed = f"does not support {name}, which the scene needs; 'leapfrog' does"
            yield "numerics.dem.scheme", scheme, allowed


def of_discretisation(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions between how the rock is meshed and stepped: a file decides all that
    would describe the elements that are built."""
    numerics, key = scene.numerics.continuum, "numerics.continuum"
    if numerics.mesh is not None:
        if numerics.dim == 1:
            yield f"{key}.dim", 1, "is a bar, which takes no numerics.continuum.mesh"
        for one in ("cell", "elements_per_block", "elements_across"):
            if numerics.gives(one):
                allowed = "has no meaning with numerics.continuum.mesh"
                yield f"{key}.{one}", getattr(numerics, one), allowed
    elif numerics.cell == "simplex" and numerics.order > 2:
        yield f"{key}.order", numerics.order, "must be 1 or 2 for cell 'simplex'"
    for i, layer in enumerate(scene.soft_layers):
        yield from within(f"soft_layers[{i}]", _of_layer(layer, scene))


def _of_layer(layer: SoftLayer, scene: Scene) -> Iterator[Wrong]:
    """Yield what contradicts in a layer with a thickness, meshed as rock between shorter blocks."""
    block, thick = scene.pillar.block, layer.thickness
    if thick is None:
        return
    if thick >= block:
        yield "thickness", thick, f"must leave rock: less than pillar.block = {block:g}"
    if layer.spacing_stiffness is None and layer.normal_stiffness is None:
        yield "thickness", thick, "needs a spacing_stiffness or normal_stiffness"
    if scene.numerics.continuum.mesh is not None:
        yield "thickness", thick, "cannot be meshed with numerics.continuum.mesh"
    for key in OF_JOINTS:
        if (value := getattr(layer, key)) is not None and value is not True:
            yield key, value, "applies to joints; a layer with thickness is rock"


def of_segments(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions of the segments, and what they and random joints exclude."""
    if scene.is_uniform:
        return
    if scene.block_count < 2:
        yield "segments", None, "must leave at least 2 blocks"
    for i, one in enumerate(scene.segments):
        rock, key = one.rock(scene.rock), f"segments[{i}].intact_modulus"
        given = None if one.normal_stiffness else equivalent_constants(rock)
        if rock.intact_modulus is None and not one.joints:
            yield key, None, "is required with joints = false"
        if rock.intact_modulus and one.joints and given and rock.intact_modulus <= given[0]:
            allowed = f"must exceed the equivalent modulus {given[0]:.4g}, or give joints = false"
            yield key, rock.intact_modulus, allowed
    mesh, scheme = scene.numerics.continuum.mesh, scene.numerics.dem.scheme
    if why := off_axis(scene):
        table, count = "segments" if scene.segments else "scatter", len(scene.segments)
        yield table, count or "given", f"supports axial motion only, as pillar.joints does: {why}"
    if scene.gravity is not None and scene.gravity.acceleration:
        allowed = "is not supported with segments or scatter"
        yield "gravity.acceleration", scene.gravity.acceleration, allowed
    if mesh is not None:
        yield "numerics.continuum.mesh", mesh, "has no segments or scatter"
    if scene.motion.rotation == "none":
        allowed = "suppresses lateral strain: not with segments or scatter"
        yield "motion.rotation", "none", allowed
    if scheme != "leapfrog":
        allowed = "needs blocks of equal mass: with segments or scatter give 'leapfrog'"
        yield "numerics.dem.scheme", scheme, allowed
    inner, no_joint = block_ends(scene)[1:-1], welds(scene)
    for i, layer in enumerate(scene.soft_layers):
        if layer.thickness is not None:
            allowed = "must be a segment when there are segments or scatter"
            yield f"soft_layers[{i}].thickness", layer.thickness, allowed
        welded = no_joint[abs(inner - layer.y) <= CLOSE * scene.pillar.block].any()
        own = layer.normal_stiffness or layer.spacing_stiffness
        if welded and not (own or scene.joints.normal_stiffness):
            allowed = "needs a normal_stiffness: intact segments meet without a joint"
            yield f"soft_layers[{i}].y", layer.y, allowed
