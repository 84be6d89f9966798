"""Motion of the blocks of one tile, by the forces of their two joints.

m v' = F_left - F_right + m g,   I omega' = M_left - M_right + h y x (-(F_left + F_right)),

with y x F = (F_z, 0, -F_x): the shear forces of both joints turn a block the same way.
"""

from typing import Any, NamedTuple

from dem.damping import advanced
from dem.spatial.finite import SCALAR, orientation, spin
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.layout import velocities
from dem.spatial.scratch import LEFT
from dem.spatial.vectors import columns_less_one, dot, normalised, product, times, turn_by
from numerics.jit import inlined
from numerics.optional import either


class Motion(NamedTuple):
    """The constants of the motion of one block.

    dt : s. arm : half the thickness, m; None where blocks do not turn.
    mass : m, kg; inertia : about the axes x, y, z, kg m2; None where blocks do not turn.
    push, twist : what a force and a moment add in a step to velocity and angular velocity:
        dt / m and dt / I, less by mass-proportional damping; twist None where blocks do not turn.
    fall : what gravity adds to the velocity in a step, m/s; None without.
    keep : what mass-proportional damping leaves of a velocity in a step; None without.
    local : Cundall's damping, None without.
    finite : (1 / I_t, 1 / I_a - 1 / I_t) of a block that turns by any angle, 1/(kg m2); else None.
    """

    dt: float
    arm: Any
    mass: float
    inertia: Any
    push: float
    twist: Any
    fall: Any
    keep: Any
    local: Any
    finite: Any


@inlined
def net_force(q, i):
    """Return the force of both joints on the block in lane i, N."""
    return q[i] - q[i + 1], q[R + i] - q[R + i + 1], q[2 * R + i] - q[2 * R + i + 1]


@inlined
def net_moment(q, i, arm):
    """Return the moment of both joints about the centroid of the block in lane i, N m."""
    mx = q[3 * R + i] - q[3 * R + i + 1] - arm * (q[2 * R + i] + q[2 * R + i + 1])
    my = q[4 * R + i] - q[4 * R + i + 1]
    mz = q[5 * R + i] - q[5 * R + i + 1] + arm * (q[i] + q[i + 1])
    return mx, my, mz


@inlined
def angular_velocity(motion, s, i):
    """Return the angular velocity of block i."""
    return s[9 * R + i], s[10 * R + i], s[11 * R + i]


@inlined
def spin_of(motion, s, i):
    """Return the angular velocity of block i from its angular momentum and orientation."""
    columns = columns_less_one(orientation(s, i))
    return spin(motion.finite, columns, angular_velocity(motion, s, i))


@inlined
def gains(push, fall, f):
    """Return what force f adds to a velocity in a step, with gravity."""
    x, y, z = push * f[0], push * f[1], push * f[2]
    if fall is None:
        return x, y, z
    return x + fall[0], y + fall[1], z + fall[2]


@inlined
def turns(twist, m):
    """Return what moment m adds to an angular velocity in a step."""
    return twist[0] * m[0], twist[1] * m[1], twist[2] * m[2]


@inlined
def advance(motion, rows, s, q, n):
    """Advance the first n blocks of a tile's motion s by one step."""
    translate(motion, motion.fall, rows, s, q, n)
    either(motion.finite, rotate, rotate_by_momentum)(motion, motion.arm, s, q, n)


@inlined
def translate(motion, fall, rows, s, q, n):
    """Advance velocities and displacements."""
    dt, push, keep, local = motion.dt, motion.push, motion.keep, motion.local
    v = velocities(rows)
    for i in range(min(n, L)):
        gain = gains(push, fall, net_force(q, i))
        x = advanced(keep, local, s[v + i], gain[0])
        y = advanced(keep, local, s[v + R + i], gain[1])
        z = advanced(keep, local, s[v + 2 * R + i], gain[2])
        s[v + i], s[v + R + i], s[v + 2 * R + i] = x, y, z
        s[i] += dt * x
        s[R + i] += dt * y
        s[2 * R + i] += dt * z


@inlined
def rotate(motion, arm, s, q, n):
    """Advance angular velocities and rotations, where blocks turn."""
    if arm is not None:
        dt, twist, keep, local = motion.dt, motion.twist, motion.keep, motion.local
        for i in range(min(n, L)):
            gain = turns(twist, net_moment(q, i, arm))
            x = advanced(keep, local, s[9 * R + i], gain[0])
            y = advanced(keep, local, s[10 * R + i], gain[1])
            z = advanced(keep, local, s[11 * R + i], gain[2])
            s[9 * R + i], s[10 * R + i], s[11 * R + i] = x, y, z
            s[3 * R + i] += dt * x
            s[4 * R + i] += dt * y
            s[5 * R + i] += dt * z


@inlined
def finite_moment(q, i, arm):
    """Return the moment of both joints about the centroid of the block in lane i, N m."""
    return (
        q[3 * R + i] + q[LEFT + i + 1],
        q[4 * R + i] + q[LEFT + R + i + 1],
        q[5 * R + i] + q[LEFT + 2 * R + i + 1],
    )


@inlined
def rotate_by_momentum(motion, arm, s, q, n):
    """Advance angular momenta by the moments of a step, and turn the blocks by them."""
    dt, finite, keep, local = motion.dt, motion.finite, motion.keep, motion.local
    for i in range(min(n, L)):
        gain = times(motion.push * motion.mass, finite_moment(q, i, arm))
        momentum = (
            advanced(keep, local, s[9 * R + i], gain[0]),
            advanced(keep, local, s[10 * R + i], gain[1]),
            advanced(keep, local, s[11 * R + i], gain[2]),
        )
        s[9 * R + i], s[10 * R + i], s[11 * R + i] = momentum
        p = orientation(s, i)
        columns = columns_less_one(p)
        axis = (columns[1][0], 1.0 + columns[1][1], columns[1][2])
        about_momentum = turn_by(times(0.5 * dt * finite[0], momentum))
        own = 0.5 * dt * finite[1] * dot(momentum, axis)
        about_axis = turn_by((0.0, own, 0.0))
        p = normalised(product(about_momentum, product(p, about_axis)))
        s[SCALAR + i], s[3 * R + i], s[4 * R + i], s[5 * R + i] = p
