"""Effects that a scene calls for; all others are left out of the computation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cases.material.calibrate import Properties, calibrate
from cases.schema.joint import PARTS
from cases.schema.scene import Scene

if TYPE_CHECKING:
    from cases.kinds import AnyScene

NO_SHEAR = "nothing shears the joints"


@dataclass(frozen=True)
class Effect:
    """One optional part of the physics: its name, whether the scene calls for it, and why."""

    name: str
    active: bool
    reason: str


def is_spatial(scene: Scene) -> bool:
    """Return whether a scene moves across its axis or turns its blocks; else it is axial."""
    return off_axis(scene) is not None


def effects(scene: AnyScene) -> list[Effect]:
    """Return every effect that this version knows of this kind of scene, in the order of cost."""
    if not isinstance(scene, Scene):
        from cases.plane.effects import effects_in_plane

        return effects_in_plane(scene)
    p = calibrate(scene)
    return [
        *_of_joints(scene, p),
        *(_of_ends(scene, kind) for kind in ("quiet", "matched", "fixed")),
        of_ledger(scene),
        of_fields(scene),
        *_of_motion(scene, p),
        *_of_forces(scene, p),
    ]


def active_effects(scene: AnyScene) -> list[str]:
    """Return the names of the effects that the scene calls for."""
    return [effect.name for effect in effects(scene) if effect.active]


def off_axis(scene: Scene) -> str | None:
    """Return what takes the scene off its axis; None where nothing does."""
    if scene.load.arm is not None:
        return "the load is a couple"
    if scene.load.is_across:
        return "the load has a component across the axis"
    if scene.load.is_eccentric:
        return "the load is eccentric"
    gravity = scene.gravity
    if gravity is not None and (gravity.direction[0] or gravity.direction[2]):
        return "gravity has a component across the axis"
    return None


def _of_joints(scene: Scene, p: Properties) -> Iterator[Effect]:
    damped, rayleigh = p.joint_time_constant is not None, scene.damping.rayleigh
    source = "damping.rayleigh" if rayleigh else "damping_ratio"
    yield Effect("dashpots", damped, f"{source} is given" if damped else "no damping_ratio")
    yield from _of_law(scene, along=False)
    parts = len(p.each)
    words = f"{parts} of other rock" if parts > 1 else "no [[segments]]: one rock"
    yield Effect("segments", parts > 1, words)
    random = scene.scatter
    why = "no [scatter]" if random is None else f"seed {random.seed}"
    yield Effect("scatter", random is not None, why)
    alike = "all joints are alike: one number, no array" if p.is_uniform else "no soft layers"
    joints, barred, differ = len(p.tension), int((~p.tension).sum()), len(p.soft)
    yield Effect(
        "no tension",
        barred > 0,
        f"{barred} of {joints} joints" if barred else "every joint carries tension",
    )
    yield Effect(
        "joints that differ",
        differ > 0,
        f"{differ} soft layers" if differ else alike,
    )


def _of_ends(scene: Scene, kind: str) -> Effect:
    places = [k for k in ("start", "end") if getattr(scene.ends, k) == kind]
    reason = f"ends.{' and ends.'.join(places)}" if places else f"no end is {kind}"
    return Effect(f"{kind} ends", bool(places), reason)


def of_ledger(scene: AnyScene) -> Effect:
    """Return whether a scene keeps its energy ledger."""
    kept = scene.record.energy
    return Effect("energy ledger", kept, "record.energy " + ("is on" if kept else "= false"))


def of_fields(scene: AnyScene) -> Effect:
    """Return whether a scene keeps snapshots of all of it."""
    every = scene.record.fields
    reason = "no record.fields" if every is None else f"a snapshot every {every:g} s"
    return Effect("field output", every is not None, reason)


def _of_motion(scene: Scene, p: Properties) -> Iterator[Effect]:
    cause, rotation = off_axis(scene), scene.motion.rotation
    freedoms = 3 if rotation == "none" else 6
    yield Effect(
        "spatial motion",
        cause is not None,
        f"{cause}: {freedoms} freedoms per block"
        if cause
        else "the load is axial and central: one freedom per block",
    )
    yield Effect(
        "finite rotation",
        cause is not None and rotation == "finite",
        f"motion.rotation = '{rotation}'" if cause else "nothing turns the blocks",
    )
    slips = p.friction is not None or p.cohesion is not None
    yield Effect("slip", slips and cause is not None, _why_slip(slips, cause))
    yield from _of_law(scene, along=True)


def _of_law(scene: Scene, along: bool) -> Iterator[Effect]:
    """Yield the optional parts of the joints' law: those along them alone, or the others."""
    still = along and off_axis(scene) is None
    for part in PARTS:
        if part.along == along:
            has = any(part.of(law) for law in (scene.joints, *scene.layers))
            yield Effect(part.name, has and not still, NO_SHEAR if still else part.why(has))


def _why_slip(slips: bool, cause: str | None) -> str:
    if cause is None:
        return NO_SHEAR
    return "friction_angle or cohesion is given" if slips else "neither friction_angle nor cohesion"


def of_body_forces(scene: AnyScene, alpha: float | None) -> Iterator[Effect]:
    """Yield the effects on blocks themselves; alpha : of mass-proportional damping, 1/s."""
    local = scene.damping.local or None
    yield Effect(
        "mass damping",
        alpha is not None,
        "no mass_proportional, no rayleigh" if alpha is None else f"alpha = {alpha:.4g} 1/s",
    )
    yield Effect(
        "local damping",
        local is not None,
        "no damping.local" if local is None else f"damping.local = {local:g}",
    )
    quality = scene.rock.quality_factor
    yield Effect("constant Q", quality is not None, _why_quality(scene))
    yield Effect("gravity", scene.gravity is not None, _why_gravity(scene))


def _of_forces(scene: Scene, p: Properties) -> Iterator[Effect]:
    yield from of_body_forces(scene, p.mass_damping)
    prestress = scene.prestress
    yield Effect(
        "prestress",
        prestress is not None,
        "no [prestress]" if prestress is None else f"{prestress.normal:.4g} Pa",
    )
    quantity = f"load.quantity = '{scene.load.quantity}'"
    yield Effect("shaken base", scene.shakes_base, quantity)


def _why_quality(scene: AnyScene) -> str:
    """Return how the rock relaxes, in words."""
    quality = scene.rock.quality_factor
    if quality is None:
        return "no rock.quality_factor"
    _, low, high = scene.rock.quality_frequencies(scene.pulses)
    return f"rock.quality_factor = {quality:g} from {low:.4g} to {high:.4g} Hz"


def _why_gravity(scene: AnyScene) -> str:
    """Return how gravity acts, in words."""
    if scene.gravity is None:
        return "no [gravity]"
    return "static at the start" if scene.gravity.static else "sudden at t = 0"
