"""Motion of one block in a step: the force on it, less what damps it."""

from dem.axial.ledger import book_damping
from dem.damping import advanced as damped
from numerics.jit import inlined, jitted


@jitted
def advanced(chain, ledger, j, v, force):
    """Return the velocity of block j after a step from that before it and the force on it (N)."""
    v_new = damped(chain.keep, chain.local, v, chain.impulse_to_speed * force)
    book_damping(chain, ledger, j, v, v_new, force)
    return v_new


@inlined
def weighed(weight, force):
    """Return a force along y with the weight of the block."""
    if weight is None:
        return force
    return force + weight


@inlined
def steady_at(steady, k):
    """Return what a prestress always presses on the start (k = 0) or the end (k = 1), N."""
    if steady is None:
        return 0.0
    return steady[k]
