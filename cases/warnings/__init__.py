"""Warnings about likely mistakes in a scene, one line each.

No scene is refused: unusual values may be intended. `--strict` makes each warning an error.
"""

from typing import Any

from jointwave.cases.plausible import implausible
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.warnings import pillar
from jointwave.cases.warnings.sources import of_sources


def warnings(scene: AnyScene) -> list[str]:
    """Return warnings about likely mistakes in a scene, one line each."""
    own: Any = pillar
    if not scene.is_column:
        from jointwave.cases.warnings import rock_mass as own  # with shapely
    found = [*implausible(scene), *of_sources(scene, **own.met(scene))]
    found += [line for rule in own.RULES for line in rule(scene)]
    falls = scene.gravity is not None and not scene.gravity.static
    if (local := scene.damping.local) and (falls or any(one.amplitude for one in scene.pulses)):
        found.append(
            f"damping.local distorts waves and slows what slides or falls to {1 - local:.3g} of "
            "its acceleration: it is meant for static states, not for a scene with a load or "
            "sudden gravity"
        )
    return found
