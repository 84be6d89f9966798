"""Contradictions between the tables of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from jointwave.cases.schema.discretisation import check_discretisation, check_scheme
from jointwave.cases.schema.joint import ACROSS, JointLaw
from jointwave.cases.schema.plausible import INTACT, meant
from jointwave.cases.schema.segment import Segment, alone, check_segments, regions
from jointwave.cases.schema.shared_checks import (
    SNAP,
    check_fields,
    check_quality,
    check_strength,
    check_time,
    rounded_up,
)
from jointwave.cases.schema.tables import PAIRS, check_given_once
from jointwave.cases.schema.values import check_all, contradiction, is_extreme

if TYPE_CHECKING:
    from jointwave.cases.schema.scene import Scene


def check(scene: Scene) -> None:
    """Raise the contradictions of a scene whose tables are each right."""
    check_all(*(partial(one, scene) for one in CHECKS))


def _check_layers(scene: Scene) -> None:
    if not scene.soft_layers:
        return
    from jointwave.cases.material.contacts import contacts

    pillar, seen, joints = scene.pillar, set(), contacts(scene)[1:-1]
    for i, layer in enumerate(scene.soft_layers):
        joint = int(abs(joints - layer.y).argmin())
        loose = scene.scatter is not None and scene.scatter.spacing > 0  # the nearest will do
        if abs(joints[joint] - layer.y) > 1e-6 * pillar.block and not loose:
            last = pillar.length - pillar.block
            where = (
                f"a multiple of {pillar.block:g} from {pillar.block:g} to {last:g}"
                if not scene.segments
                else f"the nearest is at {joints[joint]:g}"
            )
            raise contradiction(f"soft_layers[{i}].y", layer.y, f"must be on a joint: {where}")
        if joint in seen:
            raise contradiction(f"soft_layers[{i}].y", layer.y, "has a soft layer already")
        seen.add(joint)


def _check_receivers(scene: Scene) -> None:
    if not scene.record.stress and not scene.record.velocity:
        raise contradiction("record", None, "give at least one of record.stress and velocity")
    for key in ("stress", "velocity"):
        places = getattr(scene.record, key)
        for y in places:
            if y > scene.pillar.length:
                raise contradiction(
                    f"record.{key}", y, f"must lie between 0 and {scene.pillar.length:g} m"
                )
        if len(set(places)) < len(places):
            raise contradiction(f"record.{key}", places, "must not repeat a position")


def _check_rock(scene: Scene) -> None:
    from jointwave.cases.material.stiffness import equivalent_constants

    check_given_once("rock", scene.rock, "joints", scene.joints)
    intact, given = scene.rock.intact_modulus, equivalent_constants(scene.rock)
    if given and intact is not None and intact <= given[0]:
        raise contradiction(
            "rock.intact_modulus",
            intact,
            f"must exceed the rock mass's equivalent modulus {given[0]:.4g}{meant(intact, INTACT)}",
        )
    parts = (alone(scene, one) for one in regions(scene))
    if any(not one.joints.normal_stiffness and not equivalent_constants(one.rock) for one in parts):
        raise contradiction(
            "rock", None, f"give exactly one pair: {PAIRS}; or joints.normal_stiffness"
        )


def _check_lever(scene: Scene) -> None:
    load, half = scene.load, scene.pillar.side / 2
    if max(map(abs, load.at)) > half:
        raise contradiction("load.at", load.at, f"must lie on the face, within {half:g} m")
    if scene.motion.rotation == "none" and (load.is_eccentric or load.arm is not None):
        key, value = ("at", load.at) if load.arm is None else ("arm", load.arm)
        raise contradiction(
            f"load.{key}", value, "rotates the blocks, which motion.rotation = 'none' excludes"
        )


def _check_extreme(scene: Scene) -> None:
    """An extreme load is scaled, so that its effects must be linear."""
    if not is_extreme(scene.load.amplitude):
        return
    for key, value, wrong in _beyond_scaling(scene):
        if wrong:
            allowed = "does not scale: needs a load.amplitude of magnitude 1e-30 to 1e30"
            raise contradiction(key, value, allowed)
    if scene.record.energy and not 1e-150 <= abs(scene.load.amplitude) <= 1e150:
        allowed = "must be false: energies overflow with such a load.amplitude"
        raise contradiction("record.energy", True, allowed)


def _beyond_scaling(scene: Scene) -> Iterator[tuple[str, object, bool]]:
    """Yield the keys that an extreme load excludes: key, value, and whether it is present."""
    load, record = scene.load, scene.record
    yield "gravity", None, scene.gravity is not None
    yield "prestress", None, scene.prestress is not None
    yield "record.fields", record.fields, record.fields is not None
    yield "load.direction", load.direction, load.is_across
    yield "load.at", load.at, load.is_eccentric
    yield "load.arm", load.arm, load.arm is not None
    yield "load.file", load.file, load.file is not None
    laws: dict[str, JointLaw] = {"joints": scene.joints}
    laws |= {f"soft_layers[{i}]": layer for i, layer in enumerate(scene.soft_layers)}
    for table, law in laws.items():
        for key in ("cohesion", *ACROSS):
            yield f"{table}.{key}", getattr(law, key), getattr(law, key) is not None


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
        raise contradiction(
            "ends.start", ends.start, "needs load.quantity 'velocity' or 'acceleration', or no load"
        )
    if gravity is None or "fixed" in (ends.start, ends.end) or any(scene.bears):
        return
    if gravity.static:
        allowed = "needs a fixed end, a quiet or matched one below it, or gravity.static = false"
        raise contradiction("gravity.static", True, allowed)
    for key, kind in ends.model_dump().items():
        if kind != "free" and gravity.acceleration:
            allowed = "gravity pulls the pillar off it: needs a fixed, quiet or matched end below"
            raise contradiction(f"ends.{key}", kind, allowed)


def _check_damping(scene: Scene) -> None:
    if scene.damping.rayleigh is None:
        return
    named: dict[str, JointLaw | Segment] = {"joints": scene.joints}
    named |= {f"soft_layers[{i}]": layer for i, layer in enumerate(scene.soft_layers)}
    named |= {f"segments[{i}]": segment for i, segment in enumerate(scene.segments)}
    for table, law in named.items():
        if law.damping_ratio is not None:
            raise contradiction(
                f"{table}.damping_ratio",
                law.damping_ratio,
                "damping.rayleigh already sets the dashpots: give one of them",
            )


def _check_strength(scene: Scene) -> None:
    """Layers take what they do not give from the joints, so that these come first."""
    check_strength("joints", scene.joints)
    for i, layer in enumerate(scene.layers):
        check_strength(f"soft_layers[{i}]", layer)


def _check_fracture(scene: Scene) -> None:
    """A joint whose stress falls faster than it can unload would snap back."""
    laws = [scene.joints, *scene.layers]
    if all(law.tensile_strength is None for law in laws):
        return
    from jointwave.cases.material.calibrate import calibrate

    p = calibrate(scene)
    for i, (law, stiffness) in enumerate(
        zip(laws, [p.regular_stiffness, *p.stiffness[p.soft]], strict=True)
    ):
        if law.tensile_strength is None or law.fracture_energy is None:
            continue
        least = SNAP * law.tensile_strength**2 / (2 * stiffness)
        if law.fracture_energy < least:
            raise contradiction(
                f"soft_layers[{i - 1}].fracture_energy" if i else "joints.fracture_energy",
                law.fracture_energy,
                "must exceed tensile_strength^2 / (2 K'_n), or the joint snaps back: "
                f"at least {rounded_up(least):.4g} J/m2",
            )


CHECKS = (
    check_segments,
    _check_layers,
    _check_receivers,
    _check_rock,
    check_quality,
    check_time,
    check_fields,
    _check_lever,
    _check_extreme,
    _check_ends,
    _check_damping,
    _check_strength,
    _check_fracture,
    check_discretisation,
    check_scheme,
)
