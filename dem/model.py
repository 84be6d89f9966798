"""The constants of a run, and what changes in it, as two objects; absent parts are None."""

from math import cos, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from cases.calibrate import Properties, calibrate
from cases.loads import load_history, step_means
from cases.sampling import Clock, Interpolation, clock, interpolation
from cases.scene import Scene
from dem.ends import build_end, end_state, end_stiffness
from joints.laws import Law
from joints.stability import critical_step, critical_step_of_modes
from joints.uniform import law


class Receivers(NamedTuple):
    """Where the run is read: sections between contacts 0 .. N, points between block centres."""

    sections: Interpolation
    points: Interpolation


class Chain(NamedTuple):
    """The constants of one step.

    dt : s; impulse_to_speed : dt / m, s/kg; area : m2.
    law : of the joints, per unit area; start, end : `dem.ends.End` or None where free.
    """

    dt: float
    impulse_to_speed: float
    area: float
    law: Law
    start: Any
    end: Any


class Model(NamedTuple):
    """The constants of a run.

    load : float array, N, mean of the load over each step, cut after the last that acts.
    """

    chain: Chain
    load: np.ndarray
    receivers: Receivers


class Ledger(NamedTuple):
    """Running sums of the work of every force that is not elastic.

    sums : viscous, boundary, work, J; forces : start, end and load force of the last step, N.
    dashpots : each joint's dashpot force at the last step, N; None without dashpots.
    """

    sums: np.ndarray
    forces: np.ndarray
    dashpots: Any


class State(NamedTuple):
    """What changes: displacement u at the step, velocity v half a step before it.

    gap_rate : each joint's one and a half steps before, m/s; None without dashpots.
    start, end : [closure, reaction] of the ends, None where free. ledger : None when not kept.
    """

    u: np.ndarray
    v: np.ndarray
    gap_rate: Any
    start: Any
    end: Any
    ledger: Any


def build(scene: Scene) -> tuple[Model, State, Clock, float]:
    """Return the model, the state at rest, the clock and the critical step (s) of a scene."""
    p = calibrate(scene)
    critical = critical_chain_step(p, scene.ends.start, scene.ends.end)
    numerics = scene.numerics.dem
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    model = build_model(scene, p, time)
    return model, state_at_rest(model, p.block_count, scene.record.energy), time, critical


def build_model(scene: Scene, p: Properties, time: Clock) -> Model:
    """Return the constants of a scene for a given clock."""
    means = step_means(load_history(scene), time.dt, time.steps + time.stride)
    contacts = p.spacing * np.arange(p.block_count + 1)
    chain = Chain(
        dt=time.dt,
        impulse_to_speed=time.dt / p.block_mass,
        area=p.area,
        law=law(p.stiffness, p.joint_time_constant, p.tension),
        start=build_end(scene.ends.start, p, time.dt),
        end=build_end(scene.ends.end, p, time.dt),
    )
    receivers = Receivers(
        interpolation(contacts, scene.record.stress),
        interpolation(contacts[1:] - p.spacing / 2, scene.record.velocity),
    )
    acting = np.flatnonzero(means)
    load = p.area * means[: acting[-1] + 1] if acting.size else np.zeros(0)
    return Model(chain, load, receivers)


def state_at_rest(model: Model, block_count: int, keep_ledger: bool) -> State:
    """Return the state at rest, with no array for anything that the model does not have."""
    damped = model.chain.law.normal_viscosity is not None
    ledger = None
    if keep_ledger:
        dashpots = np.zeros(block_count - 1) if damped else None
        ledger = Ledger(np.zeros(3), np.zeros(3), dashpots)
    return State(
        u=np.zeros(block_count),
        v=np.zeros(block_count),
        gap_rate=np.zeros(block_count - 1) if damped else None,
        start=end_state(model.chain.start),
        end=end_state(model.chain.end),
        ledger=ledger,
    )


def critical_chain_step(p: Properties, start: str, end: str) -> float:
    """Return the critical step (s) of a chain: exact, from its largest eigenvalue with dashpots."""
    alike = (p.stiffness == p.stiffness[0]).all() and not p.damps_alone.any()
    if alike and {start, end} <= {"free", "quiet"}:
        rigid = 2 * sqrt(p.stiffness[0] * p.area / p.block_mass)
        omega = rigid * cos(pi / (2 * p.block_count))
        return critical_step_of_modes(omega, p.time_constant or 0.0)

    from scipy.linalg import eigh_tridiagonal  # slow to import: only for chains that need it

    k = p.stiffness * p.area
    c = k * (0.0 if p.joint_time_constant is None else p.joint_time_constant)
    ends = np.zeros(p.block_count)
    ends[0], ends[-1] = end_stiffness(start, p), end_stiffness(end, p)

    def largest(a: float, b: float) -> float:
        joints = a * k + b * c
        diagonal = a * ends
        diagonal[:-1] += joints
        diagonal[1:] += joints
        last = (p.block_count - 1,) * 2
        top = eigh_tridiagonal(diagonal, -joints, True, select="i", select_range=last)
        return top[0] / p.block_mass

    return critical_step(largest, p.joint_time_constant is not None)
