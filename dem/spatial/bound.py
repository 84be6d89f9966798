"""How fast blocks in space can become at most: what their run is held to."""

import numpy as np

from cases.material.calibrate import Properties
from cases.sampling import Clock
from cases.schema.scene import Scene
from dem.axial.bound import shaking
from dem.spatial.layout import STRIDE, unpacked
from dem.spatial.model import Model, State
from numerics.divergence import speed_that


def highest_speeds(
    scene: Scene, p: Properties, model: Model, state: State, time: Clock
) -> np.ndarray:
    """Return a bound on each component of the velocity of any block [freedoms], m/s and rad/s; with
    finite rotations kg m2/s for the angular momentum."""
    m, motion = p.block_mass, model.motion
    inertia = np.array([m] * 3 + list(motion.inertia or ()))
    with np.errstate(over="ignore"):
        bound = np.sqrt(m / inertia) * _speed(scene, p, model, state, time, inertia)
        if motion.finite is not None:
            bound[3:] = inertia[3:].max() * bound[3:].max()
    return bound


def _speed(
    scene: Scene, p: Properties, model: Model, state: State, time: Clock, inertia: np.ndarray
) -> float:
    """Return the bound for a block's velocity, m/s."""
    m, duration = p.block_mass, time.dt * (time.steps + time.stride)
    weight = np.zeros(3) if model.weight is None else model.weight
    push = np.linalg.norm(model.load.direction / np.sqrt(m * inertia))
    base = None if model.load.base is None else model.load.base
    return speed_that(
        time.dt * (np.abs(model.load.stress) * push).sum(),
        duration * _steady(scene, p) / m,
        duration * np.sqrt(p.block_count) * np.linalg.norm(weight) / m,
        np.sqrt(p.block_count) * shaking(base, time.dt),
        _stored(scene, p, model, state, weight) / np.sqrt(m),
    )


def _steady(scene: Scene, p: Properties) -> float:
    """Return what a prestress presses on ends that give way, N."""
    if scene.prestress is None:
        return 0.0
    return 2 * abs(scene.prestress.normal) * p.area


def _stored(scene: Scene, p: Properties, model: Model, state: State, weight: np.ndarray) -> float:
    """Return a bound on the root of twice the energy stored at the start, sqrt(J).

    Of a prestress that of all springs; of a static state under gravity at most what the weight has
    done on its way there. The roots add up, for the energy is a norm of the displacement.
    """
    moved = unpacked(state.motion, STRIDE, p.block_count)[:3].sum(axis=1)
    stored = np.sqrt(2 * np.abs(weight * moved).sum())
    if scene.prestress is None:
        return float(stored)
    softness = (1 / p.stiffness).sum() + 1 / p.regular_stiffness  # the ends' springs as well
    return float(stored + abs(scene.prestress.normal) * np.sqrt(p.area * softness))
