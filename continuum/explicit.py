"""The compiled loop: leapfrog steps of a bar with joints.

Displacements u live at whole steps, velocities v half a step before or after. Dashpots in rock
and joints see the rate extrapolated to the whole step, 1.5 v[n-1/2] - 0.5 v[n-3/2], which keeps
second order without an equation to solve; quiet ends are centred implicitly on their node.

Absent parts of a model or state are None. Each is handed on as an argument of its own, where
numba removes the branch that would use it.
"""

from continuum.record import book, sample, sample_energy, sample_joints
from continuum.sparse import row
from joints.jit import jitted
from joints.laws import law_of, normal_traction, spring_traction


@jitted
def run(model, state, samples, stride, first, last):
    """Take steps first .. last - 1 and a sample at every step that `stride` divides."""
    # Unpacked once: a tuple of arrays read in every step would count its references in every step.
    rock, interfaces, ends, receivers, load, dt = model
    u, v, v_before, force, rate, traction, dashpot, drag, closure, reaction, ledger = state
    for n in range(first, last):
        deform(force, rock.stiffness, u)
        extrapolate(rate, v, v_before)
        load_joints(interfaces, u, rate, traction, dashpot)
        push(force, interfaces, traction)
        damp(drag, rock, interfaces, rate, dashpot)
        resist(force, drag)
        force[ends.loaded] += load[n]
        lean(force, ends.quiet, closure)
        accelerate(v, v_before, rock.step_over_mass, force)
        absorb(ends.quiet, reaction, closure, v, v_before)
        hold(ends.fixed, v)

        book(ledger, 0.5 * dt, load[n], ends.loaded, ends.quiet, reaction, drag, v_before)
        if n % stride == 0:
            sample(rock, receivers, samples, n // stride, u, v, v_before, rate, dt)
            sample_joints(samples.stress, n // stride, receivers.contact, traction, dashpot)
            sample_energy(samples.energy, rock, interfaces, n // stride, u, v, v_before, ledger)
        book(ledger, 0.5 * dt, load[n], ends.loaded, ends.quiet, reaction, drag, v)
        for i in range(u.size):
            u[i] += dt * v[i]
        close(ends.quiet, closure, v)


@jitted
def deform(force, stiffness, u):
    """Set the elastic force (N) of the rock on every node."""
    start, column, value = stiffness
    for i in range(force.size):
        force[i] = -row(start, column, value, u, i)


@jitted
def extrapolate(rate, v, v_before):
    """Set the rate of displacement at the whole step, second order."""
    if rate is not None:
        for i in range(rate.size):
            rate[i] = 1.5 * v[i] - 0.5 * v_before[i]


@jitted
def load_joints(interfaces, u, rate, traction, dashpot):
    """Set the traction (Pa) at every interface point from the jump there.

    Where there are dashpots it is the spring's part, and theirs is kept apart.
    """
    if interfaces is not None:
        start, column, value = interfaces.jump
        law = interfaces.law
        for q in range(traction.size):
            gap, one = row(start, column, value, u, q), law_of(law, q)
            traction[q] = spring_traction(one, gap)
            load_dashpot(dashpot, start, column, value, rate, one, gap, q)


@jitted
def load_dashpot(dashpot, start, column, value, rate, law, gap, q):
    """Set what a joint's dashpot adds to its spring, tension cut from both together."""
    if dashpot is not None:
        gap_rate = row(start, column, value, rate, q)
        dashpot[q] = normal_traction(law, gap, gap_rate) - spring_traction(law, gap)


@jitted
def push(force, interfaces, traction):
    """Add the force (N) of joints of these tractions on every node, B^T W t."""
    if interfaces is not None:
        start, column, value = interfaces.gather
        for i in range(force.size):
            force[i] += row(start, column, value, traction, i)


@jitted
def damp(drag, rock, interfaces, rate, dashpot):
    """Set the viscous force (N) of rock and joints on every node."""
    if drag is not None:
        drag[:] = 0.0
        damp_rock(drag, rock.stiffness, rock.time_constant, rate)
        damp_joints(drag, interfaces, dashpot)


@jitted
def damp_rock(drag, stiffness, time_constant, rate):
    """Set the rock's part of the viscous force (N), Kelvin-Voigt: -eta K u'."""
    if time_constant is not None:
        start, column, value = stiffness
        for i in range(drag.size):
            drag[i] = -time_constant * row(start, column, value, rate, i)


@jitted
def damp_joints(drag, interfaces, dashpot):
    """Add the joints' part of the viscous force (N)."""
    if dashpot is not None:
        push(drag, interfaces, dashpot)


@jitted
def resist(force, drag):
    """Add the viscous force to the others."""
    if drag is not None:
        for i in range(force.size):
            force[i] += drag[i]


@jitted
def accelerate(v, v_before, step_over_mass, force):
    """Advance every velocity by one step."""
    for i in range(v.size):
        v_before[i] = v[i]
        v[i] += step_over_mass[i] * force[i]


@jitted
def lean(force, quiet, closure):
    """Add the force (N) of the springs in front of dashpots."""
    if closure is not None:
        for k in range(closure.size):
            force[quiet.node[k]] -= quiet.springs.stiffness[k] * closure[k]


@jitted
def close(quiet, closure, v):
    """Advance the closure of the springs in front of dashpots."""
    if closure is not None:
        springs = quiet.springs
        for k in range(closure.size):
            closure[k] = springs.decay[k] * closure[k] + springs.gain[k] * v[quiet.node[k]]


@jitted
def absorb(quiet, reaction, closure, v, v_before):
    """Slow quiet nodes by their dashpots, centred: exactly the free motion where beta = 0.

    What holds each of them back, spring and dashpot (N), is left in `reaction`.
    """
    if quiet is not None:
        for k in range(quiet.node.size):
            i, beta = quiet.node[k], quiet.beta[k]
            v[i] = (v[i] - beta * v_before[i]) / (1.0 + beta)
            reaction[k] = 0.5 * quiet.viscosity[k] * (v_before[i] + v[i])
        add_springs(reaction, quiet.springs, closure)


@jitted
def add_springs(reaction, springs, closure):
    """Add the springs' part of the reactions."""
    if closure is not None:
        for k in range(closure.size):
            reaction[k] += springs.stiffness[k] * closure[k]


@jitted
def hold(fixed, v):
    """Hold fixed nodes at rest."""
    if fixed is not None:
        for i in fixed:
            v[i] = 0.0
