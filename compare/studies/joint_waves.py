"""A wave at parallel joints in rock: its scattering in closed form, and a scene that measures it.

Joints are horizontal and the wave is rotated, so that all angles have the same blocks and elements.
The joints' exact field enters through all sides; any error is the solver's own.

At one frequency the motion of each half-space is the sum of plane waves of one slowness p along the
joints (`compare.exact.plane.waves`): in front of them the incident wave and both reflected ones,
behind them both transmitted ones. With factor e^{-i omega t} and the place (x, z) from the joints,

    V(x, z) = sum of A g e^{i omega (p x +- q z)},   V = int v e^{i omega t} dt

is a linear system for the amplitudes A, two equations a point, solved by least squares. The speeds
are those of the intact rock. V is the trapezium rule's sum, exact for pulses that are over within
the record and have nothing above half its sampling frequency.
"""

from math import nan, pi, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.rock import Values, elastic_rock
from jointwave.cases.partition.joints import attitude
from jointwave.cases.read import load
from jointwave.cases.schema.plane import IntactRock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.pulse import axes_of
from jointwave.compare.exact.plane.waves import Kind, polarisations, slownesses_across

SCENE = Path(__file__).parent / "joints.toml"
BACK = 6.0  # m that SV waves begin before the domain, ahead of which they make P waves
ROOM = 4.0  # m of the domain, between the receivers, that joints may fill
RINGS = 6.0  # periods, extension of the record for waves between two joints
RETURNS = 12.0  # S waves from joint to joint, the least extension


class ParallelJoints(NamedTuple):
    """Joints in the order in which a wave meets them, their spacings (m), one less, and the period
    of the wave, s."""

    rock: IntactRock
    joints: list[Joint]
    spacings: np.ndarray
    period: float


def closed_form(series: ParallelJoints, incidence: Kind, angle: Values) -> np.ndarray:
    """Return the moduli R_p, R_s, T_p, T_s [4, ...]; angle : degrees, or an array of them."""
    rock, omega = elastic_rock(series.rock), 2 * pi / series.period
    at, laws, spacings = np.radians(angle), series.joints, series.spacings
    return np.abs(parallel_joints.coefficients(incidence, at, omega, rock, laws, spacings))


def scene_of(
    series: ParallelJoints, incidence: str, angle: float, changes: dict[str, Any] | None = None
) -> RockMass:
    """Return the scene of a wave at an angle (degrees), towards x from y, at joints about the
    middle, with dotted keys changed: that of `joints.toml`, as large as the P wave is long."""
    base: Any = load(SCENE)[0]
    was, rock, thick = elastic_rock(base.rock), elastic_rock(series.rock), series.spacings.sum()
    longer = series.period / base.waves[0].period
    larger = longer * float(rock.p_speed / was.p_speed)
    slower = max(1.0, float(rock.p_speed / rock.s_speed / (was.p_speed / was.s_speed)))
    (width, height), more = base.domain.size, max(0.0, thick - larger * ROOM)
    middle = (larger * height + more) / 2
    direction = [float(np.sin(np.radians(angle))), float(np.cos(np.radians(angle)))]
    own = RINGS * len(series.joints) / 2 * series.period  # their modes decay with their number
    rings = np.maximum(own, RETURNS * series.spacings / rock.s_speed)
    keys: dict[str, Any] = {
        "domain.size": [larger * width, 2 * middle],
        "rock": series.rock.model_dump(exclude_none=True),
        "waves.0.direction": direction,
        "waves.0.period": series.period,
        "time.duration": float(longer * slower * base.time.duration + rings.sum()),
        "numerics.dem.block": larger * base.numerics.dem.block,
        "record.points": [
            [larger * x, larger * y + more * (y > height / 2)] for x, y in base.record.points
        ],
    }
    if incidence == "SV":
        through = [-larger * BACK * x for x in direction]
        keys |= {"waves.0.kind": "S", "waves.0.through": through}
    depths = middle + np.append(0.0, np.cumsum(series.spacings)) - thick / 2
    areal = 4 * series.rock.density * middle  # 4 m of c_n = 2 zeta sqrt(m K_n), kg/m2
    keys["joint_sets"] = [
        {
            "name": f"joint {k}",
            "dip": 0.0,
            "through": [larger * width / 2, float(depth)],
            "normal_stiffness": one.normal_stiffness,
            "shear_stiffness": one.shear_stiffness,
            "damping_ratio": one.normal_viscosity / sqrt(areal * one.normal_stiffness) or None,
        }
        for k, (depth, one) in enumerate(zip(depths, series.joints, strict=True))
    ]
    return load(SCENE, keys | (changes or {}))[0]  # type: ignore[return-value]


def amplitudes(scene: RockMass, velocity: np.ndarray) -> list[float]:
    """Return the moduli R_p, R_s at the first joint, T_p, T_s at the last one, and the part of the
    motion that such waves do not explain, from the motion at the scene's points [m, n, (x, y)]
    (m/s), at the frequency of its pulse."""
    wave, rock = scene.waves[0], elastic_rock(scene.rock)
    omega = 2 * pi / float(wave.period or nan)
    kind: Kind = "P" if wave.kind == "P" else "SV"
    axes = axes_of(rock, kind, np.array(wave.direction), attitude(scene.joint_sets[0], 2)[0])
    p, across = axes.slowness, slownesses_across(rock, axes.slowness)
    waves = [int(np.argmax(axes.incident)), 2, 3, 0, 1]  # incident, reflected, transmitted
    modes = (polarisations(rock, p).reshape(4, 2) @ axes.rows)[waves]
    q = np.concatenate([across, -across])[waves]
    joints = np.array([one.through or [0.0, 0.0] for one in scene.joint_sets]) @ axes.rows[1]
    x, z = (np.array(scene.record.points) @ axes.rows.T).T
    front = z < joints.min()
    z = z - np.where(front, joints.min(), joints.max())
    phases = np.exp(1j * omega * (p * x[:, None] + np.outer(z, q)))
    there = np.where(front[:, None], [1, 1, 1, 0, 0], [0, 0, 0, 1, 1])
    matrix = np.einsum("mw,wc->mcw", np.where(there, phases, 0), modes).reshape(-1, 5)
    times = scene.interval * np.arange(velocity.shape[1])
    motion = (np.exp(1j * omega * times) @ velocity).ravel()
    found = np.linalg.lstsq(matrix, motion, rcond=None)[0]
    residual = np.linalg.norm(motion - matrix @ found) / np.linalg.norm(motion)
    return [*np.abs(found[1:] / found[0]).tolist(), float(residual)]
