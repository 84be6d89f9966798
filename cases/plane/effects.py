"""Effects that a rock mass calls for, named as those of a pillar."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from jointwave.cases.effects import (
    SLIPS,
    STICKS,
    Effect,
    called_for,
    carries,
    of_body_forces,
    of_fields,
    of_ledger,
)
from jointwave.cases.schema.joint import PARTS

if TYPE_CHECKING:
    from jointwave.cases.schema.joint_set import JointSet
    from jointwave.cases.schema.rock_mass import RockMass

SIDES = ("quiet", "fixed", "periodic")


def effects_in_plane(scene: RockMass) -> list[Effect]:
    """Return every effect that rock masses know, in the order of their cost."""
    return [
        *_of_joints(scene),
        *(_of_sides(scene, kind) for kind in SIDES),
        of_ledger(scene),
        of_fields(scene),
        *_of_forces(scene),
    ]


def _of_joints(scene: RockMass) -> Iterator[Effect]:
    stiffness_damping = scene.damping.rayleigh is not None
    damped = [one for one in scene.joint_sets if one.damping_ratio is not None]
    if stiffness_damping:
        yield Effect("dashpots", True, "damping.rayleigh is given")
    else:
        yield _of_sets("dashpots", damped, "damping_ratio is given", "no damping_ratio")
    no_tension = [one for one in scene.joint_sets if one.tension is False]
    slides = any(one.friction_angle is not None for one in scene.joint_sets)
    yield _of_sets("no tension", no_tension, "tension = false", carries(slides))
    slips = [s for s in scene.joint_sets if s.friction_angle is not None or s.cohesion is not None]
    yield _of_sets("slip", slips, SLIPS, STICKS)
    for part in PARTS:
        having = [one for one in scene.joint_sets if part.of(one)]
        yield _of_sets(part.name, having, part.why(True), part.why(False))


def _of_sets(name: str, found: list[JointSet], why: str, why_not: str) -> Effect:
    """Return an effect of joints, which those sets call for."""
    whose = ", ".join(one.name for one in found)
    return called_for(name, found and f"{why}: {whose}", why_not)


def _of_sides(scene: RockMass, kind: str) -> Effect:
    sides = [f"boundaries.{side}" for side in scene.boundaries.sides(kind)]
    return called_for(f"{kind} sides", ", ".join(sides), f"no side is {kind}")


def _of_forces(scene: RockMass) -> Iterator[Effect]:
    yield from of_body_forces(scene, scene.damping.alpha)
    stress = scene.prestress
    words = stress and f"xx {stress.xx:.4g}, yy {stress.yy:.4g}, xy {stress.xy:.4g} Pa"
    words = words and words + scene.excavated * ", openings excavated"
    yield called_for("prestress", words, "no [prestress]")
    waves, pushed = len(scene.waves), len(scene.pushes)
    yield called_for("incident waves", waves and f"{waves} in [[waves]]", "no [[waves]]")
    yield called_for("loads", pushed and f"{pushed} in [[loads]]", "no [[loads]]")
    yield called_for("shaken base", scene.bases and "a load of kind 'base'", "no base is shaken")
