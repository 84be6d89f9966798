"""Steps of fourth order of the undamped chain: PEFRL, a symmetric composition of four kicks.

A step is D K D K D K D K D: drifts u += a dt v and kicks v += b dt F / m. The weights xi, lambda,
chi are those of the position-extended Forest-Ruth-like scheme: Omelyan, Mryglod & Folk, Comput.
Phys. Commun. 146 (2002), 188-202. Displacement and velocity both live at whole steps.

Chosen by its error at equal work, measured on the paper's undamped pillar under a Ricker wavelet
of T = 10 ms: relative L2 of the stress at y = 20 m, 0-0.12 s, at 240 forces per T. PEFRL 2.0e-6,
the six-stage schemes of Blanes & Moan (J. Comput. Appl. Math. 142, 2002) 2.2e-6 (S6) and 2.4e-6
(SRKN6b), VEFRL 2.8e-5, Suzuki's of five stages 1.5e-4 (at 200), Forest & Ruth (1990) 6.7e-4,
leapfrog 2.5e-3.

The load acts with its value at the time of each kick; a mean over the step, as leapfrog takes it,
would leave second order. The order is four while the load is smooth within steps: a kink within a
step leaves order two, a jump order one, and neither costs anything at the end of a step. Where
joints carry no tension the force has a kink wherever one opens or closes, which leaves order two.

The ledger closes to the fourth order, not to round-off: the map conserves an energy that differs
from the true one by O(dt^4), and this difference stays bounded over any number of steps.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

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

XI, LAMBDA, CHI = 0.1786178958448091, -0.2123418310626054, -0.06626458266981849

DRIFTS = (XI, CHI, 1 - 2 * (CHI + XI), CHI, XI)
KICKS = ((1 - 2 * LAMBDA) / 2, LAMBDA, LAMBDA, (1 - 2 * LAMBDA) / 2)

#: When drifts begin and end, and when kicks act, in steps from the start of the step.
EDGES = np.array([0.0, XI, XI + CHI, 1 - XI - CHI, 1 - XI, 1.0])


def half_trace() -> Polynomial:
    """Return half the trace of one step of u'' = -omega^2 u, a polynomial in (omega dt)^2.

    The step has determinant one: its eigenvalues lie on the unit circle where this is in [-1, 1].
    Both diagonal entries of a symmetric step are equal, so that one suffices.
    """
    square, u, v = Polynomial([0.0, 1.0]), Polynomial([1.0]), Polynomial([0.0])
    for drift, kick in zip(DRIFTS, (*KICKS, 0.0), strict=True):
        u = u + drift * v
        v = v - kick * square * u
    return u


def stability_limit() -> float:
    """Return the omega dt up to which every mode is bounded: 2.98945, where leapfrog has 2.

    Beyond it the first mode to grow alternates at every step: half the trace passes -1.
    """
    trace = half_trace()
    squares = np.concatenate([(trace - 1).roots(), (trace + 1).roots()])
    real = squares.real[np.abs(squares.imag) < 1e-9]
    return float(np.sqrt(real[real > 1e-6].min()))


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
        drifts=dt * np.array(DRIFTS),
        kicks=dt * np.array(KICKS) / calibrate(scene).block_mass,
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
