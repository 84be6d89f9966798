"""Reflection and transmission of P and SV waves at joints, by every solver of rock masses.

The scenes of the waves, and what is read off their motion, are those of `joint_waves`.
"""

from math import nan
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.read import load
from jointwave.compare.engines import solve
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.waves import KINDS, Kind
from jointwave.compare.solvers.continuum import JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import store
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.joint_waves import (
    SCENE,
    ParallelJoints,
    amplitudes,
    closed_form,
    scene_of,
)

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)  # degrees from the joints' normal
COUNTS, AT = (2, 3, 5), 30.0  # of parallel joints, at this angle, degrees
SPACING = 0.960768922830523  # m, a tenth of the P wavelength
COMPILED = 0.05  # s of compiling, above which a run is repeated for timing
#: The studies, each of which has the name of its exact solution.
TITLES = {
    "oblique-joint": "Reflection and transmission at one joint against the angle",
    "parallel-joints": "Reflection and transmission of parallel joints at 30 degrees",
}


class JointsRow(NamedTuple):
    """A point of a study, and a solver's scattering of the wave at the joints there, nan until it
    is known.

    incidence : "P" or "SV". angle : of the wave from the joints' normal, degrees. joints : their
    number. R_p to T_s : moduli of particle velocity over the incident one at the pulse's frequency.
    error : the largest difference from the closed form. residual : part of the motion not explained
    by plane waves. freedoms : of the blocks or the rock. cpu : CPU time of the run, including
    set-up but not compiling, s.
    """

    solver: str
    incidence: Kind
    angle: float
    joints: int
    R_p: float = nan
    R_s: float = nan
    T_p: float = nan
    T_s: float = nan
    error: float = nan
    residual: float = nan
    freedoms: float = nan
    cpu: float = nan


def points(study: str, brief: bool = False) -> list[JointsRow]:
    """Return the points of a study, solver by solver: one joint at all angles, or many at one.

    brief : only every other angle or number of joints.
    """
    one = study == "oblique-joint"
    places = [(x, 1) for x in ANGLES] if one else [(AT, count) for count in COUNTS]
    solvers = study, JOINTED_ROCK.name, DEM.name
    return [
        JointsRow(name, kind, *place)
        for name in solvers
        for kind in KINDS
        for place in places[:: 2 if brief else 1]
    ]


def planned(study: str, folder: Path, brief: bool = False) -> list[Run]:
    """Return the runs of the points that are not saved yet."""
    left = store.Store(JointsRow, folder).missing(points(study, brief), key)
    scenes = [scene_of(joints_of(one.joints), one.incidence, one.angle) for one in left]
    return [Run(study, scene, one.solver) for one, scene in zip(left, scenes, strict=True)]


def key(point: JointsRow) -> str:
    """Return the key of a point: everything that determines its row."""
    return store.key(point[:4], load(SCENE)[0].model_dump_json())


def joints_of(count: int) -> ParallelJoints:
    """Return this number of the joints of `joints.toml`, a tenth of the P wave apart."""
    base: Any = load(SCENE)[0]
    (one,), period = base.joint_sets, base.waves[0].period
    joint = Joint(one.normal_stiffness, one.shear_stiffness)
    return ParallelJoints(base.rock, [joint] * count, np.full(count - 1, SPACING), period)


def measure(point: JointsRow) -> JointsRow:
    """Run a point and return its row; raises the errors of `solve`."""
    joints, incidence, angle = joints_of(point.joints), point.incidence, point.angle
    scene = scene_of(joints, incidence, angle)
    for _ in range(2):
        began = process_time()
        result = solve(point.solver, scene)
        cpu = process_time() - began
        if float(result.attrs.get("seconds_compile", 0.0)) <= COMPILED:
            break
    *found, residual = amplitudes(scene, result.velocity.values)
    off = float(np.abs(found - closed_form(joints, incidence, angle)).max())
    freedoms = float(result.attrs.get("degrees_of_freedom", nan))
    numbers = *found, off, residual, freedoms, cpu
    return JointsRow(*point[:4], *numbers)
