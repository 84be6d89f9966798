"""The stability map: step over critical step against damping ratio, computed cell by cell.

With all dashpots eta times their springs the mode of the largest frequency omega decides. Its
damping ratio is zeta = eta omega / 2, and in x = omega dt / 2, the step over the undamped critical
one, the critical step of `joints.stability` reads x = sqrt(1 + 4 zeta^2) - 2 zeta.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import NamedTuple

import numpy as np

import cases
from cases.material.calibrate import calibrate
from cases.sampling import Clock
from cases.schema.scene import Scene
from compare.engines import ENGINES, Progress
from compare.scenes import find

#: What is stepped: a short pillar with free ends; Rayleigh's beta is the eta of rock and joints.
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
        """Cells [n, m] that are not what theory says of their centres."""
        return self.stable != (self.step[:, None] < boundary(self.ratio))

    @property
    def far(self) -> np.ndarray:
        """Wrong cells that the boundary does not pass within one cell of."""
        grow = self.step[1] / self.step[0]
        below, above = (boundary(self.ratio) * f for f in (grow**-1.5, grow**1.5))
        near = (self.step[:, None] > below) & (self.step[:, None] < above)
        return self.wrong & ~near


def boundary(ratio: np.ndarray) -> np.ndarray:
    """Return the critical step over the undamped one at damping ratios of the highest mode."""
    return 1 / (np.sqrt(1 + 4 * ratio**2) + 2 * ratio)


def make_map(engine: str, cells: int = CELLS, progress: Progress | None = None) -> StabilityMap:
    """Return the map of an engine."""
    ratio, step = np.geomspace(1e-3, 10, cells), np.geomspace(0.02, 2, cells)
    one = ENGINES[engine]
    prepare = _blocks if one.has_rigid_blocks else _rock(str(one.model))
    _, critical = prepare(_scene(0.0))
    stable = np.zeros((cells, cells), dtype=bool)
    for j, zeta in enumerate(ratio):
        growth, _ = prepare(_scene(zeta * critical))  # eta = 2 zeta / omega = zeta dt_c
        stable[:, j] = [growth(x * critical) < BOUND for x in step]
        if progress:
            progress((j + 1) / cells)
    return StabilityMap(engine, ratio, step, stable)


def _scene(beta: float) -> Scene:
    """Return the pillar with dashpots of this time constant, s.

    Ratios in proportion to frequencies leave Rayleigh's alpha zero.
    """
    damped = {"damping.rayleigh": {"frequencies": [1.0, 2.0], "ratios": [pi * beta, 2 * pi * beta]}}
    return cases.load_variant(find("hard/short-pillar"), "", PILLAR | (damped if beta else {}))


Growth = Callable[[float], float]


def _blocks(scene: Scene) -> tuple[Growth, float]:
    """Return the growth of rigid blocks by the step (s), and their critical step, s."""
    from dem.axial.leapfrog import march
    from dem.axial.model import build_model
    from dem.axial.stability import critical_chain_step
    from dem.axial.state import state_at_rest

    p = calibrate(scene)

    def growth(dt: float) -> float:
        model = build_model(scene, p, Clock(dt, 1, 2))
        state = state_at_rest(model.effects, p.block_count, False)
        state.v[:] = _random(state.v.size)
        if state.gap_rate is not None:
            state.gap_rate[:] = np.diff(state.v)
        march(model, state, 0, STEPS)
        return _largest(state.v)

    return growth, critical_chain_step(p, scene.ends.start, scene.ends.end)


def _rock(kind: str) -> Callable[[Scene], tuple[Growth, float]]:
    """Return what gives the growth of rock by the step (s), and its critical step, s."""
    from continuum.build import build_model, critical_step_of, discretise
    from continuum.explicit.march import run
    from continuum.state import empty_samples, state_at_rest

    def prepare(scene: Scene) -> tuple[Growth, float]:
        discrete = discretise(scene, kind)

        def growth(dt: float) -> float:
            model = build_model(scene, discrete, kind, Clock(dt, STEPS, 1))
            state = state_at_rest(model, False)
            moves = model.rock.mass > 0
            state.v[moves] = _random(moves.sum())
            state.v_before[:] = state.v
            run(model, state, empty_samples(model, state, 1), STEPS, 0, STEPS)
            return _largest(state.v)

        return growth, critical_step_of(scene, discrete, kind)

    return prepare


def _random(size: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, size)


def _largest(v: np.ndarray) -> float:
    return float(np.nan_to_num(np.abs(v).max(), nan=np.inf))
