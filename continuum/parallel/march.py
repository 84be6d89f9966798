"""The compiled loop of a process that shares a run: leapfrog steps with an exchange in each."""

from continuum.explicit import advance, forces
from continuum.parallel.exchange import add_shares
from joints.borrowed import borrowed
from joints.jit import jitted
from joints.tiny import flush_tiny, restore_tiny


@jitted
def run_together(link, model, state, samples, stride, first, last):
    """Take steps first .. last - 1 and a sample at every step that `stride` divides.

    Returns MPI's error code, 0 without.
    """
    failed = 0
    old = flush_tiny()
    link, model, state, samples = borrowed((link, model, state, samples))
    for n in range(first, last):
        forces(model, state, n)
        failed = failed or add_shares(link, state.force)
        advance(model, state, samples, stride, n)
    restore_tiny(old)
    return failed
