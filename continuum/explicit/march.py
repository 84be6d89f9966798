"""The compiled loop: leapfrog steps of jointed rock.

Displacements u live at whole steps, velocities v half a step before or after. Dashpots in rock
and joints see the rate extrapolated to the whole step, 1.5 v[n-1/2] - 0.5 v[n-3/2], which keeps
second order without an equation to solve; quiet ends and mass-proportional damping are centred
implicitly on their freedom.

Absent parts of a model or state are None. Each is handed on as an argument of its own, where
numba removes the branch that would use it.
"""

from continuum.explicit.record import book, record
from continuum.space.operator import multiply
from continuum.tractions import load_joints, push
from joints.borrowed import borrowed
from joints.guard import EVERY, creates_energy, runs_away
from joints.jit import inlined, jitted
from joints.tiny import flush_tiny, restore_tiny


@jitted
def run(model, state, samples, stride, first, last, guard=None):
    """Take steps first .. last - 1 and a sample at every step that `stride` divides.

    guard : `joints.guard.Guard` that ends it where it runs out of bounds; None without.
    """
    old = flush_tiny()
    model, state, samples = borrowed(model), borrowed(state), borrowed(samples)
    for n in range(first, last):
        forces(model, state, n)
        accelerate(model.rock, model.rock.keep, state)
        advance(model, state, samples, stride, n)
        if is_lost(guard, state, samples, stride, n):
            break
    restore_tiny(old)


@inlined
def is_lost(guard, state, samples, stride, n):
    """Return whether a guard finds the run out of bounds at step n."""
    if guard is None:
        return False
    lost = (n + 1) % EVERY == 0 and runs_away(guard, state.v, n + 1)
    if n % stride == 0:
        lost = creates_energy(guard, samples.energy, n // stride, n) or lost
    return lost


@inlined
def forces(model, state, n):
    """Set the force on every freedom at step n, from the displacements and rates there."""
    interfaces, ends = model.interfaces, model.ends
    deform(state.force, model.rock.stiffness, state.u)
    extrapolate(state.rate, state.v, state.v_before)
    damp(state.drag, model.rock.viscosity, state.rate)
    load_joints(interfaces, state.u, state.v, state.rate, state.memory, state, model.dt)
    push(interfaces, state.tractions, state.jumps, state.force, state.drag)
    add(state.force, state.drag)
    add(state.force, model.weight)
    press(state.force, ends.loaded, n)
    lean(state.force, ends.quiet, state.closure)


@inlined
def advance(model, state, samples, stride, n):
    """Move on to the next step at the velocities that the forces of step n have given, but for what
    absorbs or holds, and record step n."""
    ends, dt = model.ends, model.dt
    absorb(ends.quiet, state.reaction, state.closure, state.v, state.v_before)
    hold(ends.held, model, state, n)
    book(state.ledger, 0.5 * dt, model, state, n, state.v_before)
    if n % stride == 0:
        record(model, state, samples, n // stride)
    book(state.ledger, 0.5 * dt, model, state, n, state.v)
    for i in range(state.u.size):
        state.u[i] += dt * state.v[i]
    close(ends.quiet, state.closure, state.v)


@inlined
def deform(force, stiffness, u):
    """Set the elastic force (N) of the rock on every freedom."""
    multiply(stiffness, u, force, -1.0)


@inlined
def extrapolate(rate, v, v_before):
    """Set the rate of displacement at the whole step, second order."""
    if rate is not None:
        for i in range(rate.size):
            rate[i] = 1.5 * v[i] - 0.5 * v_before[i]


@inlined
def damp(drag, viscosity, rate):
    """Set the viscous force (N) of the rock on every freedom."""
    if drag is not None:
        drag[:] = 0.0
        damp_rock(drag, viscosity, rate)


@inlined
def damp_rock(drag, viscosity, rate):
    """Set the viscous force of rock that has Kelvin-Voigt dashpots."""
    if viscosity is not None:
        deform(drag, viscosity, rate)


@inlined
def add(force, more):
    """Add other forces on every freedom, where there are any."""
    if more is not None:
        for i in range(force.size):
            force[i] += more[i]


@inlined
def press(force, loaded, n):
    """Add the load (N)."""
    if loaded is not None:
        for k in range(loaded.freedom.size):
            force[loaded.freedom[k]] += loaded.share[k] * loaded.pressure[n]


@inlined
def lean(force, quiet, closure):
    """Add the force (N) of the springs in front of dashpots."""
    if closure is not None:
        for k in range(closure.size):
            force[quiet.freedom[k]] -= quiet.springs.stiffness[k] * closure[k]


@inlined
def accelerate(rock, keep, state):
    """Advance every velocity by one step."""
    v, v_before, force = state.v, state.v_before, state.force
    if keep is None:
        for i in range(v.size):
            v_before[i] = v[i]
            v[i] += rock.step_over_mass[i] * force[i]
    else:
        for i in range(v.size):
            v_before[i] = v[i]
            v[i] = keep * v[i] + rock.step_over_mass[i] * force[i]


@inlined
def absorb(quiet, reaction, closure, v, v_before):
    """Slow quiet freedoms by their dashpots, centred: exactly the free motion where beta = 0.

    What holds each of them back, spring and dashpot (N), is left in `reaction`.
    """
    if quiet is not None:
        for k in range(quiet.freedom.size):
            i, beta = quiet.freedom[k], quiet.beta[k]
            v[i] = (v[i] - beta * v_before[i]) / (1.0 + beta)
            reaction[k] = 0.5 * quiet.viscosity[k] * (v_before[i] + v[i])
        add_springs(reaction, quiet.springs, closure)


@inlined
def add_springs(reaction, springs, closure):
    """Add the springs' part of the reactions."""
    if closure is not None:
        for k in range(closure.size):
            reaction[k] += springs.stiffness[k] * closure[k]


@inlined
def close(quiet, closure, v):
    """Advance the closure of the springs in front of dashpots."""
    if closure is not None:
        springs = quiet.springs
        for k in range(closure.size):
            closure[k] = springs.decay[k] * closure[k] + springs.gain[k] * v[quiet.freedom[k]]


@inlined
def hold(held, model, state, n):
    """Give held freedoms their motion, at rest or that of a shaken base."""
    if held is not None:
        shake(held.step, held, model, state, n)


@inlined
def shake(step, held, model, state, n):
    """Move held freedoms as the base does, and leave in `wall` what that takes (N)."""
    if step is None:
        for i in held.freedom:
            state.v[i] = 0.0
    else:
        for k in range(held.freedom.size):
            i = held.freedom[k]
            moved = held.way[k] * step[n] / model.dt
            state.wall[k] = (
                model.rock.mass[i] * (moved - state.v_before[i]) / model.dt - state.force[i]
            )
            state.wall[k] += mass_damping(model.rock.keep, model, i, moved, state.v_before[i])
            state.v[i] = moved


@inlined
def mass_damping(keep, model, i, v, v_before):
    """Return the force (N) of mass-proportional damping on a freedom, zero without it."""
    if keep is None:
        return 0.0
    alpha = 2.0 * (1.0 - keep) / (1.0 + keep) / model.dt
    return alpha * model.rock.mass[i] * 0.5 * (v + v_before)
