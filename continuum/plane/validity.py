"""Rock masses that the continuum can simulate, and the reasons why not others."""

from __future__ import annotations

from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.plane.rock import smeared

#: Keys of a joint set that the effective medium does not support.
NONLINEAR = ("friction_angle", "cohesion", "damping_ratio", *(part.keys[0] for part in PARTS))


def applies(scene: RockMass, model: str = "jointed") -> str:
    """Return "" if this model can simulate the scene, else the reason."""
    damped = scene.rock.quality_factor is not None
    reasons = [
        (scene.damping.local is not None, "the continuum has no local damping"),
        (len(scene.bases) > 1, "only one base can move"),
        (damped and bool(scene.waves), "[[waves]] do not support a quality_factor"),
    ]
    if model == "equivalent":
        reasons += _beyond_medium(scene)
    return next((why for there, why in reasons if there), "")


def _beyond_medium(scene: RockMass) -> list[tuple[bool, str]]:
    """Return why a scene has no effective medium, each reason with whether it holds."""
    sets = smeared(scene, "equivalent")
    found = [
        (not sets, "no joint set has a spacing: there is nothing to homogenise"),
        (scene.rock.quality_factor is not None, "the effective medium has no quality_factor"),
    ]
    for one in sets:
        for key in NONLINEAR:
            has = getattr(one, key) is not None
            found.append((has, f"homogenised joints have no {key} (set '{one.name}')"))
        found.append((one.tension is False, f"homogenised joints do not open (set '{one.name}')"))
    return found
