"""The waves of a rock mass as an engine takes them: with all that is known of their joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cases.schema.scene import Scene

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass


def incident(scene: Scene | RockMass) -> dict[str, Any]:
    """Return the argument `incident` of an engine's run; none for a scene without waves."""
    if isinstance(scene, Scene) or not scene.waves:
        return {}
    from compare.exact.rock_mass.field import field_of

    return {"incident": field_of(scene)}
