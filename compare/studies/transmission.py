"""Reflection and transmission at the joints of a scene against the angle of a wave.

Of a rock mass in closed form (`parallel_joints`), or by a solver's motion in a scene of the same
rock and joints (`joint_waves`). Of a pillar at normal incidence alone, for its soft layers in the
homogenised bar: a solver's coefficients are the spectra with the layers over those without, of one
wavelet between matched ends.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import product
from math import nan, pi

import numpy as np
import xarray as xr

from jointwave.cases.checks.scene import checked
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.rock import ElasticRock
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import Progress, solve
from jointwave.compare.exact.conditions import holds
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.waves import KINDS, Kind
from jointwave.compare.exact.rock_mass.conditions import all_parallel, beyond_linear_rock
from jointwave.compare.exact.rock_mass.stack import stack_of
from jointwave.compare.readings.attenuation import sampling, variables
from jointwave.compare.scenes import AnySource, load
from jointwave.compare.studies.joint_waves import (
    RETURNS,
    RINGS,
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
    incidence: Kind = "P",
    frequency: float | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Return |R_p|, |R_s|, |T_p| and |T_s| [solver, angle] of a scene's parallel joints: particle
    velocity of the reflected and transmitted P and S waves over that of the incident wave.

    Rock and joints are those of the scene; its domain, waves and receivers do not matter. Of a
    pillar these are its soft layers. `residual` is the part of the motion that these waves do not
    explain, nan where none is read.

    Parameters
    ----------
    scene : as `load` takes it.
    angles : of travel from the joints' normal, degrees, 0 to below 90; of a pillar 0.
    solvers : "exact", the closed form; "dem", "continuum-jointed", ..., a run for each angle.
    incidence : "P" or "SV".
    frequency : Hz; None: one over the period of the scene's first pulse.
    progress : called with the finished fraction.

    Raises SceneError for joints that are not linear, parallel and through all rock.
    """
    scene, names = load(scene), [solvers] if isinstance(solvers, str) else list(solvers)
    try:
        degrees = np.atleast_1d(np.asarray(angles, dtype=float))
    except (TypeError, ValueError):
        degrees = np.array([nan])
    if incidence not in KINDS:
        raise SceneError("transmission", "incidence", incidence, "must be 'P' or 'SV'")
    if degrees.ndim != 1 or not ((degrees >= 0) & (degrees < 90)).all():
        allowed = "must be from 0 to below 90 degrees from the joints' normal"
        raise SceneError("transmission", "angles", angles, allowed)
    period, rows = _period(scene, frequency), list[list[float]]()
    if isinstance(scene, Scene):
        if degrees.any() or incidence != "P":
            allowed = "must be 0, with incidence 'P': it is a pillar"
            raise SceneError(scene.where, "angles", angles, allowed)
        measure: Callable[[str, float], list[float]] = partial(_of_pillar, scene, period)
    else:
        measure = partial(_of_rock_mass, _joints_of(scene, period), scene.title, incidence)
    points = list(product(names, degrees.tolist()))
    for k, point in enumerate(points):
        rows.append(measure(*point))
        if progress:
            progress((k + 1) / len(points))
    found = np.reshape(np.transpose(rows), (5, len(names), len(degrees)))
    said = {name: f"{words} wave over the incident one" for name, words in WAVES.items()}
    said |= {"residual": "part of the motion that plane waves do not explain"}
    named = {name: (x, said[name], "1") for name, x in zip(said, found, strict=True)}
    angle = variables("angle", {"angle": (degrees, "angle from the joints' normal", "degrees")})
    about = {"incidence": incidence, "frequency": 1 / period, "scene": scene.title}
    return xr.Dataset(variables(("solver", "angle"), named), {"solver": names, **angle}, about)


