"""One joint under P and SV waves at many angles, by every solver: amplitudes and their cost.

The joint lies level and the wave is turned, so that all angles have the same blocks and elements.
Its exact field enters through all sides; what is wrong is the solver's own.
"""

from __future__ import annotations

from math import nan
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cases.material.rock import Values, elastic_rock
from cases.read import load
from compare.engines import Progress, applies, solve
from compare.exact.plane.oblique_joint import Coefficients, Joint, coefficients
from compare.exact.plane.pulse import Pulse, axes_of
from compare.exact.plane.waves import KINDS, Kind
from compare.experiments import store
from compare.experiments.failures import FAILURES, reason_of
from compare.experiments.pool import Pool, alone
from compare.experiments.scattering.extraction import Scattered, scattered
from compare.experiments.store import Store

if TYPE_CHECKING:
    import xarray as xr

    from cases.schema.rock_mass import RockMass

SCENE = Path(__file__).parent / "one-joint.toml"
SOLVERS = ("oblique-joint", "continuum-jointed", "dem")
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)  # degrees from the joint's normal
BACK = 6.0  # m that SV waves begin before the domain, ahead of which they make P waves
COMPILED = 0.05  # s of compiling, above which a run is made once more to be timed
RATE = "angle of incidence"  # what the seconds of points are remembered by


class AnglePoint(NamedTuple):
    """A solver, a kind of wave, "P" or "SV", and its angle from the joint's normal, degrees."""

    solver: str
    incidence: str
    angle: float


class AngleRow(NamedTuple):
    """What a solver makes of a wave at one angle; nan where it does not apply.

    R_p to T_s : moduli of particle velocity over the incident one at the pulse's frequency, and
    exact_R_p to exact_T_s in closed form. error : the largest difference. residual : of the
    motion, what no plane waves make up. freedoms : of the blocks or the rock. cpu : of the run,
    its set-up included but no compiling, s of processors. state : "done" or "failed", for what
    reason.
    """

    solver: str
    incidence: str
    angle: float
    state: str
    message: str
    R_p: float
    R_s: float
    T_p: float
    T_s: float
    exact_R_p: float
    exact_R_s: float
    exact_T_p: float
    exact_T_s: float
    error: float
    residual: float
    freedoms: float
    cpu: float


def points() -> list[AnglePoint]:
    """Return the points of the study, solver by solver."""
    return [AnglePoint(one, kind, x) for one in SOLVERS for kind in KINDS for x in ANGLES]


def run(
    folder: Path | None, pool: Pool | None = None, progress: Progress | None = None
) -> list[AngleRow]:
    """Return the rows of all points, in order, one at a time since their seconds count; they are
    saved in `folder`."""
    rows: Store[AngleRow] = Store(AngleRow, folder)
    with alone():
        return rows.compute(points(), key, measure, None, progress, RATE)


def key(point: AnglePoint) -> str:
    """Return what tells points apart: everything that decides a row."""
    return store.key(point._asdict(), SCENE.read_text(encoding="utf-8"))


def scene_of(incidence: str, angle: float, changes: dict[str, Any] | None = None) -> RockMass:
    """Return the scene of a wave at an angle (degrees), towards x from y, with dotted keys
    changed."""
    turned = np.radians(angle)
    direction = [float(np.sin(turned)), float(np.cos(turned))]
    keys: dict[str, Any] = {"waves.0.direction": direction}
    if incidence == "SV":
        keys |= {"waves.0.kind": "S", "waves.0.through": [-BACK * x for x in direction]}
    scene = load(SCENE, keys | (changes or {}))[0]
    assert scene.kind == "rock mass"
    return scene  # type: ignore[return-value]


def measure(point: AnglePoint) -> AngleRow:
    """Run a point and return its row; what cannot be run is a row that says why."""
    scene = scene_of(point.incidence, point.angle)
    exact = closed_form(scene)
    try:
        answer = applies(point.solver, scene)
        if not answer:
            return _row(point, "failed", answer.reason, exact)
        result, cpu = _timed(point.solver, scene)
        if float(result.attrs.get("seconds_compile", 0.0)) > COMPILED:
            result, cpu = _timed(point.solver, scene)
    except FAILURES as error:
        return _row(point, "failed", reason_of(error), exact)
    found = amplitudes(scene, result.velocity.values)
    freedoms = float(result.attrs.get("degrees_of_freedom", nan))
    return _row(point, "done", "", exact, found, freedoms, cpu)


def _timed(name: str, scene: RockMass) -> tuple[xr.Dataset, float]:
    """Return the result of a solver and the seconds of processors that it took."""
    began = process_time()
    result = solve(name, scene)
    return result, process_time() - began


def amplitudes(scene: RockMass, velocity: np.ndarray) -> Scattered:
    """Return what the motion at the points of such a scene [m, n, (x, y)] (m/s) says of its joint,
    at the frequency of its pulse."""
    wave, one, rock = scene.waves[0], scene.joint_sets[0], elastic_rock(scene.rock)
    assert wave.period is not None and one.through is not None
    kind: Kind = "P" if wave.kind == "P" else "SV"
    axes = axes_of(rock, Pulse(kind, np.array(wave.direction), np.zeros(1)), np.radians(one.dip))
    places = np.array(scene.record.points) - np.array(one.through)
    omega = 2 * np.pi / wave.period
    return scattered(rock, axes, places, velocity, scene.interval, omega)


def closed_form(scene: RockMass, angle: Values | None = None) -> Coefficients:
    """Return the moduli of such a scene in closed form; angle : of travel from the joint's normal,
    rad, or an array of them, None: that of its wave."""
    wave, one, rock = scene.waves[0], scene.joint_sets[0], elastic_rock(scene.rock)
    assert wave.period is not None and one.normal_stiffness and one.shear_stiffness
    if angle is None:
        normal = np.array([-np.sin(np.radians(one.dip)), np.cos(np.radians(one.dip))])
        angle = np.arccos(np.clip(abs(np.array(wave.direction) @ normal), 0, 1))
    joint = Joint(one.normal_stiffness, one.shear_stiffness)
    omega = 2 * np.pi / wave.period
    found = coefficients("P" if wave.kind == "P" else "SV", angle, omega, rock, joint)
    return Coefficients(*(np.abs(x) for x in found))


def _row(
    point: AnglePoint,
    state: str,
    message: str,
    exact: Coefficients,
    found: Scattered | None = None,
    freedoms: float = nan,
    cpu: float = nan,
) -> AngleRow:
    values = [nan] * 4 if found is None else [*found[:4]]
    off = max(abs(a - float(b)) for a, b in zip(values, exact, strict=True))
    residual = nan if found is None else found.residual
    numbers = *values, *map(float, exact), off, residual, freedoms, cpu
    return AngleRow(*point, state, message, *numbers)
