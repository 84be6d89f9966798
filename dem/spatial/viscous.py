"""The work of dashpots, mass-proportional and local damping over the half steps of a step."""

from dem.spatial.book import (
    VISCOUS,
    VISCOUS_AFTER,
)
from dem.spatial.finite import (
    three,
)
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import finite_moment, net_force, net_moment, spin_of
from dem.spatial.scratch import BEFORE, DRAG, MOMENTA
from dem.spatial.vectors import dot, less, sum_of, times
from numerics.jit import inlined
from numerics.optional import either


@inlined
def book_viscous(viscous, motion, rows, weight, drag, book, s, q, n):
    """Book the work of dashpots, mass-proportional and local damping over both half steps."""
    if viscous is not None:
        v = len(rows.motion) // 2
        for i in range(min(n, L)):
            old, new = three(q, BEFORE // R, i), three(s, v, i)
            pull = sum_of(net_force(q, i), weighed(weight))
            gain = times(motion.mass, less(new, old))
            book_impulse(book, i, impulse(motion, dragged(drag, q, i), pull, gain), old, new)
        book_turn = either(motion.finite, book_viscous_turn, book_viscous_spin)
        book_turn(motion, motion.arm, drag, book, s, q, n)


@inlined
def book_viscous_turn(motion, arm, drag, book, s, q, n):
    """Book the work of the same moments, where blocks turn."""
    if arm is not None:
        about_x, about_y, about_z = motion.inertia
        for i in range(min(n, L)):
            old, new = three(q, BEFORE // R + 3, i), three(s, 9, i)
            more = less(new, old)
            gain = about_x * more[0], about_y * more[1], about_z * more[2]
            drags = dragged_round(drag, q, i, arm)
            book_impulse(book, i, impulse(motion, drags, net_moment(q, i, arm), gain), old, new)


@inlined
def book_viscous_spin(motion, arm, drag, book, s, q, n):
    """Book the work of the same moments, where blocks turn by any angle."""
    for i in range(min(n, L)):
        old, new = three(q, BEFORE // R + 3, i), spin_of(motion, s, i)
        gain = less(three(s, 9, i), three(q, MOMENTA // R, i))
        drags = spin_drag(drag, q, i, arm)
        book_impulse(book, i, impulse(motion, drags, finite_moment(q, i, arm), gain), old, new)


@inlined
def book_impulse(book, i, given_off, old, new):
    """Book the work of an impulse (N s) against the velocities before and after the step."""
    book[VISCOUS * R + i] -= 0.5 * dot(given_off, old)
    book[VISCOUS_AFTER * R + i] -= 0.5 * dot(given_off, new)


@inlined
def impulse(motion, drags, pull, gain):
    """Return the impulse of the dashpots, and of what damps a block itself: what its momentum's
    gain has less than the pull of everything else."""
    missing = less(gain, times(motion.dt, pull))
    return sum_of(times(motion.dt, drags), damped(motion.keep, motion.local, missing))


@inlined
def damped(keep, local, missing):
    """Return what is missing where a block is damped itself, else nothing: it is round-off."""
    if keep is None and local is None:
        return 0.0, 0.0, 0.0
    return missing


@inlined
def dragged(drag, q, i):
    """Return the force of the dashpots on a block."""
    if drag is None:
        return 0.0, 0.0, 0.0
    return net_force(q, DRAG + i)


@inlined
def dragged_round(drag, q, i, arm):
    """Return the moment of the dashpots on a block."""
    if drag is None:
        return 0.0, 0.0, 0.0
    return net_moment(q, DRAG + i, arm)


@inlined
def spin_drag(drag, q, i, arm):
    """Return the moment of the dashpots on a block that turns by any angle."""
    if drag is None:
        return 0.0, 0.0, 0.0
    return finite_moment(q, DRAG + i, arm)


@inlined
def weighed(weight):
    """Return a block's weight, N."""
    if weight is None:
        return 0.0, 0.0, 0.0
    return weight[0], weight[1], weight[2]
