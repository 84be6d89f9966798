"""The constants of a run, with absent parts None, and how they follow from a scene."""

from typing import Any, NamedTuple

import numpy as np

from cases.loads import base_steps, load_history, step_means
from cases.material.calibrate import Properties, calibrate
from cases.sampling import Clock, Interpolation, clock, interpolation
from cases.schema.scene import Scene
from dem.axial.ends import build_end
from dem.axial.stability import critical_chain_step
from dem.axial.state import State, state_at_rest
from dem.size import refuse_large
from joints.laws import Law
from joints.uniform import law


class Receivers(NamedTuple):
    """Where the run is read: sections between contacts 0 .. N, points between block centres."""

    sections: Interpolation
    points: Interpolation


class Chain(NamedTuple):
    """The constants of one step.

    dt : s; mass : of a block, kg; area : m2.
    impulse_to_speed : dt / m, s/kg, less by mass-proportional damping.
    law : of the joints, per unit area; start, end : `dem.axial.ends.End` or None where free.
    keep : what mass-proportional damping leaves of a velocity in a step; None without.
    local : Cundall's damping; None without.
    weight : m g along y, N; None without gravity.
    steady : what a prestress always presses on the start and the end, N; None without.
    """

    dt: float
    mass: float
    area: float
    impulse_to_speed: float
    law: Law
    start: Any
    end: Any
    keep: Any
    local: Any
    weight: Any
    steady: Any


class Model(NamedTuple):
    """The constants of a run.

    load : float array, N, mean of the load over each step, cut after the last that acts.
    base : float array, m, the way of a shaken base in each step, against y (outward), the first
        the one before the run, cut after the last that moves; None where no base is shaken.
    """

    chain: Chain
    load: np.ndarray
    base: Any
    receivers: Receivers


def build(scene: Scene) -> tuple[Model, State, Clock, float]:
    """Return the model, the unloaded state at rest, the clock and the critical step (s)."""
    p = calibrate(scene)
    critical = critical_chain_step(p, scene.ends.start, scene.ends.end)
    numerics = scene.numerics.dem
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    refuse_large(scene, time)
    model = build_model(scene, p, time)
    return model, state_at_rest(model.chain, p.block_count, scene.record.energy), time, critical


def build_model(scene: Scene, p: Properties, time: Clock) -> Model:
    """Return the constants of a scene for a given clock."""
    along, count = scene.load.direction[1], time.steps + time.stride
    means, base = np.zeros(0), None
    if scene.load.shakes_base:
        base = _acting(np.append(0.0, -along * base_steps(scene, time.dt, count)))
    else:
        means = _acting(step_means(load_history(scene), time.dt, count))
    chain = build_chain(scene, p, time.dt, (scene.ends.start, scene.ends.end))
    return Model(chain, along * p.area * means, base, receivers(scene, p))


def build_chain(scene: Scene, p: Properties, dt: float, ends: tuple[str, str]) -> Chain:
    """Return the constants of one step dt (s) of blocks of these properties, held at these ends."""
    alpha, gravity = p.mass_damping, scene.gravity
    start, end = (build_end(kind, p, dt) for kind in ends)
    chain = Chain(
        dt=dt,
        mass=p.block_mass,
        area=p.area,
        impulse_to_speed=dt / p.block_mass,
        law=law(
            p.stiffness,
            p.joint_time_constant,
            p.tension,
            tensile_strength=p.tensile_strength,
            critical_opening=p.critical_opening,
        ),
        start=start,
        end=end,
        keep=None,
        local=p.local_damping,
        weight=p.block_mass * gravity.acceleration * gravity.direction[1] if gravity else None,
        steady=_steady(scene, p),
    )
    return chain if alpha is None else with_mass_damping(chain, alpha)


def with_mass_damping(chain: Chain, alpha: float) -> Chain:
    """Return the chain under a force -alpha m v (1/s) on every block, v the mean over the step.

    v+ = ((1 - a) v- + (dt / m) F) / (1 + a), a = alpha dt / 2.
    """
    a = alpha * chain.dt / 2
    push = chain.dt / chain.mass / (1 + a)
    return chain._replace(keep=(1 - a) / (1 + a), impulse_to_speed=push)


def _steady(scene: Scene, p: Properties) -> tuple[float, float] | None:
    if scene.prestress is None:
        return None
    force, ends = scene.prestress.normal * p.area, scene.ends
    return 0.0 if ends.start == "fixed" else force, 0.0 if ends.end == "fixed" else force


def _acting(values: np.ndarray) -> np.ndarray:
    """Return values up to the last that is not zero."""
    acting = np.flatnonzero(values)
    return values[: acting[-1] + 1] if acting.size else np.zeros(0)


def receivers(scene: Scene, p: Properties) -> Receivers:
    """Return where the scene records its blocks."""
    contacts = p.spacing * np.arange(p.block_count + 1)
    return Receivers(
        interpolation(contacts, scene.record.stress),
        interpolation(contacts[1:] - p.spacing / 2, scene.record.velocity),
    )
