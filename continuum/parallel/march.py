"""The compiled loop of a process that shares a run: leapfrog steps with an exchange in each.

While shares of forces are on their way all freedoms are accelerated; those that others have too
once more when the shares are there.
"""

from continuum.explicit.march import accelerate, advance, forces
from continuum.parallel.exchange import receive, send
from joints.borrowed import borrowed
from joints.guard import EVERY, runs_away
from joints.jit import inlined, jitted
from joints.tiny import flush_tiny, restore_tiny


@jitted
def run_together(link, model, state, samples, stride, first, last, guard=None):
    """Take steps first .. last - 1 and a sample at every step that `stride` divides.

    guard : notes a motion out of bounds, and lets it go on: the others wait for this process.
    Returns MPI's error code, 0 without.
    """
    failed = 0
    old = flush_tiny()
    link, model, state, samples = borrowed((link, model, state, samples))
    for n in range(first, last):
        forces(model, state, n)
        failed = failed or send(link, state.force)
        accelerate(model.rock, model.rock.keep, state)
        failed = failed or receive(link, state.force)
        accelerate_again(link.freedom, model.rock, model.rock.keep, state)
        advance(model, state, samples, stride, n)
        if (n + 1) % EVERY == 0:
            runs_away(guard, state.v, n + 1)
    restore_tiny(old)
    return failed


@inlined
def accelerate_again(freedom, rock, keep, state):
    """Set the velocities of some freedoms by forces that have changed since."""
    v, v_before, force = state.v, state.v_before, state.force
    if keep is None:
        for i in freedom:
            v[i] = v_before[i] + rock.step_over_mass[i] * force[i]
    else:
        for i in freedom:
            v[i] = keep * v_before[i] + rock.step_over_mass[i] * force[i]
