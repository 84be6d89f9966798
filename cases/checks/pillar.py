"""Contradictions between the tables of a pillar."""

from collections.abc import Iterator

from jointwave.cases.checks.rules import Wrong, of_damping, of_fracture, of_strength, within
from jointwave.cases.effects import active_effects
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.jointed_rock import equivalent_constants
from jointwave.cases.partition.pillar import block_ends, welds
from jointwave.cases.plausible import INTACT, meant
from jointwave.cases.schema.joint import SoftLayer
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import CLOSE
from jointwave.cases.schema.tables import PAIRS, check_given_once

#: Forces that depend on velocity or history, which exclude the backward drifts of PEFRL, and motion
#: that only leapfrog supports.
BEYOND = (
    *("dashpots", "mass damping", "local damping", "softening"),
    *("quiet ends", "matched ends", "shaken base", "spatial motion"),
)
#: Joint keys that a layer meshed as rock cannot have: its shear stiffness is half of K_n.
OF_JOINTS = ["shear_stiffness", "tension", "friction_angle", "cohesion"]
OF_JOINTS += [part.keys[0] for part in PARTS]


def rules(scene: Scene) -> list[Iterator[Wrong]]:
    """Return the rules for a pillar whose tables are each valid."""
    every = (
        *(_of_segments, _of_places, _of_layers, _of_receivers, _of_rock, _of_lever, _of_load),
        *(_of_support, _of_damping, _of_strength, _of_fracture, _of_discretisation, _of_scheme),
    )
    return [rule(scene) for rule in every]


def _of_layers(scene: Scene) -> Iterator[Wrong]:
    if not scene.soft_layers:
        return
    pillar, seen, joints = scene.pillar, set(), block_ends(scene)[1:-1]
    loose = scene.scatter is not None and scene.scatter.spacing > 0  # take the nearest joint
    for i, layer in enumerate(scene.soft_layers):
        joint, key = int(abs(joints - layer.y).argmin()), f"soft_layers[{i}].y"
        if abs(joints[joint] - layer.y) > 1e-6 * pillar.block and not loose:
            last = pillar.length - pillar.block
            where = f"a multiple of {pillar.block:g} from {pillar.block:g} to {last:g}"
            if scene.segments:
                where = f"the nearest is at {joints[joint]:g}"
            yield key, layer.y, f"must be on a joint: {where}"
        if joint in seen:
            yield key, layer.y, "has a soft layer already"
        seen.add(joint)


def _of_places(scene: Scene) -> Iterator[Wrong]:
    if (places := scene.pillar.joints) is not None:
        allowed = "is for files and tables (jointwave.load): here give segments and soft_layers"
        yield "pillar.joints", places, allowed


def _of_receivers(scene: Scene) -> Iterator[Wrong]:
    record, length = scene.record, scene.pillar.length
    if not record.stress and not record.velocity:
        yield "record", None, "give at least one of record.stress and velocity"
    for key, places in (("record.stress", record.stress), ("record.velocity", record.velocity)):
        for y in places:
            if y > length:
                yield key, y, f"must lie between 0 and {length:g} m"
        if len(set(places)) < len(places):
            yield key, places, "must not repeat a position"


def _of_rock(scene: Scene) -> Iterator[Wrong]:
    check_given_once("rock", scene.rock, "joints", scene.joints)
    intact, given = scene.rock.intact_modulus, equivalent_constants(scene.rock)
    if given and intact is not None and intact <= given[0]:
        mass = f"the rock mass's equivalent modulus {given[0]:.4g}{meant(intact, INTACT)}"
        yield "rock.intact_modulus", intact, f"must exceed {mass}"
    parts = (scene.alone(one) for one in scene.parts)
    if any(not one.joints.normal_stiffness and not equivalent_constants(one.rock) for one in parts):
        yield "rock", None, f"give exactly one pair: {PAIRS}; or joints.normal_stiffness"


def _of_lever(scene: Scene) -> Iterator[Wrong]:
    load, half = scene.load, scene.pillar.side / 2
    if max(map(abs, load.at)) > half:
        yield "load.at", load.at, f"must lie on the face, within {half:g} m"
    if scene.motion.rotation == "none" and (load.is_eccentric or load.arm is not None):
        key, value = ("at", load.at) if load.arm is None else ("arm", load.arm)
        allowed = "rotates the blocks, which motion.rotation = 'none' excludes"
        yield f"load.{key}", value, allowed


