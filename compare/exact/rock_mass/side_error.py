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
from jointwave.cases.incident import PlaneWave, in_components, plane_wave
from jointwave.cases.material.rock_mass import initial_stress
from jointwave.cases.partition.shape import Face, distance, shape_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.warnings.rock_mass import fastest, plane_waves, spelled
from jointwave.cases.warnings.sources import onset
from jointwave.compare.exact.plane.waves import cosines, face
from jointwave.compare.exact.rock_mass import normal_incidence
from jointwave.compare.exact.rock_mass.conditions import (
    ALONG,
    along,
    free_face,
    linear_law,
    normals_of,
    waves_leave,
)
from jointwave.compare.exact.rock_mass.effective_medium import medium_field
from jointwave.compare.exact.rock_mass.field import StackField, field_of, planes_of
from jointwave.compare.exact.rock_mass.stack_waves import on_face

BESIDE = 0.5  # P wavelengths from a quiet side within which it disturbs the waves of a load
LEAST = 0.01  # error relative to the wave below which nothing is reported
SAMPLES = 2000  # most times at which tractions are evaluated
IN_A_PERIOD = 40  # least number of them per period


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
    return ", ".join([*map(spelled, places[:3]), *more])


def beside_loads(scene: RockMass) -> Iterator[str]:
    """Yield the receivers that a load's waves, reflected at an angle from quiet sides, reach before
    the end: reflections come as from the load's mirror image."""
    shape, plane, speed = shape_of(scene.domain), plane_waves(scene) or {}, fastest(scene)
    faces = [x for side in scene.boundaries.sides("quiet") for x in shape.faces_of(side)]
    for key, load in scene.entries("loads"):
        reach = BESIDE * speed * (load.time_scale or scene.time.duration)
        lasts, near = speed * (scene.time.duration - onset(load)), []
        for at in map(np.array, (*scene.record.points, *scene.record.joints)):
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
        key: [(tuple(place), distance(np.array(place), faces)) for place in places]
        for key in ("points", "joints")
        if (places := getattr(scene.record, key))
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
        back = _reflected_part(scene, one)
        if smeared:
            yield 1 - float(np.sqrt(1 - back**2)), f"joint set {one.name!r} is not smeared"
        else:
            count = shape_of(scene.domain).size / one.spacing if one.spacing else 1.0
            why = "is not parallel to layers, a free side or other sets"
            if any(abs(one.normal @ wave.direction) < ALONG for wave in scene.waves):
                why = "lies along a wave"
            yield 1 - (1 - back) ** count, f"joint set {one.name!r} {why}"
    yield from _beyond_strength(scene)


def _reflected_part(scene: RockMass, one: JointSet) -> float:
    """Return the largest part of a wave reflected by a joint of a set at its dominant frequency, at
    normal incidence: x / sqrt(1 + x^2), x = omega Z / 2 K."""
    most = 0.0
    for wave in scene.waves:
        incident, K = plane_wave(scene, wave), one.normal_stiffness
        K = K if wave.kind == "P" else one.shear_stiffness
        if wave.time_scale and K:
            x = np.pi / wave.time_scale * float(incident.rock.density) * incident.speed / K
            most = max(most, float(x / np.hypot(1.0, x)))
    return most


def _face_motion(scene: RockMass) -> float:
    """Return the motion caused by the traction that the waves of a medium leave on a free side,
    over the velocity of the wave."""
    face, most = free_face(scene), 0.0
    if face is None:
        return most
    for one in scene.waves:
        waves = medium_field(scene.model_copy(update={"waves": [one]})).waves
        left = on_face(np.sum([x.unit_stress() for x in waves], axis=0)[None, :, None], face.normal)
        most = max(most, float(np.linalg.norm(left)) * _largest_velocity(waves[0], face.normal))
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


