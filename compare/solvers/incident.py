"""The incident field of a rock mass for the engines, with all known effects of its joints.

All engines use the same field, homogenised rock included: with parallel joints, waves come from the
intact rock in front of them, so that distances between engines are their own.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from jointwave.cases.scene_type import AnyScene

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField


def incident(scene: AnyScene) -> IncidentField | None:
    """Return the field that enters a rock mass through its quiet sides; None without waves."""
    if not scene.waves:
        return None
    from jointwave.compare.exact.rock_mass.field import field_of

    return field_of(scene)


def side_warnings(scene: AnyScene) -> list[str]:
    """Return the errors of a rock mass's quiet sides that receivers feel, one line each."""
    if scene.is_column or not scene.boundaries.sides("quiet"):
        return []
    from jointwave.compare.exact.rock_mass.side_error import beside_loads, side_error

    error = side_error(scene)
    return [*beside_loads(scene)][:1] + ([] if error is None else [error.words])


def note_sides(attributes: dict[str, Any], scene: AnyScene) -> None:
    """Add the warnings about quiet sides to those of a result."""
    if lines := side_warnings(scene):
        attributes["warnings"] = json.dumps([*json.loads(attributes["warnings"]), *lines])
