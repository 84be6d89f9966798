"""The work of load, ends and base: power of what acts on an end face, over both half steps."""

from dem.spatial.book import (
    AFTER,
    BOUNDARY,
    BOUNDARY_AFTER,
    WORK,
    WORK_AFTER,
)
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import angular_velocity, spin_of
from dem.spatial.scratch import BEFORE
from dem.spatial.vectors import dot
from numerics.jit import inlined
from numerics.optional import either

NO_SPIN = (0.0, 0.0, 0.0)


@inlined
def book_load(load, motion, book, s, q, n):
    """Book the work of the load on the start's face."""
    if n < load.stress.size:
        half = 0.5 * motion.dt * load.stress[n]
        f, arm, after = load.direction, motion.arm, s[load.direction.size * R :]
        old, new = spins(motion, arm, s, q, 0)
        book[WORK * R] += half * power(f, q[BEFORE:], 0, arm, old)
        book[WORK_AFTER * R] += half * power(f, after, 0, arm, new)


@inlined
def book_end(end, state, motion, book, s, q, i):
    """Book the work done on an end, and that of what acts there all the time."""
    if end is not None:
        half, before, after = 0.5 * motion.dt, q[BEFORE:], s[state.closure.size * R :]
        arm, (old, new) = end.arm, spins(motion, end.arm, s, q, i)
        book[BOUNDARY * R] -= half * power(state.reaction, before, i, arm, old)
        book[BOUNDARY_AFTER * R] -= half * power(state.reaction, after, i, arm, new)
        book[WORK * R] += half * power(end.steady, before, i, arm, old)
        book[WORK_AFTER * R] += half * power(end.steady, after, i, arm, new)


@inlined
def book_base(base, end, state, book, n):
    """Book the work of a shaken base; what its wall takes is less by as much."""
    if base is not None:
        push = 0.5 * (state.reaction * end.base).sum()
        for account, way in ((0, base[n]), (AFTER, base[n + 1])):
            book[(WORK + account) * R] += push * way
            book[(BOUNDARY + account) * R] += push * way


@inlined
def power(f, rows, i, arm, spin):
    """Return the power of a force and moment f at a face, from the block's velocity (rows of a
    tile) and angular velocity."""
    return (
        f[0] * rows[i] + f[1] * rows[R + i] + f[2] * rows[2 * R + i] + power_of_turn(f, arm, spin)
    )


@inlined
def power_of_turn(f, arm, spin):
    """Return the power that the rotation has in it; zero where blocks do not turn."""
    if arm is None:
        return 0.0
    return dot((f[3], f[4], f[5]), spin) + arm * (f[0] * spin[2] - f[2] * spin[0])


@inlined
def spins(motion, arm, s, q, i):
    """Return the angular velocity of a block before and after the step."""
    if arm is None:
        return NO_SPIN, NO_SPIN
    at = BEFORE + 3 * R + i
    after = either(motion.finite, angular_velocity, spin_of)(motion, s, i)
    return (q[at], q[at + R], q[at + 2 * R]), after
