"""Joints that stiffen as they close: constants from roughness and strength, and stress in a scene.

Bandis, Lumsden & Barton, Int. J. Rock Mech. Min. Sci. 20, 249-268 (1983), and Barton, Bandis &
Bakhtar, 22, 121-140 (1985), measured joints of JRC 5 to 15 and JCS 22 to 182 MPa. In MPa and mm,
for the third loading cycle, which is closest to joints in situ:

    a = JRC / 5 (0.2 sigma_c / JCS - 0.1),   k_ni = -7.15 + 1.75 JRC + 0.02 JCS / a,
    d_m = -0.1032 - 0.0074 JRC + 1.135 (JCS / a)^-0.251.
"""

from math import nan, sqrt
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.loads import highest_frequency, velocity_of
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Pulse

DELAY = 5e-5  # of a wave by a closed joint, in its shortest periods
SAMPLES = 10_001  # of a pulse, besides its breaks, to find its peak


class Closure(NamedTuple):
    """Initial aperture, m; initial normal stiffness, Pa/m; maximum closure, m."""

    aperture: float
    normal_stiffness: float
    maximum_closure: float


def bandis_closure(roughness: float, wall_strength: float, rock_strength: float) -> Closure:
    """Return the closure of a joint of JRC `roughness` and JCS `wall_strength` (Pa), in rock of
    uniaxial compressive strength sigma_c `rock_strength` (Pa).

    Raises ValueError outside measured JRC 5 to 15, JCS 22 to 182 MPa (at most sigma_c), 0.1 to 0.6
    mm.
    """
    jcs, sigma_c = wall_strength / 1e6, rock_strength / 1e6
    a = roughness / 5 * (0.2 * sigma_c / (jcs or nan) - 0.1)
    for name, value, least, most in (
        ("JRC", roughness, 5.0, 15.0),
        ("JCS, MPa,", jcs, 22.0, min(182.0, sigma_c)),
        ("the aperture, mm,", a, 0.1, 0.6),
    ):
        if not least * (1 - 1e-9) <= value <= most * (1 + 1e-9):
            raise ValueError(f"{name} is {value:g}, outside the measured {least:g} to {most:g}")
    stiffness = -7.15 + 1.75 * roughness + 0.02 * jcs / a
    closure = -0.1032 - 0.0074 * roughness + 1.135 * (jcs / a) ** -0.251
    return Closure(1e-3 * a, 1e9 * stiffness, 1e-3 * closure)


def stress_in_reach(scene: AnyScene) -> float:
    """Return the normal stress (Pa) up to which the critical step accounts for joint closure.

    The initial stress plus twice the added one, as at a rigid wall, or three times in rock with
    openings, as at the wall of a circular one (Kirsch). Focusing waves can exceed it.
    """
    (initial, added), opened = stresses(scene), not scene.is_column and scene.domain.holes
    return initial + (3 if opened else 2) * added


def stresses(scene: AnyScene) -> tuple[float, float]:
    """Return the largest initial stress, and the summed peaks of loads, waves and sudden weight,
    Pa."""
    initial = 0.0 if scene.prestress is None else scene.prestress.largest(scene.excavated)
    added = sum(_stress_of(one, scene) * _peak(one, scene.time.duration) for one in scene.pulses)
    if scene.gravity is None:
        return initial, added
    density = max(scene.rock.density, *(one.density or 0.0 for one in scene.regions), 0.0)
    weight = density * scene.gravity.acceleration * scene.reach
    return (initial + weight, added) if scene.gravity.static else (initial, added + weight)


def closed_compliance(scene: AnyScene) -> float:
    """Return the compliance c (m/Pa) of closed joints between deformable rock: it delays a wave by
    c Z / 2, `DELAY` of its shortest period, and is what faces bounce on that meet at its speed; 0
    without a load."""
    frequency = highest_frequency(scene)
    return 0.0 if frequency is None else 2 * DELAY / (frequency * _impedance(scene))


def _peak(pulse: Pulse, duration: float) -> float:
    """Return the largest magnitude of a pulse; for an acceleration, of its integral."""
    history = velocity_of(pulse, pulse.amplitude)
    times = np.linspace(0.0, min(duration, history.end) or duration, SAMPLES)
    return float(np.abs(history.value(np.append(times, history.breaks))).max())


def _stress_of(pulse: Any, scene: Any) -> float:
    """Return the stress in rock per unit of a pulse: for a velocity the impedance, for a force one
    over the least joint spacing; at a pillar's start, at the edges of the section."""
    if pulse.kind == "load":
        if pulse.is_motion:
            return _impedance(scene)
        lever = sum(map(abs, pulse.at)) + (pulse.arm or 0.0)
        acts = 2 if pulse.quantity == "incident-stress" else 1
        return acts * (1 + 6 * lever / scene.pillar.side)
    if pulse.quantity == "stress":
        return 1.0
    if pulse.quantity == "force":
        spacings = (one.spacing for one in scene.joint_sets if one.spacing)
        return 1 / min(spacings, default=scene.domain.extent.max())
    return _impedance(scene)


def _impedance(scene: AnyScene) -> float:
    """Return the largest impedance of P waves in a scene's rock, of a pillar's start, Pa s/m."""
    if scene.is_column:
        p = calibrate(scene).at_start
        return sqrt((p.intact_modulus or p.modulus) * p.density)
    from jointwave.cases.partition.joints import rocks_of  # with shapely

    return max(float(elastic_rock(one).p_impedance) for one in rocks_of(scene))
