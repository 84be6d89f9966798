"""Joints and motion of blocks that turn by any angle: unit quaternions, angular momentum.

The contact points belong to the left block; the right block's face, in the frame of that block,
says how far they have gone through it (the gap) and along it (the slip). With A the left block's
rotation seen from the right one's frame and D the vector between their centroids in that frame,

    w(x, z) = D - h y - A h y + x (1 - A) x + z (1 - A) z

is the right face's displacement relative to the point (x, z). Its forces come from a potential and
act on both blocks at one place, so momentum and angular momentum are conserved exactly.

A block of square section is a symmetric top, whose free motion is exact: it turns about L by
|L| dt / I_t and about its own axis y by (1/I_a - 1/I_t) L_y dt. Rows 3 to 5 of the motion are the
vector part of its quaternion, 9 to 11 its angular momentum L and 12 the scalar part.
"""

from dem.spatial.kinematics import Relative, centred
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.scratch import LEFT
from dem.spatial.vectors import (
    back,
    columns_less_one,
    cross,
    dot,
    less,
    product,
    sum_of,
    times,
    turned,
    turned_back,
)
from numerics.jit import inlined

SCALAR = 12 * R  # place of the quaternions' scalar part in the motion


@inlined
def orientation(m, i):
    """Return the unit quaternion of block i, scalar part first."""
    return m[SCALAR + i], m[3 * R + i], m[4 * R + i], m[5 * R + i]


@inlined
def three(m, row, i):
    """Return the three numbers of block i from this row on."""
    return m[row * R + i], m[(row + 1) * R + i], m[(row + 2) * R + i]


@inlined
def spin(finite, columns, momentum):
    """Return the angular velocity of an angular momentum, for a symmetric top about its y axis.

    finite : (1 / I_t, 1 / I_a - 1 / I_t).
    """
    axis = (columns[1][0], 1.0 + columns[1][1], columns[1][2])
    along = finite[1] * dot(momentum, axis)
    return sum_of(times(finite[0], momentum), times(along, axis))


@inlined
def finite_relative(contact, m, h, i):
    """Return the relative motion of joint i, in the frame of its right block."""
    arm, finite, damped = contact.arm, contact.finite, contact.damped
    right, left = orientation(m, i + 1), orientation(m, i)
    frame, a = columns_less_one(right), columns_less_one(product(back(right), left))
    apart = less(three(m, 0, i + 1), three(m, 0, i))
    far = turned_back(frame, apart)
    y_row = (frame[0][1], frame[1][1], frame[2][1])
    g = (
        far[0] + arm * (2.0 * y_row[0] - a[1][0]),
        far[1] + arm * (2.0 * y_row[1] - a[1][1]),
        far[2] + arm * (2.0 * y_row[2] - a[1][2]),
    )

    own = columns_less_one(left)
    spin_left, spin_right = (
        spin(finite, own, three(m, 9, i)),
        spin(finite, frame, three(m, 9, i + 1)),
    )
    relative_spin = turned_back(frame, less(spin_left, spin_right))
    apart = (apart[0], apart[1] + 2.0 * arm, apart[2])
    rate = less(three(m, 6, i + 1), three(m, 6, i))
    rate = turned_back(frame, less(rate, cross(spin_right, apart)))
    lever = (arm * a[1][0], arm * (1.0 + a[1][1]), arm * a[1][2])
    g_rate = less(rate, cross(relative_spin, lever))
    mid = centred(damped, h, 3, i, relative_spin)
    return Relative(
        g,
        less_columns(a),
        g_rate,
        turning(relative_spin, a),
        centred(damped, h, 0, i, g_rate),
        turning(mid, a),
        (frame, apart),
        relative_spin,
    )


@inlined
def less_columns(a):
    """Return the columns x and z of 1 - A."""
    return -a[0][0], -a[0][1], -a[0][2], -a[2][0], -a[2][1], -a[2][2]


@inlined
def turning(w, a):
    """Return the rates of the columns x and z of 1 - A for the relative spin w."""
    x = cross((1.0 + a[0][0], a[0][1], a[0][2]), w)
    z = cross((a[2][0], a[2][1], 1.0 + a[2][2]), w)
    return x[0], x[1], x[2], z[0], z[1], z[2]


@inlined
def finite_gap_at(arm, g, c, x, z):
    """Return the gap, or its rate, at the point (x, z)."""
    return g[1] + x * c[1] + z * c[4]


@inlined
def finite_slip_at(arm, g, c, x, z):
    """Return the slip, or its rate, at the point (x, z)."""
    return g[0] + x * c[0] + z * c[3], g[2] + x * c[2] + z * c[5]


@inlined
def area_in_contact(contact, area, x, z, gap, slip):
    """Return a point's area, none where it is off the other block's face or behind the block."""
    half = contact.half_side
    # One condition, not three in a row: a branch would keep blocks from being worked on together.
    off = max(abs(x - slip[0]) - half, abs(z - slip[1]) - half, -2.0 * contact.arm - gap)
    return area if off <= 0.0 else 0.0


@inlined
def finite_force_at(x, z, gap, slip, t_x, t_y, t_z):
    """Return a force on the right face with its moment about that face's centre."""
    f = t_x, t_y, t_z
    moment = cross((x - slip[0], -gap, z - slip[1]), f)
    return f[0], f[1], f[2], moment[0], moment[1], moment[2]


@inlined
def finite_leave(q, i, contact, motion, f):
    """Leave a joint's force, and its moments about both blocks' centroids, in the scratch."""
    frame, apart = motion.frame
    arm = contact.arm
    force = turned(frame, (f[0], f[1], f[2]))
    right = turned(frame, (f[3] - arm * f[2], f[4], f[5] + arm * f[0]))
    left = less(times(-1.0, right), cross(apart, force))
    q[i + 1], q[R + i + 1], q[2 * R + i + 1] = force
    q[3 * R + i + 1], q[4 * R + i + 1], q[5 * R + i + 1] = right
    q[LEFT + i + 1], q[LEFT + R + i + 1], q[LEFT + 2 * R + i + 1] = left


@inlined
def finite_remember_rates(damped, contact, m, h, n):
    """Keep the rates of the relative motion for the next step."""
    if damped is not None:
        for i in range(min(n, L)):
            motion = finite_relative(contact, m, h, i)
            h[i], h[L + i], h[2 * L + i] = motion.g_rate
            h[3 * L + i], h[4 * L + i], h[5 * L + i] = motion.spin
