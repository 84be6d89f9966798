"""Contradictions between the tables of a pillar."""

from functools import partial

from pydantic_core import PydanticCustomError

from jointwave.cases.checks.numerics import check_discretisation, check_scheme
from jointwave.cases.checks.segments import check_segments
from jointwave.cases.checks.shared import (
    check_damping,
    check_fields,
    check_fracture,
    check_quality,
    check_strength,
    check_time,
    found_by,
)
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.jointed_rock import equivalent_constants
from jointwave.cases.partition.pillar import block_ends
from jointwave.cases.plausible import INTACT, meant
from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import PAIRS, check_given_once
from jointwave.cases.schema.values import contradiction


def contradictions(scene: Scene) -> list[PydanticCustomError]:
    """Return the contradictions of a scene whose tables are each right."""
    return found_by(*(partial(one, scene) for one in CHECKS))


def _check_layers(scene: Scene) -> None:
    if not scene.soft_layers:
        return
    pillar, seen, joints = scene.pillar, set(), block_ends(scene)[1:-1]
    for i, layer in enumerate(scene.soft_layers):
        joint, key = int(abs(joints - layer.y).argmin()), f"soft_layers[{i}].y"
        loose = scene.scatter is not None and scene.scatter.spacing > 0  # the nearest will do
        if abs(joints[joint] - layer.y) > 1e-6 * pillar.block and not loose:
            last = pillar.length - pillar.block
            where = f"a multiple of {pillar.block:g} from {pillar.block:g} to {last:g}"
            if scene.segments:
                where = f"the nearest is at {joints[joint]:g}"
            raise contradiction(key, layer.y, f"must be on a joint: {where}")
        if joint in seen:
            raise contradiction(key, layer.y, "has a soft layer already")
        seen.add(joint)


def _check_places(scene: Scene) -> None:
    if (places := scene.pillar.joints) is not None:
        allowed = "is for files and tables (jointwave.load): here give segments and soft_layers"
        raise contradiction("pillar.joints", places, allowed)


def _check_receivers(scene: Scene) -> None:
    record, length = scene.record, scene.pillar.length
    if not record.stress and not record.velocity:
        raise contradiction("record", None, "give at least one of record.stress and velocity")
    for key, places in (("record.stress", record.stress), ("record.velocity", record.velocity)):
        for y in places:
            if y > length:
                raise contradiction(key, y, f"must lie between 0 and {length:g} m")
        if len(set(places)) < len(places):
            raise contradiction(key, places, "must not repeat a position")


def _check_rock(scene: Scene) -> None:
    check_given_once("rock", scene.rock, "joints", scene.joints)
    intact, given = scene.rock.intact_modulus, equivalent_constants(scene.rock)
    if given and intact is not None and intact <= given[0]:
        mass = f"the rock mass's equivalent modulus {given[0]:.4g}{meant(intact, INTACT)}"
        raise contradiction("rock.intact_modulus", intact, f"must exceed {mass}")
    parts = (scene.alone(one) for one in scene.parts)
    if any(not one.joints.normal_stiffness and not equivalent_constants(one.rock) for one in parts):
        allowed = f"give exactly one pair: {PAIRS}; or joints.normal_stiffness"
        raise contradiction("rock", None, allowed)


def _check_lever(scene: Scene) -> None:
    load, half = scene.load, scene.pillar.side / 2
    if max(map(abs, load.at)) > half:
        raise contradiction("load.at", load.at, f"must lie on the face, within {half:g} m")
    if scene.motion.rotation == "none" and (load.is_eccentric or load.arm is not None):
        key, value = ("at", load.at) if load.arm is None else ("arm", load.arm)
        allowed = "rotates the blocks, which motion.rotation = 'none' excludes"
        raise contradiction(f"load.{key}", value, allowed)


def _laws(scene: Scene, layers: list) -> dict[str, JointLaw]:
    """Return the law of the joints and those of soft layers, by table."""
    return {"joints": scene.joints} | {f"soft_layers[{i}]": one for i, one in enumerate(layers)}


def _check_ends(scene: Scene) -> None:
    load, ends, gravity = scene.load, scene.ends, scene.gravity
    if load.is_motion and ends.start not in ("fixed", "quiet"):
        allowed = "is the motion of a base: needs ends.start = 'fixed' or 'quiet'"
        raise contradiction("load.quantity", load.quantity, allowed)
    enters = load.quantity == "incident-stress" and load.amplitude
    if enters and ends.start not in ("matched", "quiet"):
        allowed = (
            "is of a wave that an absorbing start lets in: needs ends.start = 'matched' or 'quiet'"
        )
        raise contradiction("load.quantity", load.quantity, allowed)
    if load.is_motion and ends.start == "quiet" and load.is_across and load.direction[1]:
        allowed = "must be along or across the axis where ends.start = 'quiet'"
        raise contradiction("load.direction", load.direction, allowed)
    if ends.start == "fixed" and not load.is_motion and load.amplitude:
        allowed = "needs load.quantity 'velocity' or 'acceleration', or no load"
        raise contradiction("ends.start", ends.start, allowed)
    if gravity is None or "fixed" in (ends.start, ends.end) or any(scene.bears):
        return
    if gravity.static:
        allowed = "needs a fixed end, a quiet or matched one below it, or gravity.static = false"
        raise contradiction("gravity.static", True, allowed)
    for key, kind in ends:
        if kind != "free" and gravity.acceleration:
            allowed = "gravity pulls the pillar off it: needs a fixed, quiet or matched end below"
            raise contradiction(f"ends.{key}", kind, allowed)


def _check_damping(scene: Scene) -> None:
    segments = {f"segments[{i}]": one for i, one in enumerate(scene.segments)}
    for table, law in (_laws(scene, scene.soft_layers) | segments).items():
        check_damping(table, law, scene)


def _check_strength(scene: Scene) -> None:
    """Layers take what they do not give from the joints, so that these come first."""
    for table, law in _laws(scene, scene.layers).items():
        check_strength(table, law)


def _check_fracture(scene: Scene) -> None:
    laws = _laws(scene, scene.layers)
    if any(law.tensile_strength is not None for law in laws.values()):
        p = calibrate(scene)
        stiffness = [p.regular_stiffness, *p.stiffness[p.soft]]
        for (table, law), k in zip(laws.items(), stiffness, strict=True):
            check_fracture(table, law, k, "K'_n")


CHECKS = (
    check_segments,
    _check_places,
    _check_layers,
    _check_receivers,
    _check_rock,
    check_quality,
    check_time,
    check_fields,
    _check_lever,
    _check_ends,
    _check_damping,
    _check_strength,
    _check_fracture,
    check_discretisation,
    check_scheme,
)
