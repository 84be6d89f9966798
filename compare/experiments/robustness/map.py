"""The stability map: step over critical step against damping ratio, computed cell by cell.

With all dashpots eta times their springs the mode of the largest frequency omega decides. Its
damping ratio is zeta = eta omega / 2, and in x = omega dt / 2, the step over the undamped critical
one, the critical step of `numerics.critical_step` reads x = sqrt(1 + 4 zeta^2) - 2 zeta.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

import cases
from cases.kinds import pillar_of
from cases.material.calibrate import calibrate
from cases.sampling import Clock
from cases.schema.scene import Scene
from compare.engines import ENGINES
from compare.experiments.robustness.case import SHORT
from compare.scenes import find
from compare.solvers.record import Solver

if TYPE_CHECKING:
    from continuum.model import Model

#: Velocities [freedoms], m/s, and what takes a number of steps, in which they change.
FreeMotion = tuple[np.ndarray, Callable[[int], object]]


class Unloaded(NamedTuple):
    """The stepped part of an engine for a scene without a load.

    mass : float array [freedoms], in any unit. second : the second block's freedoms along the axis.
    begin : of (dt, velocities [freedoms]), to the motion by steps of dt (s) from these on.
    """

    mass: np.ndarray
    second: np.ndarray
    begin: Callable[[float, np.ndarray], FreeMotion]


def unloaded(engine: Solver, scene: Scene) -> Unloaded:
    """Return an engine's explicit stepping of a scene with zero load."""
    return _blocks(scene) if engine.has_rigid_blocks else _rock(scene, str(engine.model))


def _blocks(scene: Scene) -> Unloaded:
    from dem.axial.leapfrog import arguments, loop_for
    from dem.axial.model import build_model
    from dem.axial.samples import buffers
    from dem.axial.state import state_at_rest

    p = calibrate(scene)

    def begin(dt: float, v: np.ndarray) -> FreeMotion:
        model = build_model(scene, p, Clock(dt, 1, 2))
        state = state_at_rest(model.effects, p.block_count, False)
        state.v[:] = v
        if state.gap_rate is not None:
            state.gap_rate[:] = np.diff(v)
        # Gathered once: a loose block is advanced 160,000 times.
        loop = loop_for(model.effects._replace(ledger=False))
        given = arguments(model, state, buffers(model, state, 0), None)
        return state.v, lambda steps: loop(given, 0, steps, -1, 1)

    return Unloaded(np.ones(p.block_count), np.array([1]), begin)


def _rock(scene: Scene, kind: str) -> Unloaded:
    from continuum.build import build_model, discretise, receivers
    from continuum.explicit.march import march, readings
    from continuum.state import empty_samples, state_at_rest

    discrete, d = discretise(scene, kind), scene.pillar.block
    body, read = discrete.body, receivers(scene, discrete)

    def model_of(dt: float) -> Model:
        return build_model(scene, discrete, kind, Clock(dt, 1, 2), read)

    first = model_of(1.0)
    unread = readings(first, state_at_rest(first, False))  # of any step, as no sample is taken

    def begin(dt: float, v: np.ndarray) -> FreeMotion:
        model = model_of(dt)
        state = state_at_rest(model, False)
        state.v[:] = state.v_before[:] = v
        samples = empty_samples(model, state, 2)
        take = march(model, state, samples, NEVER, None, read=unread)
        return state.v, lambda n: take(1, n + 1)

    heights = body.corners[:, :, 0].mean(axis=1)
    nodes = np.unique(body.cells[(heights > d) & (heights < 2 * d)])
    return Unloaded(body.mass, body.freedom(nodes, 0), begin)


#: The scene: a short pillar with free ends; Rayleigh's beta is the eta of rock and joints.
PILLAR = {
    "pillar.length": 4.0,
    "numerics.continuum.elements_per_block": 1,
    "record.stress": [1.0],
    "record.velocity": [],
    "record.energy": False,
    "load.amplitude": 0.0,
}
STEPS = 3000
#: A stable mode is amplified by 1 / sqrt(1 - (x / x_c)^2) at most, 1e3 at 5e-7 below the line.
BOUND = 1e3
CELLS = 40
NEVER = 1 << 30  # steps from one sample to the next: none is taken


class StabilityMap(NamedTuple):
    """The stability of an engine in every cell.

    ratio : float array [m], damping ratio of the highest mode; step : [n], over the undamped
    critical one; both at the centres of the cells, in equal ratios. stable : bool array [n, m].
    """

    engine: str
    ratio: np.ndarray
    step: np.ndarray
    stable: np.ndarray

    @property
    def wrong(self) -> np.ndarray:
        """Cells [n, m] that differ from theory at their centres."""
        return self.stable != (self.step[:, None] < boundary(self.ratio))

    @property
    def far(self) -> np.ndarray:
        """Wrong cells further than one cell from the boundary."""
        grow = self.step[1] / self.step[0]
        below, above = (boundary(self.ratio) * f for f in (grow**-1.5, grow**1.5))
        near = (self.step[:, None] > below) & (self.step[:, None] < above)
        return self.wrong & ~near


def boundary(ratio: np.ndarray) -> np.ndarray:
    """Return the critical step over the undamped one at damping ratios of the highest mode."""
    return 1 / (np.sqrt(1 + 4 * ratio**2) + 2 * ratio)


def make_map(engine: str, cells: int = CELLS) -> StabilityMap:
    """Return the map of an engine."""
    ratio, step = np.geomspace(1e-3, 10, cells), np.geomspace(0.02, 2, cells)
    critical = ENGINES[engine].prepare(_scene(0.0)).critical
    stable = np.zeros((cells, cells), dtype=bool)
    for j, zeta in enumerate(ratio):
        body = unloaded(ENGINES[engine], _scene(zeta * critical))  # eta = 2 zeta / omega
        stable[:, j] = [_is_stable(body, x * critical) for x in step]
    return StabilityMap(engine, ratio, step, stable)


def _scene(beta: float) -> Scene:
    """Return the pillar with dashpots of this time constant, s.

    Ratios in proportion to frequencies leave Rayleigh's alpha zero.
    """
    damped = {"damping.rayleigh": {"frequencies": [1.0, 2.0], "ratios": [pi * beta, 2 * pi * beta]}}
    return pillar_of(cases.load_variant(find(SHORT), "", PILLAR | (damped if beta else {})))


def _is_stable(body: Unloaded, dt: float) -> bool:
    """Return whether no speed exceeds the bound; most that do are found in few steps."""
    motion, few = _random_motion(body, dt), STEPS // 20
    return all(_speed_after(motion, steps) < BOUND for steps in (few, STEPS - few))


def _random_motion(body: Unloaded, dt: float) -> FreeMotion:
    """Return the motion by steps of dt (s) from random speeds of 1 m/s at most."""
    start, moves = np.zeros(body.mass.size), body.mass > 0
    start[moves] = np.random.default_rng(0).uniform(-1, 1, moves.sum())
    return body.begin(dt, start)


def _speed_after(motion: FreeMotion, steps: int) -> float:
    """Return the largest speed (m/s) after more steps, infinite where one is NaN."""
    v, advance = motion
    advance(steps)
    return float(np.nan_to_num(np.abs(v).max(), nan=np.inf))
