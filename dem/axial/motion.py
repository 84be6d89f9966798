"""Motion of one block in a step: the force on it, less what damps it."""

from math import copysign

from dem.axial.ledger import book_damping
from joints.jit import jitted


@jitted
def advanced(chain, ledger, v, force):
    """Return the velocity of a block after a step from that before it and the force on it (N)."""
    gain = braked(chain.local, v, chain.impulse_to_speed * force)
    v_new = kept(chain.keep, v) + gain
    book_damping(chain, ledger, v, v_new, force)
    return v_new


@jitted
def kept(keep, v):
    """Return what mass-proportional damping leaves of a velocity."""
    if keep is None:
        return v
    return keep * v


@jitted
def braked(local, v, gain):
    """Return a gain of velocity after Cundall's damping: less by local |gain| along v."""
    if local is None:
        return gain
    return gain - local * copysign(abs(gain), v) if v != 0.0 else gain


@jitted
def weighed(weight, force):
    """Return a force along y with the weight of the block."""
    if weight is None:
        return force
    return force + weight


@jitted
def steady_at(steady, k):
    """Return what a prestress always presses on the start (k = 0) or the end (k = 1), N."""
    if steady is None:
        return 0.0
    return steady[k]
