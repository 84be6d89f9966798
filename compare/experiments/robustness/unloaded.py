"""Blocks or rock set in motion without a load, and stepped at will."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cases.material.calibrate import calibrate
from cases.sampling import Clock
from cases.schema.scene import Scene
from compare.solvers.record import Solver


class FreeMotion(NamedTuple):
    """A body in motion.

    v : float array [freedoms], m/s. advance : takes so many steps.
    """

    v: np.ndarray
    advance: Callable[[int], None]


class Unloaded(NamedTuple):
    """What an engine steps of a scene without a load.

    mass : float array [freedoms], in any unit. second : the second block's freedoms along the axis.
    begin : of (dt, velocities [freedoms]), to the motion by steps of dt (s) from these on.
    """

    mass: np.ndarray
    second: np.ndarray
    begin: Callable[[float, np.ndarray], FreeMotion]


def unloaded(engine: Solver, scene: Scene) -> Unloaded:
    """Return what an engine steps of a scene whose load is zero, by explicit steps."""
    return _blocks(scene) if engine.has_rigid_blocks else _rock(scene, str(engine.model))


def _blocks(scene: Scene) -> Unloaded:
    from dem.axial.leapfrog import march
    from dem.axial.model import build_model
    from dem.axial.state import state_at_rest

    p = calibrate(scene)

    def begin(dt: float, v: np.ndarray) -> FreeMotion:
        model = build_model(scene, p, Clock(dt, 1, 2))
        state = state_at_rest(model.effects, p.block_count, False)
        state.v[:] = v
        if state.gap_rate is not None:
            state.gap_rate[:] = np.diff(v)
        return FreeMotion(state.v, lambda steps: march(model, state, 0, steps))

    return Unloaded(np.ones(p.block_count), np.array([1]), begin)


def _rock(scene: Scene, kind: str) -> Unloaded:
    from continuum.build import build_model, discretise, receivers
    from continuum.explicit.march import run
    from continuum.state import empty_samples, state_at_rest

    discrete, d = discretise(scene, kind), scene.pillar.block
    body, read = discrete.body, receivers(scene, discrete)

    def begin(dt: float, v: np.ndarray) -> FreeMotion:
        model = build_model(scene, discrete, kind, Clock(dt, 1, 2), read)
        state = state_at_rest(model, False)
        state.v[:] = state.v_before[:] = v
        samples = empty_samples(model, state, 2)
        # No step of these is one of a sample.
        return FreeMotion(state.v, lambda n: run(model, state, samples, n + 2, 1, n + 1))

    heights = body.corners[:, :, 0].mean(axis=1)
    nodes = np.unique(body.cells[(heights > d) & (heights < 2 * d)])
    return Unloaded(body.mass, body.freedom(nodes, 0), begin)