def _beyond_strength(scene: RockMass) -> Iterator[tuple[float, str]]:
    """Yield for each joint set the motion caused by tractions beyond its strength, over the
    velocity of the wave, and the change of its reflection as it closes."""
    sets = [one for one in scene.joint_sets if not linear_law(one)]
    if not sets:
        return
    field, corners = field_of(scene), np.array(scene.domain.corners)
    middle = corners.mean(axis=0)
    places = np.vstack([middle, corners])
    if isinstance(field, StackField):
        n = field.stack.normal
        places = np.vstack([middle, middle + (field.stack.offsets[:, None] - middle @ n) * n])
    period = min((one.time_scale or np.inf for one in scene.waves), default=np.inf)
    count = np.clip(IN_A_PERIOD * scene.time.duration / period, 200, SAMPLES)
    times = np.linspace(0.0, scene.time.duration, int(count))
    waves = [plane_wave(scene, one) for one in scene.waves]
    peak = max(float(np.abs(one.pulse.value(times)).max()) for one in waves)
    still = in_components(initial_stress(scene, places))
    stress = still[:, :, None] - field(places, times).stress
    for one in sets:
        n = one.normal
        moves, traction = max(_largest_velocity(wave, n) for wave in waves), on_face(stress, n)
        pressed = np.einsum("i,min->mn", n, traction)
        shear = np.linalg.norm(traction - pressed[:, None] * n[:, None], axis=1)
        for excess, does in zip(_excess(one, pressed, shear), ("opens", "slips"), strict=True):
            yield (excess * moves / peak if peak else 0.0), f"joint set {one.name!r} {does}"
        if one.maximum_closure is not None and one.normal_stiffness:
            begins = one.normal_stiffness * one.maximum_closure + max(pressed.min(), 0.0)
            closes = np.ptp(pressed) / begins
            part = _reflected_part(scene, one) * float(closes / (1 + closes))
            yield part, f"joint set {one.name!r} stiffens"


def _largest_velocity(wave: PlaneWave, normal: np.ndarray) -> float:
    """Return the largest velocity caused by a traction on a joint, m/s/Pa: the largest singular
    value of V A^-1, V and A the velocities and tractions of unit P and SV waves with the wave's
    slowness along the joint; in space at least that of SH waves, 1 / (Z_s cos phi)."""
    across = wave.direction - (wave.direction @ normal) * normal
    slowness = float(np.linalg.norm(across)) / wave.speed
    w = face(wave.rock, slowness)
    V, A = np.array([w.shear_velocity, w.normal_velocity]), np.array([w.shear, w.normal])
    found = float(np.linalg.norm(V @ np.linalg.inv(A), 2))
    if len(normal) == 3:
        cosine = max(float(np.abs(cosines(wave.rock, slowness)[1])), ALONG)
        found = max(found, 1 / (float(wave.rock.s_impedance) * cosine))
    return found


def _excess(one: JointSet, pressed: np.ndarray, shear: np.ndarray) -> tuple[float, float]:
    """Return by how much normal and shear traction exceed a failed joint's strength, Pa."""
    opens = slides = 0.0
    if one.tension is False or one.tensile_strength is not None:
        strength, pulled = one.tensile_strength or 0.0, float(-pressed.min())
        opens = pulled if pulled > strength else 0.0
    if one.friction_angle is not None or one.cohesion is not None:
        closed, cohesion = np.maximum(pressed, 0.0), one.cohesion or 0.0

        def strength_of(angle: float | None, cohesion: float) -> np.ndarray:
            return cohesion + np.tan(np.radians(angle or 0.0)) * closed

        if (shear > strength_of(one.friction_angle, cohesion)).any():
            angle = one.friction_angle
            if one.dynamic_friction_angle is not None:
                angle = one.dynamic_friction_angle
            if one.residual_cohesion is not None:
                cohesion = one.residual_cohesion
            slides = float((shear - strength_of(angle, cohesion)).max())
    return opens, slides