def _period(scene: AnyScene, frequency: float | None) -> float:
    """Return the period of the wave, s."""
    if frequency is not None:
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
        (not scene.joint_sets, "there is no joint"),
        (bool(scene.regions), "regions differ in rock"),
        (bool(scene.domain.holes), "openings cut the joints"),
        (not all_parallel(scene), "joints are not parallel"),
    ]
    why = beyond_linear_rock(scene) or next((why for there, why in reasons if there), None)
    if why:
        raise SceneError(scene.where, "", None, f"{NONE}: {why}")
    stack = stack_of(scene)
    kept = [k for k, one in enumerate(stack.joints) if one.normal_stiffness]  # no free face
    joints, spacings = [stack.joints[k] for k in kept], np.diff(stack.offsets[kept])
    return ParallelJoints(scene.rock, joints, spacings, period)


def _of_rock_mass(
    joints: ParallelJoints, title: str, incidence: Kind, solver: str, angle: float
) -> list[float]:
    """Return R_p, R_s, T_p, T_s and the residual by one solver at one angle, degrees."""
    if solver == EXACT:
        return [*closed_form(joints, incidence, angle).tolist(), nan]
    trial = scene_of(joints, incidence, angle, {"title": title})
    return amplitudes(trial, solve(solver, trial).velocity.values)


def _of_pillar(scene: Scene, period: float, solver: str, angle: float) -> list[float]:
    """Return R_p, R_s, T_p, T_s and the residual of a pillar's soft layers by one solver."""
    p = calibrate(scene)
    (at,) = np.nonzero(p.excess_compliance)
    if not at.size:
        raise SceneError(scene.where, "soft_layers", None, "no joint differs from the others")
    trial = _between_matched_ends(scene, p.contact_y, at + 1, RETURNS / p.bar_speed, period)
    if not (answer := holds(trial, ("soft layers", "damped joints"))):
        raise SceneError(scene.where, "", None, f"{NONE}: {answer.reason}")
    if solver == EXACT:
        eta = 0.0 if p.joint_time_constant is None else p.joint_time_constant[at]
        stiffness = 1 / p.excess_compliance[at]
        laws = [Joint(K, K, c) for K, c in zip(stiffness, stiffness * eta, strict=True)]
        rock, spacings = ElasticRock(p.density, p.bar_speed, p.shear_speed), np.diff(p.joint_y[at])
        found = parallel_joints.coefficients("P", 0.0, 2 * pi / period, rock, laws, spacings)
        return [*np.abs(found).tolist(), nan]
    without = trial.model_copy(update={"soft_layers": []})
    there, incident = (solve(solver, one).stress for one in (trial, checked(without)))
    turns = np.exp(-2j * pi / period * sampling(incident) * np.arange(incident.sizes["time"]))
    whole, plain = there.values @ turns, incident.values @ turns
    return [abs(whole[0] / plain[0] - 1), 0.0, abs(whole[1] / plain[1]), 0.0, nan]


def _between_matched_ends(
    scene: Scene, contact_y: np.ndarray, at: np.ndarray, ring: float, period: float
) -> Scene:
    """Return a pillar under a wavelet from one matched end to the other, with a receiver halfway
    before its soft layers and one behind them.

    at : contacts of the layers. ring : time for which waves between them are recorded, s/m.
    """
    before, after = contact_y[at[0] // 2], contact_y[(at[-1] + len(contact_y)) // 2]
    left_out = {"name", "expect", "source", "gravity", "prestress", "motion"}
    tables = scene.model_dump(exclude_unset=True, exclude=left_out)
    pulse = {"shape": "ricker", "amplitude": 1e3, "period": period, "quantity": "incident-stress"}
    duration = ring * (contact_y[-1] + np.ptp(contact_y[at])) + 2 * RINGS * period
    changes = {"load": pulse, "ends": {"start": "matched", "end": "matched"}}
    changes |= {"time": {"duration": duration}, "record": {"stress": [before, after]}}
    return load(tables | changes)  # type: ignore[return-value]