def _of_load(scene: Scene) -> Iterator[Wrong]:
    """Yield loads that contradict the start's boundary condition."""
    load, start = scene.load, scene.ends.start
    if load.is_motion and start not in ("fixed", "quiet"):
        allowed = "is the motion of a base: needs ends.start = 'fixed' or 'quiet'"
        yield "load.quantity", load.quantity, allowed
    enters = load.quantity == "incident-stress" and load.amplitude
    if enters and start not in ("matched", "quiet"):
        allowed = (
            "is of a wave that an absorbing start lets in: needs ends.start = 'matched' or 'quiet'"
        )
        yield "load.quantity", load.quantity, allowed
    if load.is_motion and start == "quiet" and load.is_across and load.direction[1]:
        allowed = "must be along or across the axis where ends.start = 'quiet'"
        yield "load.direction", load.direction, allowed
    if start == "fixed" and not load.is_motion and load.amplitude:
        allowed = "needs load.quantity 'velocity' or 'acceleration', or no load"
        yield "ends.start", start, allowed


def _of_support(scene: Scene) -> Iterator[Wrong]:
    """Yield pillars whose weight no end bears, though some end holds them."""
    gravity, ends = scene.gravity, scene.ends
    if gravity is None or "fixed" in (ends.start, ends.end) or any(scene.bears):
        return
    if gravity.static:
        allowed = "needs a fixed end, a quiet or matched one below it, or gravity.static = false"
        yield "gravity.static", True, allowed
    for key, kind in ends:
        if kind != "free" and gravity.acceleration:
            allowed = "gravity pulls the pillar off it: needs a fixed, quiet or matched end below"
            yield f"ends.{key}", kind, allowed


def _of_damping(scene: Scene) -> Iterator[Wrong]:
    cut = any(part.segment is None or scene.segments[part.segment].joints for part in scene.parts)
    if cut and scene.joints.viscosity is not None:
        allowed = "is of single joints: give it in [[soft_layers]], or pillar.joints"
        yield "joints.viscosity", scene.joints.viscosity, allowed
    for table, law in [*scene.laws.items(), *scene.entries("segments")]:
        yield from within(table, of_damping(law, scene))


def _of_strength(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions of joint laws, and a tensile prestress beyond a joint's strength unless
    the weight may close it. [joints] come first, since layers inherit from them."""
    presses = scene.gravity is not None and scene.gravity.static
    pull = 0.0 if scene.prestress is None or presses else -scene.prestress.normal
    for table, law in zip(scene.laws, (scene.joints, *scene.layers), strict=True):
        yield from within(table, of_strength(law))
        most = 0.0 if law.tension is False else law.tensile_strength
        if most is not None and pull > most:
            allowed = f"is a tension of which joints as in {table} carry at most {most:g} Pa"
            yield "prestress.normal", -pull, allowed


def _of_fracture(scene: Scene) -> Iterator[Wrong]:
    laws = (scene.joints, *scene.layers)
    if any(law.tensile_strength is not None for law in laws):
        p = calibrate(scene)
        stiffness = [p.regular_stiffness, *p.stiffness[p.soft]]
        for table, law, k in zip(scene.laws, laws, stiffness, strict=True):
            yield from within(table, of_fracture(law, k, "K'_n"))


def _of_scheme(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions between the scheme and the effects of the scene."""
    scheme = scene.numerics.dem.scheme
    for name in active_effects(scene) if scheme != "leapfrog" else ():
        if name in BEYOND:
            allowed = f"does not support {name}, which the scene needs; 'leapfrog' does"
            yield "numerics.dem.scheme", scheme, allowed


def _of_discretisation(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions of mesh and elements: a mesh file excludes keys of built elements."""
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
        yield from within(f"soft_layers[{i}]", _of_thickness(layer, scene))


def _of_thickness(layer: SoftLayer, scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions of a layer with a thickness, which is meshed as rock."""
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


def _of_segments(scene: Scene) -> Iterator[Wrong]:
    """Yield contradictions of segments and scatter, and keys that these exclude."""
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
    if why := scene.off_axis:
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
