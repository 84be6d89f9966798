"""Reflection and transmission of a wave at parallel joints in rock, against its angle: in closed
form (`parallel_joints`), or from a solver's motion in a scene of the same rock and joints.

In that scene joints are horizontal and the wave is rotated, so that all angles have the same blocks
and elements. The exact field of the joints enters through all sides; any error is the solver's own.

At one frequency the motion of each half-space is a sum of plane waves with the same slowness p
along the joints (`compare.exact.plane.waves`): the incident and both reflected waves in front of
the joints, both transmitted waves behind. With the factor e^{-i omega t} and coordinates (x, z)
along and across the joints,

    V(x, z) = sum of A g e^{i omega (p x +- q z)},   V = int v e^{i omega t} dt

is a linear system for the amplitudes A, two equations per point, solved by least squares. The
speeds are those of the intact rock. V is the trapezoidal sum, exact for pulses that end within the
record and have no content above half the sampling frequency.
"""

from collections.abc import Sequence
from itertools import product
from math import inf, nan, pi, sqrt
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError, require
from jointwave.cases.material.rock import Values, elastic_rock
from jointwave.cases.read import load as scenes_of
from jointwave.cases.schema.rock_mass import IntactRock, RockMass
from jointwave.compare.engines import Progress, names, solve
from jointwave.compare.exact.plane import parallel_joints, waves
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.rock_mass.conditions import all_parallel, linear_rock
from jointwave.compare.exact.rock_mass.stack import stack_of
from jointwave.compare.readings.recordings import variables
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.solvers.record import Answer

SCENE = Path(__file__).parent / "joints.toml"
BACK = 6.0  # m by which SV waves start before the domain: the P waves that they make run ahead
ROOM = 4.0  # m between the receivers, available for joints
RINGS = 6.0  # periods by which the record is extended for each pair of joints
RETURNS = 12.0  # least extension, in S travel times from joint to joint
EXACT = "exact"
NONE = "has no transmission by angle"
WAVES = {"R_p": "reflected P", "R_s": "reflected S", "T_p": "transmitted P", "T_s": "transmitted S"}


class ParallelJoints(NamedTuple):
    """Joints in the order in which a wave meets them, spacings between them, m, wave period, s."""

    rock: IntactRock
    joints: list[Joint]
    spacings: np.ndarray
    period: float


