"""Error of the incident field at the quiet sides of a scene, and its reach into the rock.

The field (`field.field_of`) assumes joints that stay linear. Joints near a side that fail or
stiffen change the true motion there, by about the motion that the traction beyond their strength
causes. The side still prescribes the field, so the difference enters the domain as a wave. Sides
that all waves meet at normal incidence are exact in any case, since their dashpots absorb
everything that comes back.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from jointwave.cases.checks.rock_mass import GRAZING
from jointwave.cases.errors import placed
from jointwave.cases.incident import plane_wave
from jointwave.cases.partition.shape import Face, distance, shape_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.warnings.rock_mass import fastest, plane_waves
from jointwave.cases.warnings.sources import onset
from jointwave.compare.exact.rock_mass import beyond_strength, normal_incidence
from jointwave.compare.exact.rock_mass.conditions import (
    ALONG,
    along,
    free_face,
    normals_of,
    waves_leave,
)
from jointwave.compare.exact.rock_mass.effective_medium import medium_field
from jointwave.compare.exact.rock_mass.field import planes_of
from jointwave.compare.exact.rock_mass.stack_waves import on_face

BESIDE = 0.5  # P wavelengths from a quiet side within which it disturbs the waves of a load
LEAST = 0.01  # error relative to the wave below which nothing is reported


class SideError(NamedTuple):
    """An error of quiet sides: its cause; its largest part of the incident wave there; the P
    wavelength, m, at which less than half of it is left; and nearer receivers, by key of
    [record]."""

    cause: str
    part: float
    wavelength: float
    near: dict[str, list[tuple[float, ...]]]

    @property
    def words(self) -> str:
        """The error in one line."""
        places = [at for some in self.near.values() for at in some]
        nearer = f"; nearer: {_first(places)}" if places else ""
        return (
            f"boundaries: {self.cause}, which waves at quiet sides leave out: an error of up to "
            f"{100 * self.part:.3g} % of the wave enters there, of which less than half is left "
            f"{self.wavelength:.3g} m (a wavelength of P) inside{nearer}"
        )


def _first(places: list[tuple[float, ...]]) -> str:
    more = [f"{len(places) - 3} more"] if len(places) > 3 else []
    return ", ".join([*map(placed, places[:3]), *more])


def beside_loads(scene: RockMass) -> Iterator[str]:
    """Yield the receivers that a load's waves, reflected at an angle from quiet sides, reach before
    the end: reflections come as from the load's mirror image."""
    shape, plane, speed = shape_of(scene.domain), plane_waves(scene) or {}, fastest(scene)
    faces = [x for side in scene.boundaries.sides("quiet") for x in shape.faces_of(side)]
    for key, load in scene.entries("loads"):
        reach = BESIDE * speed * (load.time_scale or scene.time.duration)
        lasts, near = speed * (scene.time.duration - onset(load)), []
        for at in np.concatenate([*scene.places.values()]):
            for corners, n in faces:
                way = at - (start := np.array(load.at or at)) - 2 * ((corners[0] - start) @ n) * n
                met = key not in plane or abs(n @ plane[key][0]) < 1 - GRAZING
                if met and distance(at, [(corners, n)]) < reach and np.linalg.norm(way) < lasts:
                    near.append(tuple(at.tolist()))
        if near and load.amplitude:
            yield (
                f"{key}: {_first([*dict.fromkeys(near)])} of [record] lie within half a wavelength "
                f"of P, {reach:.3g} m, of quiet sides, which reflect what meets them at an angle: "
                "velocities were off by 4 to 33 % of their peaks; a larger domain shows by how much"
            )


