"""Contradictions between the tables of a pillar."""

from collections.abc import Iterator

from jointwave.cases.checks.division import of_discretisation, of_scheme, of_segments
from jointwave.cases.checks.rules import (
    Wrong,
    of_damping,
    of_fracture,
    of_strength,
    within,
)
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.jointed_rock import equivalent_constants
from jointwave.cases.partition.pillar import block_ends
from jointwave.cases.plausible import INTACT, meant
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import PAIRS, check_given_once


def rules(scene: Scene) -> list[Iterator[Wrong]]:
    """Return the rules of a pillar whose tables are each right."""
    return [one(scene) for one in RULES]


def _of_layers(scene: Scene) -> Iterator[Wrong]:
    if not scene.soft_layers:
        return
    pillar, seen, joints = scene.pillar, set(), block_ends(scene)[1:-1]
    loose = scene.scatter is not None and scene.scatter.spacing > 0  # the nearest will do
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
    """Yield loads that the start does not take."""
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
    """Yield pillars whose weight no end bears, though some end holds them back."""
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
    for table, law in [*scene.laws.items(), *scene.entries("segments")]:
        yield from within(table, of_damping(law, scene))


def _of_strength(scene: Scene) -> Iterator[Wrong]:
    """Layers take what they do not give from the joints, so that these come first."""
    for table, law in zip(scene.laws, (scene.joints, *scene.layers), strict=True):
        yield from within(table, of_strength(law))


def _of_fracture(scene: Scene) -> Iterator[Wrong]:
    laws = (scene.joints, *scene.layers)
    if any(law.tensile_strength is not None for law in laws):
        p = calibrate(scene)
        stiffness = [p.regular_stiffness, *p.stiffness[p.soft]]
        for table, law, k in zip(scene.laws, laws, stiffness, strict=True):
            yield from within(table, of_fracture(law, k, "K'_n"))


RULES = (
    of_segments,
    _of_places,
    _of_layers,
    _of_receivers,
    _of_rock,
    _of_lever,
    _of_load,
    _of_support,
    _of_damping,
    _of_strength,
    _of_fracture,
    of_discretisation,
    of_scheme,
)
