"""Reflection and transmission at the joints of a rock mass against the angle of a wave: in closed
form (`parallel_joints`), or by a solver's motion in a scene of the same rock and joints
(`joint_waves`).
"""

from collections.abc import Sequence
from itertools import product
from math import nan
from typing import Literal

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError, require
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import Progress, names, solve
from jointwave.compare.exact.plane.waves import KINDS, Kind
from jointwave.compare.exact.rock_mass.conditions import all_parallel, beyond_linear_rock
from jointwave.compare.exact.rock_mass.stack import stack_of
from jointwave.compare.readings.attenuation import variables
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.studies.joint_waves import (
    ParallelJoints,
    amplitudes,
    closed_form,
    scene_of,
)

EXACT = "exact"
NONE = "has no transmission by angle"
WAVES = {"R_p": "reflected P", "R_s": "reflected S", "T_p": "transmitted P", "T_s": "transmitted S"}


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
    `residual` is the part of the motion that these waves do not explain, nan where none is read.

    Parameters
    ----------
    scene : as `load` takes it.
    angles : of travel from the joints' normal, degrees, 0 to below 90.
    solvers : "exact", the closed form; "dem", "continuum-jointed", ..., a run for each angle.
    incidence : "P", or "S" or "SV", which in the plane are one.
    frequency : Hz; None: one over the period of the scene's first pulse.
    progress : called with the finished fraction.

    Raises SceneError for a pillar, and joints that are not linear, parallel and through all rock.
    """
    scene, wanted = load(scene), [solvers] if isinstance(solvers, str) else list(solvers)
    try:
        degrees = np.atleast_1d(np.asarray(angles, dtype=float))
    except (TypeError, ValueError):
        degrees = np.array([nan])
    if incidence not in ("S", *KINDS):
        raise SceneError("transmission", "incidence", incidence, "must be 'P', 'S' or 'SV'")
    if degrees.ndim != 1 or not ((degrees >= 0) & (degrees < 90)).all():
        allowed = "must be from 0 to below 90 degrees from the joints' normal"
        raise SceneError("transmission", "angles", angles, allowed)
    for name in wanted:
        if name not in (known := [EXACT, *names()]):
            allowed = f"must be of {', '.join(known)}"
            raise SceneError("transmission", "solvers", name, allowed)
    if scene.is_column:
        raise SceneError(scene.where, "", None, f"{NONE}: it is a pillar")
    kind: Kind = "P" if incidence == "P" else "SV"
    joints, rows = _joints_of(scene, _period(scene, frequency)), list[list[float]]()
    points = list(product(wanted, degrees.tolist()))
    for k, point in enumerate(points):
        rows.append(_measured(joints, scene.title, kind, *point))
        if progress:
            progress((k + 1) / len(points))
    found = np.reshape(np.transpose(rows), (5, len(wanted), len(degrees)))
    said = {name: f"{words} wave over the incident one" for name, words in WAVES.items()}
    said |= {"residual": "part of the motion that plane waves do not explain"}
    named = {name: (x, said[name], "1") for name, x in zip(said, found, strict=True)}
    angle = variables("angle", {"angle": (degrees, "angle from the joints' normal", "degrees")})
    about = {"incidence": incidence, "frequency": 1 / joints.period, "scene": scene.title}
    return xr.Dataset(variables(("solver", "angle"), named), {"solver": wanted, **angle}, about)


def _period(scene: AnyScene, frequency: float | None) -> float:
    """Return the period of the wave, s."""
    if frequency is not None:
        require(frequency, int | float, "transmission", "frequency", "a number, Hz")
        if not 0 < frequency < np.inf:
            raise SceneError("transmission", "frequency", frequency, "must be positive, Hz")
        return 1 / frequency
    periods = [found for one in scene.pulses if (found := getattr(one, "period", None))]
    if not periods:
        raise SceneError(scene.where, "period", None, "no pulse has one: give frequency, in Hz")
    return periods[0]


def _joints_of(scene: RockMass, period: float) -> ParallelJoints:
    """Return the joints of a rock mass; raises SceneError where they are no series of joints."""
    reasons = [
        (scene.in_space, "it is in space"),
        (not scene.joint_sets, "there is no joint"),
        (bool(scene.regions), "regions differ in rock"),
        (bool(scene.domain.holes), "openings cut the joints"),
        (not all_parallel(scene), "joints are not parallel"),
    ]
    why = next((why for there, why in reasons if there), None) or beyond_linear_rock(scene)
    if why:
        raise SceneError(scene.where, "", None, f"{NONE}: {why}")
    stack = stack_of(scene)
    kept = [k for k, one in enumerate(stack.joints) if one.normal_stiffness]  # no free face
    joints, spacings = [stack.joints[k] for k in kept], np.diff(stack.offsets[kept])
    return ParallelJoints(scene.rock, joints, spacings, period)


def _measured(
    joints: ParallelJoints, title: str, incidence: Kind, solver: str, angle: float
) -> list[float]:
    """Return R_p, R_s, T_p, T_s and the residual by one solver at one angle, degrees."""
    if solver == EXACT:
        return [*closed_form(joints, incidence, angle).tolist(), nan]
    trial = scene_of(joints, incidence, angle, {"title": title})
    return amplitudes(trial, solve(solver, trial).velocity.values)