def transmission(
    scene: AnySource,
    angles: float | Sequence[float] | np.ndarray = 0.0,
    solvers: str | Sequence[str] = EXACT,
    incidence: Literal["P", "S", "SV"] = "P",
    frequency: float | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Return |R_p|, |R_s|, |T_p| and |T_s| [solver, angle] of a scene's parallel joints: particle
    velocity of the reflected and transmitted P and S waves over that of the incident wave.

    Rock and joints are those of the scene; its domain, waves and receivers do not matter.
    `residual` is the part of the motion that these waves do not explain, nan in closed form.

    Parameters
    ----------
    scene : see `load`.
    angles : of travel from the joints' normal, degrees, 0 to below 90.
    solvers : "exact", the closed form; "dem", "continuum-jointed", ..., a run for each angle.
    incidence : "P", "S" or "SV"; the last two mean the same in the plane.
    frequency : Hz; None: one over the period of the scene's first pulse.
    progress : called with the finished fraction.

    Raises SceneError for a pillar, and unless joints are linear, parallel and cut all the rock.
    """
    scene, wanted = load(scene), [solvers] if isinstance(solvers, str) else list(solvers)
    try:
        degrees = np.atleast_1d(np.asarray(angles, dtype=float))
    except (TypeError, ValueError):
        degrees = np.array([nan])
    there = degrees.ndim == 1 and bool(((degrees >= 0) & (degrees < 90)).all())
    allowed = "must be from 0 to below 90 degrees from the joints' normal"
    _require(incidence in ("S", *waves.KINDS), "incidence", incidence, "must be 'P', 'S' or 'SV'")
    _require(there, "angles", angles, allowed)
    for name in wanted:
        known = [EXACT, *names()]
        _require(name in known, "solvers", name, f"must be of {', '.join(known)}")
    if scene.is_column:
        raise SceneError(scene.where, "", None, f"{NONE}: it is a pillar")
    kind: waves.Kind = "P" if incidence == "P" else "SV"
    joints, rows = _joints_of(scene, frequency), list[list[float]]()
    points = list(product(wanted, degrees.tolist()))
    for k, (name, angle) in enumerate(points):
        if name == EXACT:
            rows.append([*closed_form(joints, kind, angle).tolist(), nan])
        else:
            trial = scene_of(joints, kind, angle, {"title": scene.title})
            rows.append(amplitudes(trial, solve(name, trial).velocity.values))
        if progress:
            progress((k + 1) / len(points))
    found = np.reshape(np.transpose(rows), (5, len(wanted), len(degrees)))
    said = {name: f"{words} wave over the incident one" for name, words in WAVES.items()}
    said |= {"residual": "part of the motion that plane waves do not explain"}
    named = {name: (x, said[name], "1") for name, x in zip(said, found, strict=True)}
    at = variables("angle", {"angle": (degrees, "angle from the joints' normal", "degrees")})
    about = {"incidence": incidence, "frequency": 1 / joints.period, "scene": scene.title}
    return xr.Dataset(variables(("solver", "angle"), named), {"solver": wanted, **at}, about)


def _require(right: bool, key: str, value: object, allowed: str) -> None:
    if not right:
        raise SceneError("transmission", key, value, allowed)


def _joints_of(scene: RockMass, frequency: float | None) -> ParallelJoints:
    """Return the parallel joints of a rock mass for a frequency, Hz; None: that of the scene's
    first pulse. Raises SceneError if joints are not in series."""
    answer = Answer.unless(
        (scene.in_space, "it is in space"),
        (not scene.joint_sets, "there is no joint"),
        (bool(scene.regions), "regions differ in rock"),
        (bool(scene.domain.holes), "openings cut the joints"),
        (not all_parallel(scene), "joints are not parallel"),
    ) and linear_rock(scene)
    if not answer:
        raise SceneError(scene.where, "", None, f"{NONE}: {answer.reason}")
    if frequency is None:
        periods = [found for one in scene.pulses if (found := getattr(one, "period", None))]
        if not periods:
            allowed = "no pulse has one: give frequency, in Hz"
            raise SceneError(scene.where, "period", None, allowed)
        period = periods[0]
    else:
        require(frequency, int | float, "transmission", "frequency", "a number, Hz")
        _require(0 < frequency < inf, "frequency", frequency, "must be positive, Hz")
        period = 1 / frequency
    stack = stack_of(scene)
    kept = [k for k, one in enumerate(stack.joints) if one.normal_stiffness]  # no free face
    joints, spacings = [stack.joints[k] for k in kept], np.diff(stack.offsets[kept])
    return ParallelJoints(scene.rock, joints, spacings, period)


def closed_form(series: ParallelJoints, incidence: waves.Kind, angle: Values) -> np.ndarray:
    """Return the moduli R_p, R_s, T_p, T_s [4, ...]; angle : degrees, or an array of them."""
    rock, omega = elastic_rock(series.rock), 2 * pi / series.period
    at, laws, spacings = np.radians(angle), series.joints, series.spacings
    return np.abs(parallel_joints.coefficients(incidence, at, omega, rock, laws, spacings))


def scene_of(
    series: ParallelJoints, incidence: str, angle: float, changes: dict[str, Any] | None = None
) -> RockMass:
    """Return `joints.toml` scaled to the P wavelength, with these joints about its middle, a wave
    at an angle (degrees from y towards x), and dotted keys changed."""
    base: Any = scenes_of(SCENE)[0]
    was, rock, thick = elastic_rock(base.rock), elastic_rock(series.rock), series.spacings.sum()
    longer = series.period / base.waves[0].period
    larger = longer * float(rock.p_speed / was.p_speed)
    slower = max(1.0, float(rock.p_speed / rock.s_speed / (was.p_speed / was.s_speed)))
    (width, height), more = base.domain.size, max(0.0, thick - larger * ROOM)
    middle = (larger * height + more) / 2
    direction = [float(np.sin(np.radians(angle))), float(np.cos(np.radians(angle)))]
    own = RINGS * len(series.joints) / 2 * series.period  # modes of more joints decay more slowly
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
    return scenes_of(SCENE, keys | (changes or {}))[0]  # type: ignore[return-value]


def amplitudes(scene: RockMass, velocity: np.ndarray) -> list[float]:
    """Return the moduli R_p, R_s at the first joint, T_p, T_s at the last joint, and the part of
    the motion that these waves do not explain, at the frequency of the scene's pulse.

    velocity : at the scene's points [m, n, (x, y)], m/s.
    """
    wave, rock = scene.waves[0], elastic_rock(scene.rock)
    omega = 2 * pi / float(wave.period or nan)
    kind: waves.Kind = "P" if wave.kind == "P" else "SV"
    axes = waves.axes_of(rock, kind, np.array(wave.direction), scene.joint_sets[0].normal)
    p, across = axes.slowness, waves.slownesses_across(rock, axes.slowness)
    which = [int(np.argmax(axes.incident)), 2, 3, 0, 1]  # incident, reflected, transmitted
    modes = (waves.polarisations(rock, p).reshape(4, 2) @ axes.rows)[which]
    q = np.concatenate([across, -across])[which]
    joints = np.array([one.through or [0.0, 0.0] for one in scene.joint_sets]) @ axes.rows[1]
    x, z = (scene.places["points"] @ axes.rows.T).T
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
