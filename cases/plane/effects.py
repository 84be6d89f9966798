"""Effects that a rock mass calls for, named as those of a pillar."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from cases.effects import Effect, of_body_forces, of_fields, of_ledger
from cases.schema.joint import PARTS

if TYPE_CHECKING:
    from cases.schema.joint_set import JointSet
    from cases.schema.rock_mass import RockMass

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
    barred = [one for one in scene.joint_sets if one.tension is False]
    yield _of_sets("no tension", barred, "tension = false", "every joint carries tension")
    slips = [s for s in scene.joint_sets if s.friction_angle is not None or s.cohesion is not None]
    given = "friction_angle or cohesion is given"
    yield _of_sets("slip", slips, given, "neither friction_angle nor cohesion")
    for part in PARTS:
        having = [one for one in scene.joint_sets if part.of(one)]
        yield _of_sets(part.name, having, part.why(True), part.why(False))


def _of_sets(name: str, found: list[JointSet], why: str, why_not: str) -> Effect:
    """Return an effect of joints, which those sets call for."""
    whose = ", ".join(one.name for one in found)
    return Effect(name, bool(found), f"{why}: {whose}" if found else why_not)


def _of_sides(scene: RockMass, kind: str) -> Effect:
    sides = [f"boundaries.{side}" for side, held in scene.boundaries if held == kind]
    return Effect(f"{kind} sides", bool(sides), " and ".join(sides) or f"no side is {kind}")


def _of_forces(scene: RockMass) -> Iterator[Effect]:
    yield from of_body_forces(scene, scene.damping.alpha)
    stress = scene.prestress
    yield Effect(
        "prestress",
        stress is not None,
        "no [prestress]"
        if stress is None
        else f"xx {stress.xx:.4g}, yy {stress.yy:.4g}, xy {stress.xy:.4g} Pa",
    )
    waves, pushed, shaken = len(scene.waves), len(scene.pushes), bool(scene.bases)
    yield Effect("incident waves", waves > 0, f"{waves} of [[waves]]" if waves else "no [[waves]]")
    yield Effect("loads", pushed > 0, f"{pushed} of [[loads]]" if pushed else "no [[loads]]")
    yield Effect("shaken base", shaken, "a load of kind 'base'" if shaken else "none is shaken")
