"""Motion of joints beyond their linear law under the incident field, over that of the wave.

A joint that fails moves by about what the traction beyond its strength causes; one that stiffens
changes the part of the wave that it reflects.
"""

from collections.abc import Iterator

import numpy as np

from jointwave.cases.incident import PlaneWave, in_components, plane_wave
from jointwave.cases.material.rock_mass import initial_stress
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.plane.waves import cosines, face
from jointwave.compare.exact.rock_mass.conditions import ALONG, linear_law
from jointwave.compare.exact.rock_mass.field import StackField, field_of
from jointwave.compare.exact.rock_mass.stack_waves import on_face

SAMPLES = 2000  # most times at which tractions are evaluated
IN_A_PERIOD = 40  # least number of them per period


def parts(scene: RockMass) -> Iterator[tuple[float, str]]:
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
        moves, traction = max(largest_velocity(wave, n) for wave in waves), on_face(stress, n)
        pressed = np.einsum("i,min->mn", n, traction)
        shear = np.linalg.norm(traction - pressed[:, None] * n[:, None], axis=1)
        for excess, does in zip(_excess(one, pressed, shear), ("opens", "slips"), strict=True):
            yield (excess * moves / peak if peak else 0.0), f"joint set {one.name!r} {does}"
        if one.maximum_closure is not None and one.normal_stiffness:
            begins = one.normal_stiffness * one.maximum_closure + max(pressed.min(), 0.0)
            closes = np.ptp(pressed) / begins
            part = reflected_part(scene, one) * float(closes / (1 + closes))
            yield part, f"joint set {one.name!r} stiffens"


def _excess(one: JointSet, pressed: np.ndarray, shear: np.ndarray) -> tuple[float, float]:
    """Return by how much normal and shear traction exceed a failed joint's strength, Pa."""
    opens = slides = 0.0
    if one.tension is False or one.tensile_strength is not None:
        strength, pulled = one.tensile_strength or 0.0, float(-pressed.min())
        opens = pulled if pulled > strength else 0.0
    if one.friction_angle is not None or one.cohesion is not None:
        angle, cohesion = one.dynamic_friction_angle, one.residual_cohesion
        angle = one.friction_angle if angle is None else angle
        cohesion = one.cohesion if cohesion is None else cohesion
        peak, left = (
            (c or 0.0) + np.tan(np.radians(phi or 0.0)) * np.maximum(pressed, 0.0)
            for c, phi in ((one.cohesion, one.friction_angle), (cohesion, angle))
        )
        if (shear > peak).any():
            slides = float((shear - left).max())
    return opens, slides


def largest_velocity(wave: PlaneWave, normal: np.ndarray) -> float:
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


def reflected_part(scene: RockMass, one: JointSet) -> float:
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
