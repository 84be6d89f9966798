"""Leapfrog steps of a chain of rigid blocks (Guo & Li 2002): forces, then motion.

Displacements u live at whole steps, velocities v half a step before; dashpots see the gap rate
extrapolated to the whole step, which keeps second order. The ledger is exact at a step of any
length: the work of a force from one whole step to the next is the mean of its two values times the
displacement increment, the kinetic energy m v[n-1/2] v[n+1/2] / 2.
"""

from collections.abc import Callable
from functools import cache
from math import copysign

import numpy as np

from jointwave.dem.axial.ends import end_reaction
from jointwave.dem.axial.model import Model
from jointwave.dem.axial.samples import Samples, buffers
from jointwave.dem.axial.state import State
from jointwave.joints.energy import elastic_energy, fracture_energy_spent
from jointwave.joints.formula import formula
from jointwave.joints.law import law_of
from jointwave.joints.normal import normal_traction, spring_traction
from jointwave.joints.softening import strength_left
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.divergence import (
    ENERGY,
    EVERY,
    SPEED,
    Guard,
    gains_energy,
    guard,
    out_of_bounds,
)
from jointwave.numerics.jit import jitted
from jointwave.numerics.sums import total_of

UNGUARDED = guard(0.0)  # placeholder of a loop without a monitor


def make_stepper(
    model: Model, state: State, samples: Samples, stride: int, monitor: Guard | None = None
) -> Callable[[int, int], None]:
    """Return a function that takes samples first .. last - 1, `stride` steps apart, the steps after
    each included.

    monitor : stops a run that exceeds its bounds; None without.
    """
    loop, given = _loop(model, state), arguments(model, state, samples, monitor)
    return lambda first, last: loop(given, first * stride, last * stride, first, stride)


def march(model: Model, state: State, first: int, last: int) -> None:
    """Take steps first .. last - 1 without samples."""
    given = arguments(model, state, buffers(model, state, 0), None)
    _loop(model, state)(given, first, last, -1, 1)


def _loop(model: Model, state: State) -> Callable:
    return loop_for(model.effects._replace(ledger=state.work is not None))


def arguments(model: Model, state: State, samples: Samples, monitor: Guard | None) -> Packed:
    """Return what a time loop is given except steps and samples."""
    limits, every = (UNGUARDED, 0) if monitor is None else (monitor, EVERY)
    limit = limits.limit.view(np.float64)[0]
    return Packed(
        model.chain, model.laws, model.blocks, model.load, model.base,
        *model.receivers.sections, *model.receivers.points, *state, *samples,
        limit, limits.peak, limits.found, every,
    )  # fmt: skip


