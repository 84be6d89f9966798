"""The waves of a rock mass as an engine takes them: with all that is known of their joints.

All engines take the same, homogenised rock included: where joints are parallel its waves come from
the intact rock in front of the joints, as theirs do, and the distance between them is their own.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jointwave.cases.scene_type import AnyScene

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField


def incident(scene: AnyScene) -> IncidentField | None:
    """Return what enters a rock mass through its quiet sides; None for a scene without waves."""
    if not scene.waves:
        return None
    from jointwave.compare.exact.rock_mass.field import field_of

    return field_of(scene)


def side_warnings(scene: AnyScene) -> list[str]:
    """Return the errors of the quiet sides of a rock mass that its receivers feel, a line each."""
    if scene.is_column or not scene.boundaries.sides("quiet"):
        return []
    from jointwave.compare.exact.rock_mass.side_error import beside_loads, side_error

    error = side_error(scene)
    return [*beside_loads(scene)][:1] + ([] if error is None else [error.words])


def note_sides(attributes: dict[str, Any], scene: AnyScene) -> None:
    """Add those lines to the warnings that a result bears."""
    if lines := side_warnings(scene):
        attributes["warnings"] = json.dumps([*json.loads(attributes["warnings"]), *lines])
