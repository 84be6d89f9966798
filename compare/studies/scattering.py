"""Reflection and transmission of P and SV waves at joints, by every solver of rock masses.

Joints are horizontal and the wave is rotated, so that all angles have the same blocks and elements.
The joints' exact field enters through all sides; any error is the solver's own.
"""

from math import nan
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.material.rock import Values, elastic_rock
from jointwave.cases.read import load
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import Progress, applies, solve
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Coefficients, Joint
from jointwave.compare.exact.plane.pulse import axes_of
from jointwave.compare.exact.plane.waves import KINDS, Kind
from jointwave.compare.studies import store
from jointwave.compare.studies.scattered_waves import Scattered, scattered
from jointwave.compare.studies.store import DIED, FAILURES, Pool, Store, alone, reason_of

SCENE = Path(__file__).parent / "joints.toml"
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)  # degrees from the joints' normal
COUNTS, AT = (2, 3, 5), 30.0  # of parallel joints, at this angle, degrees
SPACING = 0.960768922830523  # m, a tenth of the P wavelength
BACK = 6.0  # m that SV waves begin before the domain, ahead of which they make P waves
COMPILED = 0.05  # s of compiling, above which a run is repeated for timing
RINGS = 0.012  # s, extension of the record per further joint, for waves between joints
#: The solvers of each study.
SOLVERS = {
    "oblique-joint": ("oblique-joint", "continuum-jointed", "dem"),
    "parallel-joints": ("parallel-joints", "continuum-jointed", "dem"),
}
TITLES = {
    "oblique-joint": "Reflection and transmission at one joint against the angle",
    "parallel-joints": "Reflection and transmission of parallel joints at 30 degrees",
}


class JointsPoint(NamedTuple):
    """A solver, a kind of wave, "P" or "SV", its angle from the joints' normal (degrees) and the
    number of joints."""

    solver: str
    incidence: str
    angle: float
    joints: int


class JointsRow(NamedTuple):
    """A solver's scattering of a wave at joints; nan if it does not apply.

    R_p to T_s : moduli of particle velocity over the incident one at the pulse's frequency, and
    exact_R_p to exact_T_s in closed form. error : the largest difference. residual : part of the
    motion not explained by plane waves. freedoms : of the blocks or the rock. cpu : CPU time of the
    run, including set-up but not compiling, s. state : "done" or "failed", with the reason.
    """

    solver: str
    incidence: str
    angle: float
    joints: int
    state: str
    message: str
    R_p: float = nan
    R_s: float = nan
    T_p: float = nan
    T_s: float = nan
    exact_R_p: float = nan
    exact_R_s: float = nan
    exact_T_p: float = nan
    exact_T_s: float = nan
    error: float = nan
    residual: float = nan
    freedoms: float = nan
    cpu: float = nan


def points(study: str, brief: bool = False) -> list[JointsPoint]:
    """Return the points of a study, solver by solver: one joint at all angles, or many at one.

    brief : only every other angle or number of joints.
    """
    one = study == "oblique-joint"
    places = [(x, 1) for x in ANGLES] if one else [(AT, count) for count in COUNTS]
    chosen = places[::2] if brief else places
    return [JointsPoint(name, k, *p) for name in SOLVERS[study] for k in KINDS for p in chosen]


def run(
    study: str,
    folder: Path | None,
    progress: Progress | None = None,
    brief: bool = False,
    pool: Pool | None = None,
) -> list[JointsRow]:
    """Return the rows of its points, in order; they are saved in `folder`. Their seconds are CPU
    time: as many points may run at a time as there are cores."""
    rows: Store[JointsRow] = Store(JointsRow, folder)
    wanted = points(study, brief)
    with alone():
        return rows.compute(
            wanted, key, measure, pool, progress, lost=lambda p: JointsRow(*p, "failed", DIED)
        )


def key(point: JointsPoint) -> str:
    """Return the key of a point: everything that determines its row."""
    return store.key(point._asdict(), load(SCENE)[0].model_dump_json())


