"""Contradictions of a scene with steps of fourth order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cases.schema.values import contradiction

if TYPE_CHECKING:
    from cases.schema.scene import Scene

#: Forces that depend on velocity or history, which drifts backwards in time would get wrong, and
#: motion that only leapfrog steps.
BEYOND = (
    "dashpots",
    "mass damping",
    "local damping",
    "softening",
    "quiet ends",
    "matched ends",
    "shaken base",
    "spatial motion",
)


def check_scheme(scene: Scene) -> None:
    """Raise the first contradiction between the scheme and what the scene calls for."""
    if scene.numerics.dem.scheme == "leapfrog":
        return
    from cases.effects import active_effects  # it needs the Scene, which needs this check

    for name in active_effects(scene):
        if name in BEYOND:
            raise contradiction(
                "numerics.dem.scheme",
                scene.numerics.dem.scheme,
                f"has no {name}, which the scene calls for; 'leapfrog' has",
            )
