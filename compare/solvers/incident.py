"""The waves of a rock mass as an engine takes them: with all that is known of their joints.

All engines take the same, homogenised rock included: where joints are parallel its waves come from
the intact rock in front of the joints, as theirs do, and the distance between them is their own.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from jointwave.cases.scene_type import AnyScene

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField


BESIDE = 0.5  # wavelengths of P from a quiet side, within which it disturbs the waves of a load


def incident(scene: AnyScene) -> IncidentField | None:
    """Return what enters a rock mass through its quiet sides; None for a scene without waves."""
    if not scene.waves:
        return None
    from jointwave.compare.exact.rock_mass.field import field_of

    return field_of(scene)


def side_warnings(scene: AnyScene) -> list[str]:
    """Return the errors of the quiet sides of a rock mass that its receivers feel, a line each."""
    found = [] if scene.is_column else [*_beside_loads(scene)][:1]
    if scene.waves:
        from jointwave.compare.exact.rock_mass.side_error import side_error

        found += [] if (error := side_error(scene)) is None else [error.words]
    return found


def _beside_loads(scene: Any) -> Iterator[str]:
    """Yield which points feel what quiet sides send back of a load's waves that meet them at an
    angle, before the end: from a side they come as from the image of the load."""
    import numpy as np

    from jointwave.cases.checks.rock_mass import GRAZING
    from jointwave.cases.partition.shape import distance, shape_of
    from jointwave.cases.warnings.rock_mass import fastest, plane_waves
    from jointwave.cases.warnings.sources import onset

    shape, plane, speed = shape_of(scene.domain), plane_waves(scene) or {}, fastest(scene)
    faces = [x for side in scene.boundaries.sides("quiet") for x in shape.faces_of(side)]
    for key, load in scene.entries("loads"):
        reach = BESIDE * speed * (load.time_scale or scene.time.duration)
        lasts, near = speed * (scene.time.duration - onset(load)), dict[str, None]()
        for at in map(np.array, (*scene.record.points, *scene.record.joints)):
            for corners, n in faces:
                way = at - (start := np.array(load.at or at)) - 2 * ((corners[0] - start) @ n) * n
                met = key not in plane or abs(n @ plane[key][0]) < 1 - GRAZING
                if met and distance(at, [(corners, n)]) < reach and np.linalg.norm(way) < lasts:
                    near[f"[{', '.join(f'{x:g}' for x in at)}]"] = None
        if near and load.amplitude:
            yield (
                f"{key}: {', '.join([*near][:3])}{', ...' * (len(near) > 3)} of [record] lie "
                f"within half a wavelength of P, {reach:.3g} m, of quiet sides, which reflect what "
                "meets them at an angle: velocities were off by 4 to 33 % of their peaks; a larger "
                "domain shows by how much"
            )


def note_sides(attributes: dict[str, Any], scene: AnyScene) -> None:
    """Add those lines to the warnings that a result bears."""
    if lines := side_warnings(scene):
        attributes["warnings"] = json.dumps([*json.loads(attributes["warnings"]), *lines])