def scene_of(
    incidence: str, angle: float, joints: int = 1, changes: dict[str, Any] | None = None
) -> RockMass:
    """Return the scene of a wave at an angle (degrees), towards x from y, and this number of joints
    about the middle, with dotted keys changed."""
    turned = np.radians(angle)
    direction = [float(np.sin(turned)), float(np.cos(turned))]
    keys: dict[str, Any] = {"waves.0.direction": direction}
    if incidence == "SV":
        keys |= {"waves.0.kind": "S", "waves.0.through": [-BACK * x for x in direction]}
    single = load(SCENE, keys)[0]
    (one,) = single.model_dump(exclude_none=True)["joint_sets"]
    keys["time.duration"] = single.time.duration + RINGS * (joints - 1)
    x, y = one["through"]
    depths = y + SPACING * (np.arange(joints) - (joints - 1) / 2)
    keys["joint_sets"] = [
        one | {"name": f"joint {k}", "through": [x, float(depth)]} for k, depth in enumerate(depths)
    ]
    return load(SCENE, keys | (changes or {}))[0]  # type: ignore[return-value]


def measure(point: JointsPoint) -> JointsRow:
    """Run a point and return its row; a point that fails gives a row with the reason."""
    scene = scene_of(point.incidence, point.angle, point.joints)
    exact = [float(x) for x in closed_form(scene)]
    try:
        if not (answer := applies(point.solver, scene)):
            return JointsRow(*point, "failed", answer.reason)
        result, cpu = _timed(point.solver, scene)
        if float(result.attrs.get("seconds_compile", 0.0)) > COMPILED:
            result, cpu = _timed(point.solver, scene)
    except FAILURES as error:
        return JointsRow(*point, "failed", reason_of(error))
    *found, residual = amplitudes(scene, result.velocity.values)
    off = max(abs(a - b) for a, b in zip(found, exact, strict=True))
    freedoms = float(result.attrs.get("degrees_of_freedom", nan))
    numbers = *found, *exact, off, residual, freedoms, cpu
    return JointsRow(*point, "done", "", *numbers)


def _timed(name: str, scene: RockMass) -> tuple[xr.Dataset, float]:
    began = process_time()
    return solve(name, scene), process_time() - began


def amplitudes(scene: RockMass, velocity: np.ndarray) -> Scattered:
    """Return the amplitudes scattered by a scene's joints, from the motion at its points [m, n,
    (x, y)] (m/s), at the frequency of its pulse."""
    wave, rock = scene.waves[0], elastic_rock(scene.rock)
    assert wave.period is not None
    dip = np.radians(scene.joint_sets[0].dip)
    axes = axes_of(rock, _kind(scene), np.array(wave.direction), dip)
    middle = np.mean([one.through or [0.0, 0.0] for one in scene.joint_sets], axis=0)
    places, omega = np.array(scene.record.points) - middle, 2 * np.pi / wave.period
    half = SPACING * (len(scene.joint_sets) - 1) / 2
    return scattered(rock, axes, places, velocity, scene.interval, omega, half)


def closed_form(scene: RockMass, angle: Values | None = None) -> Coefficients:
    """Return the moduli of such a scene in closed form; angle : of travel from the joints' normal,
    rad, or an array of them, None: that of its wave."""
    wave, rock = scene.waves[0], elastic_rock(scene.rock)
    assert wave.period is not None
    if angle is None:
        dip = np.radians(scene.joint_sets[0].dip)
        normal = np.array([-np.sin(dip), np.cos(dip)])
        angle = np.arccos(np.clip(abs(np.array(wave.direction) @ normal), 0, 1))
    joints = [Joint(one.normal_stiffness, one.shear_stiffness) for one in scene.joint_sets]  # type: ignore[arg-type]
    spacings, omega = np.full(len(joints) - 1, SPACING), 2 * np.pi / wave.period
    found = parallel_joints.coefficients(_kind(scene), angle, omega, rock, joints, spacings)
    return Coefficients(*(np.abs(x) for x in found))


def _kind(scene: RockMass) -> Kind:
    return "P" if scene.waves[0].kind == "P" else "SV"