@cache
def loop_for(effects):
    """Return the time loop of chains with these effects; absent ones are not compiled.

    It takes steps first .. last - 1, and sample s at step s * stride, and periodically checks that
    speeds and energies are within bounds.
    """
    parts = effects.joints
    dashpots, softening, varied = parts.dashpots, parts.softening, parts.varied
    start_held, end_held, shaken = effects.start, effects.end, effects.base
    masses = effects.masses
    mass_damping, local_damping = effects.mass_damping, effects.local_damping
    gravity, ledger, fracture_row = effects.gravity, effects.ledger, 3 + softening
    joint_ledger = ledger and dashpots
    block_ledger = ledger and (mass_damping or local_damping)

    @formula
    def steps(
        c, laws, blocks, load, base,
        left, right, weight, before, after, share,
        u, v, force, gap_rate, opening, broke, start, end,
        work, last_force, viscous, behind, dashpot_force,
        stress, velocity, displacement, energy, v_before,
        limit, peak, found, every, first, last, s, stride,
    ):  # fmt: skip
        setting = flush_denormals()
        count, law, dt, x, mass = u.size, law_of(laws, 0), c.dt, c.impulse_to_speed, c.mass
        due = first + every if first + every < last else last
        for n in range(first, last):
            # Forces of the joints, compression positive.
            for j in range(count - 1):
                gap, rate = u[j + 1] - u[j], v[j + 1] - v[j]
                rate_now, largest = rate, 0.0
                if varied:
                    law = law_of(laws, j)
                if dashpots:
                    rate_now = 1.5 * rate - 0.5 * gap_rate[j]
                    gap_rate[j] = rate
                if softening:
                    largest = max(opening[j], gap)
                    opening[j] = largest
                    if broke[j] < 0 and strength_left(law, largest) == 0.0:
                        broke[j] = n
                t = normal_traction(law, parts, gap, rate_now, largest)
                force[j + 1] = c.area * t
                if joint_ledger:
                    f = c.area * (t - spring_traction(law, parts, gap, largest))
                    viscous[j] -= (dashpot_force[j] + f) * (0.5 * dt * rate)
                    dashpot_force[j] = f

            # Forces of the load and the ends.
            f_load = load[n] if n < load.size else 0.0
            force[0], force[count] = f_load + c.start_force, c.end_force
            if start_held:
                outward = force[1] - force[0]
                if gravity:
                    outward -= c.weight
                wall = 0.0
                if shaken:
                    base_before = base[n] if n < base.size else 0.0
                    base_now = base[n + 1] if n + 1 < base.size else 0.0
                    wall = (base_before + base_now) / dt
                if masses:
                    x = blocks[0, 1]
                start[1] = end_reaction(c, c.start, x, start[0], -v[0], outward, wall)
                force[0] += start[1]
            if end_held:
                outward = force[count - 1] - force[count]
                if gravity:
                    outward += c.weight
                if masses:
                    x = blocks[count - 1, 1]
                end[1] = end_reaction(c, c.end, x, end[0], v[count - 1], outward, 0.0)
                force[count] += end[1]
            if ledger:
                v_start, v_end = v[0], v[count - 1]
                half = 0.5 * dt
                work[0] += half * (
                    (last_force[1] + end[1]) * v_end - (last_force[0] + start[1]) * v_start
                )
                work[1] += half * (last_force[2] + f_load) * v_start
                work[1] += dt * (c.start_force * v_start - c.end_force * v_end)
                if shaken:
                    # Work of the base that does not reach the block stays in the end.
                    by_base = -0.5 * (last_force[0] + start[1]) * base_before
                    work[0] += by_base
                    work[1] += by_base
                last_force[0], last_force[1], last_force[2] = start[1], end[1], f_load

            sampled = n == s * stride
            if sampled:
                for i in range(left.size):
                    f = (1.0 - weight[i]) * force[left[i]] + weight[i] * force[right[i]]
                    stress[i, s] = f / c.area
                for i in range(before.size):
                    a, b, w = before[i], after[i], share[i]
                    velocity[i, s] = (1.0 - w) * v[a] + w * v[b]
                    displacement[i, s] = (1.0 - w) * u[a] + w * u[b]
                if ledger:
                    # v_before first has the energies of all joints.
                    largest = 0.0
                    for j in range(count - 1):
                        if varied:
                            law = law_of(laws, j)
                        if softening:
                            largest = opening[j]
                        gap = u[j + 1] - u[j]
                        v_before[j] = elastic_energy(law, parts, gap, largest, 0.0, 0.0)
                    v_before[count - 1] = 0.0
                    energy[1, s] = c.area * total_of(v_before)
                    if softening:
                        for j in range(count - 1):
                            if varied:
                                law = law_of(laws, j)
                            v_before[j] = fracture_energy_spent(law, opening[j])
                        energy[3, s] = c.area * total_of(v_before)
                    if gravity:
                        energy[energy.shape[0] - 2, s] = -c.weight * total_of(u)
                    for j in range(count):
                        v_before[j] = v[j]

            # Motion.
            for j in range(count):
                f = force[j] - force[j + 1]
                if gravity:
                    f += c.weight
                if masses:
                    mass, x = blocks[j, 0], blocks[j, 1]
                kept, gain = v[j], x * f
                if mass_damping:
                    kept *= c.keep
                if local_damping and v[j] != 0.0:
                    gain -= c.local * copysign(abs(gain), v[j])
                after_step = kept + gain
                if block_ledger:
                    # Known only after the motion, as the deficit of momentum: the
                    # half step behind the whole step is added by the next step.
                    half_impulse = 0.5 * (mass * (after_step - v[j]) - dt * f)
                    viscous[j] -= behind[j] + half_impulse * v[j]
                    behind[j] = half_impulse * after_step
                v[j] = after_step
                u[j] += dt * after_step
            if start_held:
                start[0] = c.start.decay * start[0] - c.start.gain * v[0]
                if shaken:
                    start[0] -= base_now
            if end_held:
                end[0] = c.end.decay * end[0] + c.end.gain * v[count - 1]

            if sampled:
                for i in range(before.size):
                    a, b, w = before[i], after[i], share[i]
                    velocity[i, s] = 0.5 * (velocity[i, s] + ((1.0 - w) * v[a] + w * v[b]))
                if ledger:
                    for j in range(count):
                        v_before[j] *= v[j]
                        if masses:
                            v_before[j] *= blocks[j, 0] / c.mass
                    energy[0, s] = 0.5 * c.mass * total_of(v_before)
                    if joint_ledger or block_ledger:
                        energy[2, s] = total_of(viscous)
                    energy[fracture_row, s], energy[energy.shape[0] - 1, s] = work[0], work[1]
                s += 1
            if n + 1 == due:
                lost, what = n + 1 if out_of_bounds(v, limit) else -1, SPEED
                if ledger and lost < 0 and gains_energy(peak, energy, s - 1):
                    lost, what = (s - 1) * stride, ENERGY
                if lost >= 0:
                    found[0], found[1], found[2] = lost, what, lost - EVERY - 1
                    break
                due = due + every if due + every < last else last
        restore_denormals(setting)

    @jitted
    def loop(given, first, last, s, stride):
        steps(*unpacked(given), first, last, s, stride)

    return loop
