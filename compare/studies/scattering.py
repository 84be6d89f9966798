"""Reflection and transmission of P and SV waves at joints, by every solver of rock masses.

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

from math import nan, pi
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.rock import Values, elastic_rock
from jointwave.cases.read import load
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import solve
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.pulse import axes_of
from jointwave.compare.exact.plane.waves import KINDS, Kind, polarisations, slownesses_across
from jointwave.compare.solvers.continuum import JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import store

SCENE = Path(__file__).parent / "joints.toml"
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)  # degrees from the joints' normal
COUNTS, AT = (2, 3, 5), 30.0  # of parallel joints, at this angle, degrees
SPACING = 0.960768922830523  # m, a tenth of the P wavelength
BACK = 6.0  # m that SV waves begin before the domain, ahead of which they make P waves
COMPILED = 0.05  # s of compiling, above which a run is repeated for timing
RINGS = 0.012  # s, extension of the record per further joint, for waves between joints
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
    incidence: str
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


def key(point: JointsRow) -> str:
    """Return the key of a point: everything that determines its row."""
    return store.key(point[:4], load(SCENE)[0].model_dump_json())


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


def measure(point: JointsRow) -> JointsRow:
    """Run a point and return its row; raises the errors of `solve`."""
    place = point[1:4]
    scene = scene_of(*place)
    for _ in range(2):
        began = process_time()
        result = solve(point.solver, scene)
        cpu = process_time() - began
        if float(result.attrs.get("seconds_compile", 0.0)) <= COMPILED:
            break
    *found, residual = amplitudes(scene, result.velocity.values)
    off = float(np.abs(found - closed_form(*place)).max())
    freedoms = float(result.attrs.get("degrees_of_freedom", nan))
    numbers = *found, off, residual, freedoms, cpu
    return JointsRow(*point[:4], *numbers)


def amplitudes(scene: RockMass, velocity: np.ndarray) -> list[float]:
    """Return the moduli R_p, R_s at the first joint, T_p, T_s at the last one, and the part of the
    motion that such waves do not explain, from the motion at the scene's points [m, n, (x, y)]
    (m/s), at the frequency of its pulse."""
    wave, rock, omega = scene.waves[0], elastic_rock(scene.rock), _frequency(scene)
    kind: Kind = "P" if wave.kind == "P" else "SV"
    axes = axes_of(rock, kind, np.array(wave.direction), np.radians(scene.joint_sets[0].dip))
    p, across = axes.slowness, slownesses_across(rock, axes.slowness)
    waves = [int(np.argmax(axes.incident)), 2, 3, 0, 1]  # incident, reflected, transmitted
    modes = (polarisations(rock, p).reshape(4, 2) @ axes.rows)[waves]
    q = np.concatenate([across, -across])[waves]
    middle = np.mean([one.through or [0.0, 0.0] for one in scene.joint_sets], axis=0)
    x, z = ((np.array(scene.record.points) - middle) @ axes.rows.T).T
    half, front = SPACING * (len(scene.joint_sets) - 1) / 2, z < 0
    z = z + np.where(front, half, -half)
    phases = np.exp(1j * omega * (p * x[:, None] + np.outer(z, q)))
    there = np.where(front[:, None], [1, 1, 1, 0, 0], [0, 0, 0, 1, 1])
    matrix = np.einsum("mw,wc->mcw", np.where(there, phases, 0), modes).reshape(-1, 5)
    times = scene.interval * np.arange(velocity.shape[1])
    motion = (np.exp(1j * omega * times) @ velocity).ravel()
    found = np.linalg.lstsq(matrix, motion, rcond=None)[0]
    residual = np.linalg.norm(motion - matrix @ found) / np.linalg.norm(motion)
    return [*np.abs(found[1:] / found[0]).tolist(), float(residual)]


def closed_form(incidence: str, angle: Values, joints: int = 1) -> np.ndarray:
    """Return the moduli R_p, R_s, T_p, T_s [4, ...] in closed form; angle : degrees, or an array of
    them."""
    scene = scene_of(incidence, 0.0, joints)
    laws = [Joint(one.normal_stiffness, one.shear_stiffness) for one in scene.joint_sets]  # type: ignore[arg-type]
    rock, spacings = elastic_rock(scene.rock), np.full(joints - 1, SPACING)
    at, omega = np.radians(angle), _frequency(scene)
    return np.abs(parallel_joints.coefficients(incidence, at, omega, rock, laws, spacings))  # type: ignore[arg-type]


def _frequency(scene: RockMass) -> float:
    """Return the angular frequency of a scene's pulse, rad/s."""
    return 2 * pi / float(scene.waves[0].period or nan)
