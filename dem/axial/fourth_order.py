"""Steps of fourth order of the undamped chain, composed as `dem.composition` says."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from jointwave.cases.loads import load_history, until_it_ends
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.scene import Scene
from jointwave.dem.axial.build import unloaded
from jointwave.dem.axial.model import Model
from jointwave.dem.axial.samples import Samples
from jointwave.dem.axial.springs import spring_forces
from jointwave.dem.axial.stability import critical_chain_step
from jointwave.dem.axial.state import State, state_at_rest
from jointwave.dem.composition import DRIFTS, INSTANTS, stability_limit
from jointwave.dem.composition import KICKS as OF_STAGES
from jointwave.dem.size import refuse_large, refuse_too_many
from jointwave.dem.static import stiffest
from jointwave.joints.energy import elastic_energy
from jointwave.joints.formula import formula
from jointwave.joints.law import law_of
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.divergence import EVERY, SPEED, Guard, guard, out_of_bounds
from jointwave.numerics.jit import jitted
from jointwave.numerics.sums import total_of

KICKS = OF_STAGES[1:]

#: When drifts begin and end, and when kicks act, in steps from the start of the step.
EDGES = np.append(INSTANTS, 1.0)


class Composition(NamedTuple):
    """The constants of one step.

    drifts : float array [5], s; kicks : [4], s/kg, velocity for a unit of force.
    loads : float array [n, 4], N, at the kicks of every step, cut after the last that acts.
    impulses : float array [n, 5], N s, of the load during each drift, likewise.
    """

    drifts: np.ndarray
    kicks: np.ndarray
    loads: np.ndarray
    impulses: np.ndarray


def build(scene: Scene) -> tuple[Model, State, Clock, float]:
    """Return the model at an instant, the unloaded state, the clock and the critical step (s).

    The model at an instant has a step of no length, and the load at whole steps.
    """
    refuse_too_many(scene)
    p, numerics, ends = calibrate(scene), scene.numerics.dem, (scene.ends.start, scene.ends.end)
    critical = stability_limit() / 2 * critical_chain_step(stiffest(scene, p), *ends)
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    refuse_large(scene, time, stages=1 + len(EDGES))
    at_steps = time.dt * np.arange(time.steps + time.stride)
    load = _unit_force(scene) * load_history(scene).value(at_steps)
    model = unloaded(scene, p, 0.0, ends)._replace(load=until_it_ends(load))
    state = state_at_rest(model.effects, p.block_count, scene.record.energy)
    return model, state, time, critical


def compose(scene: Scene, time: Clock) -> Composition:
    """Return the constants of one step of this clock."""
    load, dt, force = load_history(scene), time.dt, _unit_force(scene)
    edges = dt * (np.arange(time.steps + time.stride)[:, None] + EDGES)
    return Composition(
        drifts=dt * DRIFTS,
        kicks=dt * KICKS / calibrate(scene).block_mass,
        loads=until_it_ends(force * load.value(edges[:, 1:-1])),
        impulses=until_it_ends(force * np.diff(load.impulse(edges), axis=1)),
    )


def _unit_force(scene: Scene) -> float:
    """Return the force of a unit of load, along y, m2."""
    return scene.load.direction[1] * scene.pillar.area


def make_stepper(
    composition: Composition,
    model: Model,
    state: State,
    samples: Samples,
    stride: int,
    monitor: Guard | None = None,
) -> Callable[[int, int], None]:
    """Return a function that takes samples first .. last - 1, `stride` steps apart, the steps after
    each included.

    monitor : stops a run that exceeds its bounds; None without.
    """
    limits, every = (guard(0.0), 0) if monitor is None else (monitor, EVERY)
    given = Packed(
        model.chain, model.laws, *composition, model.load,
        *model.receivers.sections, *model.receivers.points,
        state.u, state.v, state.force, state.start, state.end, state.work, *samples,
        limits.limit.view(np.float64)[0], limits.found, every,
    )  # fmt: skip
    loop = loop_for(model.effects._replace(ledger=state.work is not None))
    return lambda first, last: loop(given, first * stride, last * stride, first, stride)


@cache
def loop_for(effects):
    """Return the time loop of chains with these effects; absent ones are not compiled.

    It takes steps first .. last - 1, and sample s at step s * stride, and periodically checks that
    the speeds are within bounds.
    """
    parts, gravity, ledger = effects.joints, effects.gravity, effects.ledger
    varied, start_held, end_held = parts.varied, effects.start, effects.end

    @formula
    def steps(
        c, laws, drifts, kicks, loads, impulses, load, left, right, weight, before, after, share,
        u, v, force, start, end, work, stress, velocity, displacement, energy, squares,
        limit, found, every, first, last, s, stride,
    ):  # fmt: skip
        setting = flush_denormals()
        tail, law = u.size - 1, law_of(laws, 0)
        due = first + every if first + every < last else last
        for n in range(first, last):
            if n == s * stride:
                spring_forces(parts, c.area, laws, u, force, force)
                start[1], end[1] = c.start.stiffness * start[0], c.end.stiffness * end[0]
                force[0] = (load[n] if n < load.size else 0.0) + c.start_force + start[1]
                force[tail + 1] = end[1] + c.end_force
                for i in range(left.size):
                    f = (1.0 - weight[i]) * force[left[i]] + weight[i] * force[right[i]]
                    stress[i, s] = f / c.area
                for i in range(before.size):
                    a, b, w = before[i], after[i], share[i]
                    velocity[i, s] = (1.0 - w) * v[a] + w * v[b]
                    displacement[i, s] = (1.0 - w) * u[a] + w * u[b]
                if ledger:
                    in_ends = 0.5 * start[1] * start[0] + 0.5 * end[1] * end[0]
                    if n == 0:
                        work[0] = -in_ends
                    energy[2, s], energy[3, s] = 0.0, in_ends + work[0]
                    energy[energy.shape[0] - 1, s] = work[1]
                    for j in range(tail + 1):
                        squares[j] = v[j] * v[j]
                    energy[0, s] = 0.5 * c.mass * total_of(squares)
                    for j in range(tail):
                        if varied:
                            law = law_of(laws, j)
                        squares[j] = elastic_energy(law, parts, u[j + 1] - u[j], 0.0, 0.0, 0.0)
                    squares[tail] = 0.0
                    energy[1, s] = c.area * total_of(squares)
                    if gravity:
                        energy[energy.shape[0] - 2, s] = -c.weight * total_of(u)
                s += 1

            for k in range(drifts.size):
                if k > 0:
                    # Kick, by the forces at the time that the drifts have come to.
                    spring_forces(parts, c.area, laws, u, force, force)
                    force[0] = (loads[n, k - 1] if n < loads.shape[0] else 0.0) + c.start_force
                    force[tail + 1] = c.end_force
                    if start_held:
                        force[0] += c.start.stiffness * start[0]
                    if end_held:
                        force[tail + 1] += c.end.stiffness * end[0]
                    for j in range(tail + 1):
                        f = force[j] - force[j + 1]
                        if gravity:
                            f += c.weight
                        v[j] += kicks[k - 1] * f
                # Drift, at constant velocities.
                dt = drifts[k]
                for j in range(tail + 1):
                    u[j] += dt * v[j]
                if start_held:
                    start[0] -= dt * v[0]
                if end_held:
                    end[0] += dt * v[tail]
                if ledger:
                    # The load's work, as one more displacement of the composition, has its order.
                    impulse = impulses[n, k] if n < impulses.shape[0] else 0.0
                    work[1] += (impulse + dt * c.start_force) * v[0] - dt * c.end_force * v[tail]
            if n + 1 == due:
                if out_of_bounds(v, limit):
                    found[0], found[1], found[2] = n + 1, SPEED, n - EVERY
                    break
                due = due + every if due + every < last else last
        restore_denormals(setting)

    @jitted
    def loop(given, first, last, s, stride):
        steps(*unpacked(given), first, last, s, stride)

    return loop
