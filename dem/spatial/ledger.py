"""What a step has done to a tile, booked for the energy ledger."""

from dem.spatial.book import (
    KINETIC,
    ROTATION,
)
from dem.spatial.finite import (
    three,
)
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.layout import velocities
from dem.spatial.motion import spin_of
from dem.spatial.outside import book_base, book_end, book_load
from dem.spatial.scratch import BEFORE, MOMENTA
from dem.spatial.vectors import dot
from dem.spatial.viscous import book_viscous
from numerics.jit import inlined
from numerics.optional import either


@inlined
def keep_velocities(book, motion, half, s, q, n):
    """Keep the velocities before the step in the scratch, for the ledger."""
    if book is not None:
        for k in range(half):
            for i in range(min(n, L)):
                q[BEFORE + k * R + i] = s[(half + k) * R + i]
        keep_momenta(motion.finite, motion, s, q, n)


@inlined
def keep_momenta(finite, motion, s, q, n):
    """Tell angular velocity and angular momentum apart, where blocks turn by any angle."""
    if finite is not None:
        for i in range(min(n, L)):
            for k in range(3):
                q[MOMENTA + k * R + i] = s[(9 + k) * R + i]
            at = BEFORE + 3 * R + i
            q[at], q[at + R], q[at + 2 * R] = spin_of(motion, s, i)


@inlined
def book_motion(model, state, book, drag, s, q, n, t, step, sampled):
    """Book what the step has done to a tile: viscous work, ends, load, and at a sample motion."""
    if book is not None:
        motion, rows = model.motion, model.contact.rows
        book_viscous(model.viscous, motion, rows, model.weight, drag, book, s, q, n)
        if t == 0:
            book_load(model.load, motion, book, s, q, step)
            book_base(model.load.base, model.start, state.start, book, step)
            book_end(model.start, state.start, motion, book, s, q, 0)
        if t == len(state.motion) - 1:
            book_end(model.end, state.end, motion, book, s, q, n - 1)
        if sampled:
            book_kinetic(motion, motion.arm, rows, book, s, q, n)


@inlined
def book_kinetic(motion, arm, rows, book, s, q, n):
    """Book the kinetic energy in the form that leapfrog conserves: m v[n-1/2] v[n+1/2] / 2."""
    m, v = 0.5 * motion.mass, velocities(rows)
    for i in range(min(n, L)):
        book[KINETIC * R + i] += m * (
            q[BEFORE + i] * s[v + i]
            + q[BEFORE + R + i] * s[v + R + i]
            + q[BEFORE + 2 * R + i] * s[v + 2 * R + i]
        )
    either(motion.finite, book_rotation, book_spin)(motion, arm, book, s, q, n)


@inlined
def book_rotation(motion, arm, book, s, q, n):
    """Book the energy of rotation, where blocks turn."""
    if arm is not None:
        inertia = motion.inertia
        for i in range(min(n, L)):
            book[ROTATION * R + i] += 0.5 * (
                inertia[0] * q[BEFORE + 3 * R + i] * s[9 * R + i]
                + inertia[1] * q[BEFORE + 4 * R + i] * s[10 * R + i]
                + inertia[2] * q[BEFORE + 5 * R + i] * s[11 * R + i]
            )


@inlined
def book_spin(motion, arm, book, s, q, n):
    """Book the energy of rotation from angular velocity before and angular momentum after."""
    for i in range(min(n, L)):
        book[ROTATION * R + i] += 0.5 * dot(three(q, BEFORE // R + 3, i), three(s, 9, i))