def side_error(scene: RockMass) -> SideError | None:
    """Return the largest error of a scene's quiet sides that receivers feel; None if it is below
    LEAST or reaches no receiver in time."""
    faces = _oblique(scene) if scene.waves else []
    if not faces or normal_incidence.applies(scene):
        return None
    part, cause = max(_causes(scene), default=(0.0, ""))
    if part < LEAST:
        return None
    corners = np.concatenate([corners for corners, _ in faces])
    begins = min(plane_wave(scene, one).lateness(corners).min() for one in scene.waves)
    reach = fastest(scene) * (scene.time.duration - max(float(begins), 0.0))
    wavelength = fastest(scene) * max(one.time_scale or scene.time.duration for one in scene.waves)
    away = {
        key: [(tuple(place.tolist()), distance(place, faces)) for place in places]
        for key, places in scene.places.items()
        if len(places)
    }
    if min((d for places in away.values() for _, d in places), default=0.0) > reach:
        return None
    near = {key: [at for at, d in places if d < wavelength] for key, places in away.items()}
    return SideError(cause, min(part, 1.0), wavelength, near)


def _oblique(scene: RockMass) -> list[Face]:
    """Return the faces of quiet sides, except those that all waves meet at normal incidence."""
    shape, found = shape_of(scene.domain), []
    planes = normals_of(planes_of(scene))
    for side in scene.boundaries.sides("quiet"):
        for corners, n in shape.faces_of(side):
            straight = all(along(np.array(w.direction), n, ALONG) for w in scene.waves)
            if not straight or not all(along(n, one, ALONG) for one in planes):
                found.append((corners, n))
    return found


def _causes(scene: RockMass) -> Iterator[tuple[float, str]]:
    """Yield the effects that the field leaves out, as the largest part of the wave and a cause."""
    planes = planes_of(scene)
    quiet = {side: "quiet" for side in scene.boundaries.sides("periodic")}
    closed = scene.model_copy(update={"boundaries": scene.boundaries.model_copy(update=quiet)})
    if not (answer := waves_leave(closed, free_face(planes))):
        yield 1.0, answer.reason
    yield _damped(scene), "the rock is damped"
    kept = [one.name for one in planes.joint_sets]
    left = [one for one in scene.joint_sets if one.name not in kept]
    smeared = all(one.spacing for one in left) and not planes.regions and not kept
    if smeared and left:
        yield _face_motion(scene), "a wave decays from the free side"
    for one in left:
        back = beyond_strength.reflected_part(scene, one)
        if smeared:
            yield 1 - float(np.sqrt(1 - back**2)), f"joint set {one.name!r} is not smeared"
        else:
            count = shape_of(scene.domain).size / one.spacing if one.spacing else 1.0
            why = "is not parallel to layers, a free side or other sets"
            if any(abs(one.normal @ wave.direction) < ALONG for wave in scene.waves):
                why = "lies along a wave"
            yield 1 - (1 - back) ** count, f"joint set {one.name!r} {why}"
    yield from beyond_strength.parts(scene)


def _face_motion(scene: RockMass) -> float:
    """Return the motion caused by the traction that the waves of a medium leave on a free side,
    over the velocity of the wave."""
    face, most = free_face(scene), 0.0
    if face is None:
        return most
    for one in scene.waves:
        waves = medium_field(scene.model_copy(update={"waves": [one]})).waves
        left = on_face(np.sum([x.unit_stress() for x in waves], axis=0)[None, :, None], face.normal)
        most = max(
            most,
            float(np.linalg.norm(left)) * beyond_strength.largest_velocity(waves[0], face.normal),
        )
    return most


def _damped(scene: RockMass) -> float:
    """Return the part of a wave that the rock's damping absorbs across the domain."""
    alpha, beta = scene.damping.alpha or 0.0, 0.0
    if scene.damping.rayleigh is not None:
        beta = scene.damping.rayleigh.coefficients[1]
    size, most = shape_of(scene.domain).size, 0.0
    for wave in scene.waves:
        omega = 2 * np.pi / wave.time_scale if wave.time_scale else 0.0
        rate = (alpha + beta * omega**2) / 2
        most = max(most, 1 - float(np.exp(-rate * size / plane_wave(scene, wave).speed)))
    return most
