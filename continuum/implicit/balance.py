"""What an implicit step has to balance: forces, tangents and samples of a trial state, compiled.

The laws, and the order of what acts, are those of `continuum.explicit.march` and `continuum.tractions`.
A trial starts from what the state `now` remembers, and changes nothing of it.
"""

from continuum.explicit.march import add, damp, deform
from continuum.explicit.record import (
    read,
    read_braked,
    read_damped,
    read_joints,
    read_turn,
    read_weight,
    record_energy,
)
from continuum.tractions import at, elastic_slip, gap_at, load_joints, push, rate_at
from joints.borrowed import borrowed
from joints.jit import inlined, jitted
from joints.laws import History, law_of
from joints.optional import given
from joints.tangent import tangent

#: Rows of the tangents: t_n with the gap; t_x, t_z with it; t_x with x, either with the other, t_z
#: with z.
NN, XN, ZN, XX, XZ, ZZ = range(6)


@jitted
def settle(model, now, trial, pressure):
    """Set the force on every freedom of a trial state, and what it would remember.

    now : state at the beginning of the step; its `v_before` is not used.
    trial : u, v and rate (v itself, None without dashpots) are given; v_before is set to the mean
        velocity of the step, and the reactions of the ends count among the forces.
    pressure : of the load, Pa.
    Returns the largest force (N) that is summed up, of rock, dashpots, load and weight.
    """
    model, now, trial = borrowed((model, now, trial))
    for i in range(trial.u.size):
        trial.v_before[i] = (trial.u[i] - now.u[i]) / model.dt
    recall(now.memory, trial.memory)
    copy(now.ledger, trial.ledger)
    deform(trial.force, model.rock.stiffness, trial.u)
    damp(trial.drag, model.rock.viscosity, trial.rate)
    size = max(largest(trial.force), largest(trial.drag), largest(model.weight))
    # A joint slides by what it slips in the step, whatever the velocity at the end of it.
    way, rate, dt = trial.v_before, trial.rate, model.dt
    load_joints(model.interfaces, trial.u, way, rate, trial.memory, trial, dt)
    push(model.interfaces, trial.tractions, trial.jumps, trial.force, trial.drag)
    add(trial.force, trial.drag)
    add(trial.force, model.weight)
    size = max(size, press_by(trial.force, model.ends.loaded, pressure))
    brace(model.ends.quiet, now.closure, trial)
    return size


@inlined
def recall(kept, memory):
    """Let the points of the joints remember what they did before the step."""
    if memory is not None:
        copy(kept.opening, memory.opening)
        copy(kept.slide_x, memory.slide_x)
        copy(kept.slide_z, memory.slide_z)
        copy(kept.cohesion, memory.cohesion)


@inlined
def copy(kept, values):
    """Copy an array, where there is one."""
    if kept is not None:
        for i in range(kept.size):
            values[i] = kept[i]


@inlined
def largest(values):
    """Return the largest magnitude in an array, zero where there is none."""
    found = 0.0
    if values is not None:
        for i in range(values.size):
            found = max(found, abs(values[i]))
    return found


@inlined
def press_by(force, loaded, pressure):
    """Add the load (N) and return the largest of it."""
    found = 0.0
    if loaded is not None:
        for k in range(loaded.freedom.size):
            force[loaded.freedom[k]] += loaded.share[k] * pressure
            found = max(found, abs(loaded.share[k] * pressure))
    return found


@inlined
def brace(quiet, closure, trial):
    """Set what absorbs at the ends, and count it among the forces."""
    if quiet is not None:
        for k in range(quiet.freedom.size):
            trial.reaction[k] = quiet.viscosity[k] * trial.v[quiet.freedom[k]]
        brace_springs(closure, quiet, trial)
        for k in range(quiet.freedom.size):
            trial.force[quiet.freedom[k]] -= trial.reaction[k]


@inlined
def brace_springs(closure, quiet, trial):
    """Add the springs in front of dashpots, closed by the mean velocity of the step."""
    if closure is not None:
        springs = quiet.springs
        for k in range(closure.size):
            way = trial.v_before[quiet.freedom[k]]
            trial.closure[k] = springs.decay[k] * closure[k] + springs.gain[k] * way
            trial.reaction[k] += springs.stiffness[k] * trial.closure[k]


@jitted
def stiffen(model, now, trial, r, stiffness):
    """Set how the joints resist displacement in the trial state: stiffness [6, q], N/m, the
    tangents at every point less than zero, times its area.

    r : rate factor, 1/s (`joints.tangent`).
    """
    model, now, trial = borrowed((model, now, trial))
    stiffen_joints(model.interfaces, now.memory, trial.u, trial.rate, r, stiffness)


@inlined
def stiffen_joints(interfaces, memory, u, rate, r, stiffness):
    """Set the stiffness of every point, where there are joints; memory : before the step."""
    if interfaces is not None:
        for q in range(interfaces.area.size):
            law, area = law_of(interfaces.law, q), interfaces.area[q]
            gap = gap_at(interfaces.prestress, interfaces, law, u, q)
            gap_rate = rate_at(rate, interfaces.opening, q)
            rates = rate_at(rate, interfaces.slip_x, q), rate_at(rate, interfaces.slip_z, q)
            # The whole elastic slip of the trial: what the step adds to the old one is in it.
            x, z = trial_slip(law.shear_stiffness, interfaces, memory, u, q)
            before = History(
                given(memory.opening, at(memory.opening, q)),
                given(law.shear_stiffness, x),
                given(law.shear_stiffness, z),
                given(memory.cohesion, at(memory.cohesion, q)),
            )
            found = tangent(law, gap, gap_rate, (0.0, 0.0), rates, before, r)
            stiffness[NN, q] = -area * found.nn
            keep_shear(found.xx, found, stiffness, q, area)


@inlined
def trial_slip(shear_stiffness, interfaces, memory, u, q):
    """Return the trial elastic slips (m) of point q, as if nothing slid in the step."""
    if shear_stiffness is None:
        return 0.0, 0.0
    x = elastic_slip(interfaces.slip_x, memory.slide_x, u, q)
    z = elastic_slip(interfaces.slip_z, memory.slide_z, u, q)
    return x, z


@inlined
def keep_shear(flag, found, stiffness, q, area):
    """Set the entries of shear, where there is any."""
    if flag is not None:
        stiffness[XN, q], stiffness[ZN, q] = -area * found.xn, -area * found.zn
        stiffness[XX, q], stiffness[XZ, q] = -area * found.xx, -area * found.xz
        stiffness[ZZ, q] = -area * found.zz


@jitted
def record_balanced(model, state, acceleration, samples, s):
    """Record motion of points, stress of sections and the ledger of a state that is in balance.

    state : with v_before equal to v. acceleration : m/s2.
    """
    model, state, samples = borrowed((model, state, samples))
    receivers = model.receivers
    read(samples.displacement, s, receivers.point, state.u, 1.0)
    read(samples.velocity, s, receivers.point, state.v, 1.0)
    read_turn(receivers.turn, samples.turn, s, state.u)
    read(samples.stress, s, receivers.elastic, state.u, 1.0)
    read_damped(receivers.viscous, samples.stress, s, state.rate)
    read(samples.stress, s, receivers.inertia, acceleration, 1.0)
    read_braked(model.rock.keep, receivers.inertia, samples.stress, s, state.v, 1.0, model.dt)
    read_weight(receivers.weight, samples.stress, s)
    read_joints(receivers.contact, samples.stress, s, state.tractions)
    record_energy(samples.energy, model, state, s)
