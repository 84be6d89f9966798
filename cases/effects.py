"""What a scene calls for, and what is left out of the computation because it does not."""

from dataclasses import dataclass

from cases.calibrate import calibrate
from cases.scene import Scene


@dataclass(frozen=True)
class Effect:
    """One optional part of the physics: its name, whether the scene calls for it, and why."""

    name: str
    active: bool
    reason: str


def effects(scene: Scene) -> list[Effect]:
    """Return every effect that this version knows, in the order of their cost."""
    p = calibrate(scene)
    ends = {scene.ends.start, scene.ends.end}
    barred = int((~p.tension).sum())
    differ = len(p.soft)
    return [
        Effect(
            "dashpots",
            p.joint_time_constant is not None,
            "damping_ratio is given" if p.joint_time_constant is not None else "no damping_ratio",
        ),
        Effect(
            "no tension",
            barred > 0,
            f"{barred} of {len(p.tension)} joints" if barred else "every joint carries tension",
        ),
        Effect(
            "joints that differ",
            differ > 0,
            f"{differ} soft layers" if differ else "all joints are alike: one number, no array",
        ),
        Effect("quiet ends", "quiet" in ends, _where(scene, "quiet")),
        Effect("matched ends", "matched" in ends, _where(scene, "matched")),
        Effect("fixed ends", "fixed" in ends, _where(scene, "fixed")),
        Effect(
            "energy ledger",
            scene.record.energy,
            "record.energy is on" if scene.record.energy else "record.energy = false",
        ),
        Effect("spatial motion", False, "the load is axial and central: one freedom per block"),
        Effect("slip", False, "no friction_angle, and nothing shears the joints"),
        Effect("softening", False, "no tensile_strength"),
        Effect("gravity and prestress", False, "neither table is given"),
    ]


def active_effects(scene: Scene) -> list[str]:
    """Return the names of the effects that the scene calls for."""
    return [effect.name for effect in effects(scene) if effect.active]


def _where(scene: Scene, kind: str) -> str:
    places = [k for k in ("start", "end") if getattr(scene.ends, k) == kind]
    return f"ends.{' and ends.'.join(places)}" if places else f"no end is {kind}"
