"""Scenes of plane waves in densely jointed rock, as waves of its effective medium.

A wave is that of the medium (`cases.material.effective_medium`) along the direction that the scene
gives, at its own speed: the fastest for P, the slowest for S, with the polarisation nearest to the
scene's. `quantity = "stress"` is the traction on its front, rho c v. Where joints cross, it enters
all engines through their quiet sides, since the rock beyond is jointed too and transmits no wave of
intact rock: the solution is exact for the homogenised rock, and approximate for the jointed one if
wavelengths are large compared with the spacings.

Valid for any crossing sets of linear joints without dashpots, in undamped rock with sides through
which waves leave, from rest: at t = 0 no pulse may have begun within the domain.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from cases.histories import LoadHistory
from cases.incident import WaveMotion
from cases.loads import history_of
from cases.material.effective_medium import compliant, speeds, stiffness, tensor
from cases.material.rock import elastic_rock
from cases.sampling import sample_times
from cases.schema.rock_mass import RockMass
from cases.schema.sources import Wave
from compare.exact.rock_mass.conditions import (
    all_parallel,
    beyond_linear_rock,
    prestress_of,
    reflecting_side,
)
from compare.solvers.record import BAR, YES, Answer, Form, Kind, Rock, Solver, Words, no, thin
from results.plane import plane_fields


@dataclass(frozen=True)
class MediumWave:
    """A plane wave of a medium: unit direction and polarisation; speed, m/s; `through`, a point of
    its front at t = 0, m; stress at 1 m/s (xx, yy, xy), Pa, tension positive; its pulse."""

    direction: np.ndarray
    polarisation: np.ndarray
    speed: float
    through: np.ndarray
    stress: np.ndarray
    pulse: LoadHistory

    def lateness(self, points: np.ndarray) -> np.ndarray:
        """Return the time at which the pulse begins at points [m, 2], s."""
        return (np.asarray(points) - self.through) @ self.direction / self.speed


@dataclass(frozen=True)
class MediumField:
    """The waves of a scene in the effective medium of its joints."""

    waves: tuple[MediumWave, ...]
    whole: bool

    def __call__(self, points: np.ndarray, times: np.ndarray) -> WaveMotion:
        total = [np.zeros((len(points), count, len(times))) for count in (2, 3)]
        for wave in self.waves:
            f = wave.pulse.value(np.asarray(times) - wave.lateness(points)[:, None])
            for sum_, shape in zip(total, (wave.polarisation, wave.stress), strict=True):
                sum_ += f[:, None] * shape[:, None]
        return WaveMotion(*total)


def medium_field(scene: RockMass) -> MediumField:
    """Return the waves of a scene in its effective medium; all its sets must have a spacing."""
    C = medium_stiffness(scene)
    waves = tuple(medium_wave(scene, one, C) for one in scene.waves)
    return MediumField(waves, reflecting_side(scene) is None)


def medium_stiffness(scene: RockMass) -> np.ndarray:
    """Return the stiffness of the medium in Voigt's form [3, 3], Pa."""
    return stiffness(elastic_rock(scene.rock), compliant(scene.joint_sets))


def medium_wave(scene: RockMass, wave: Wave, C: np.ndarray) -> MediumWave:
    """Return a wave of a scene in a medium of stiffness C (Pa, Voigt's form)."""
    n, density = np.array(wave.direction), scene.rock.density
    found, shapes = speeds(C, density, n)
    branch = 1 if wave.kind == "P" else 0
    c, g = float(found[branch]), shapes[:, branch]
    g = g * np.sign(g @ (n if wave.kind == "P" else [-n[1], n[0]]))
    full = np.einsum("ijkl,k,l->ij", tensor(C), g, n) / c
    corners = np.array(scene.domain.corners)
    through = corners[np.argmin(corners @ n)] if wave.through is None else np.array(wave.through)
    over = density * c if wave.quantity == "stress" else 1.0
    pulse = history_of(wave, wave.amplitude / over)
    return MediumWave(n, g, c, through, -full[[0, 1, 0], [0, 1, 1]], pulse)


def applies(scene: RockMass) -> Answer:
    """Return whether the scene has waves in an effective medium only."""
    gravity = scene.gravity is not None and bool(scene.gravity.acceleration)
    reasons = [
        (not scene.waves, "no wave enters"),
        (bool(scene.loads), "a load acts"),
        (gravity, "gravity acts"),
        (bool(scene.domain.holes), "the domain has openings"),
        (not scene.joint_sets, "there is no joint"),
        (bool(scene.regions), "regions differ in rock"),
        (all_parallel(scene), "joints are parallel: see parallel-joints"),
        (any(one.spacing is None for one in scene.joint_sets), "a joint has no spacing"),
        (any(one.damping_ratio for one in scene.joint_sets), "the joints are damped"),
    ]
    reason = next((why for there, why in reasons if there), None)
    reason = reason or beyond_linear_rock(scene) or reflecting_side(scene)
    if reason is None:
        corners = np.array(scene.domain.corners)
        first = min(one.lateness(corners).min() for one in medium_field(scene).waves)
        if first < -1e-9 * scene.time.duration:
            reason = "a pulse is inside the domain before t = 0"
    return no(reason) if reason else YES


def solve(scene: RockMass) -> xr.Dataset:
    """Return velocity, displacement and stress at the points of a scene."""
    times, points = sample_times(scene), np.array(scene.record.points).reshape(-1, 2)
    field = medium_field(scene)
    velocity, stress = field(points, times)
    moved = np.zeros_like(velocity)
    for wave in field.waves:
        u = wave.pulse.impulse(times - wave.lateness(points)[:, None])
        moved += u[:, None] * wave.polarisation[:, None]
    values = {
        "velocity": velocity.swapaxes(1, 2),
        "displacement": moved.swapaxes(1, 2),
        "stress": prestress_of(scene) - stress.swapaxes(1, 2),
    }
    return xr.Dataset(*plane_fields(scene, SOLVER.name, times, values))


SOLVER = Solver(
    name="effective-medium",
    rock=Rock.HOMOGENISED,
    form=Form.CLOSED,
    kinds=("rock mass",),
    dimension=2,
    words=Words(BAR, "effective medium, exact", "等效介质（精确解）"),
    line=thin("#005a3c", 6, (9, 13), (7, 2, 1.2, 4)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {
            "continuum-equivalent": "elements and time stepping of the homogenised rock"
        },
        Kind.MODELLING: {
            "continuum-jointed": "joints smeared over the rock",
            "dem": "rigid blocks with every joint instead of homogenised rock",
        },
    },
)
