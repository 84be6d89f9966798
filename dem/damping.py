"""What damps a block itself, not its joints: in proportion to its mass, and Cundall's way."""

from math import copysign

from numerics.jit import inlined


@inlined
def advanced(keep, local, v, gain):
    """Return a velocity after the step, from that before it and what its forces would add."""
    return kept(keep, v) + braked(local, v, gain)


@inlined
def kept(keep, v):
    """Return what mass-proportional damping leaves of a velocity."""
    if keep is None:
        return v
    return keep * v


@inlined
def braked(local, v, gain):
    """Return a gain of velocity after Cundall's damping: less by local |gain| along v."""
    if local is None:
        return gain
    return gain - local * copysign(abs(gain), v) if v != 0.0 else gain
