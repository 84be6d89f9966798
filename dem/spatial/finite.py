"""Joints and motion of blocks that turn by any angle: unit quaternions, angular momentum.

The contact points belong to the left block; the right block's face, in the frame of that block,
says how far they have gone through it (the gap) and along it (the slip). With A the left block's
rotation seen from the right one's frame and D the vector between their centroids in that frame,

    w(x, z) = D - h y - A h y + x (1 - A) x + z (1 - A) z

is the right face's displacement relative to the point (x, z). Its forces come from a potential and
act on both blocks at one place, so momentum and angular momentum are conserved exactly.

A block of square section is a symmetric top, whose free motion is exact: it turns about L by
|L| dt / I_t and about its own axis y by (1/I_a - 1/I_t) L_y dt. Vectors, quaternions (scalar part
first) and the columns of R - 1 are tuples of numbers.
"""

from jointwave.dem.spatial.layout import (
    ABOUT_X,
    ABOUT_Y,
    ABOUT_Z,
    LANES,
    LEFT,
    RELATIVE,
    STRIDE,
    X,
    Y,
    Z,
)
from jointwave.joints.formula import formula

VELOCITY, MOMENTUM, QUATERNION = 6 * STRIDE, 9 * STRIDE, 12 * STRIDE  # rows of motion
FIRST, SECOND = 3 * STRIDE, 6 * STRIDE  # columns x and z in the rows of relative motion


@formula
def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@formula
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@formula
def less(a, b):
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@formula
def product(p, q):
    """Return the quaternion p q: the rotation q first, then p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    )


@formula
def columns_less_one(q):
    """Return the three columns of R - 1, with nothing lost where the rotation is small."""
    w, x, y, z = q
    return (
        (-2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        (2.0 * (x * y - w * z), -2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), -2.0 * (x * x + y * y)),
    )


@formula
def turned(c, a):
    """Return R a, from the columns c of R - 1."""
    return (
        a[0] + (c[0][0] * a[0] + c[1][0] * a[1] + c[2][0] * a[2]),
        a[1] + (c[0][1] * a[0] + c[1][1] * a[1] + c[2][1] * a[2]),
        a[2] + (c[0][2] * a[0] + c[1][2] * a[1] + c[2][2] * a[2]),
    )


@formula
def turned_back(c, a):
    """Return the transpose of R times a, from the columns c of R - 1."""
    return a[0] + dot(c[0], a), a[1] + dot(c[1], a), a[2] + dot(c[2], a)


@formula
def turn_by(x, y, z):
    """Return the unit quaternion of a rotation by twice the vector (x, y, z), for small angles.

    cos and sin by their series up to the sixth power: below 1e-16 up to 0.02 rad a step.
    """
    s = x * x + y * y + z * z
    c = 1.0 - s * (0.5 - s * (1.0 / 24.0 - s / 720.0))
    k = 1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s / 5040.0))
    return c, k * x, k * y, k * z


@formula
def three(m, at, i):
    """Return the three numbers of lane i in the rows from `at` on."""
    i += at
    return m[i], m[i + Y], m[i + Z]


@formula
def put_three(m, at, values):
    """Put three numbers into the rows that begin at m[at]."""
    m[at + X], m[at + Y], m[at + Z] = values


@formula
def orientation(m, i):
    """Return the unit quaternion of block i."""
    return m[QUATERNION + i], m[ABOUT_X + i], m[ABOUT_Y + i], m[ABOUT_Z + i]


@formula
def spin(b, frame, momentum):
    """Return the angular velocity of an angular momentum, for a symmetric top about its y axis."""
    x, y, z = frame[1][0], 1.0 + frame[1][1], frame[1][2]
    across = 1.0 / b.inertia_across
    along = (1.0 / b.inertia_along - across) * dot(momentum, (x, y, z))
    return (
        across * momentum[0] + along * x,
        across * momentum[1] + along * y,
        across * momentum[2] + along * z,
    )


@formula
def angular_velocity(b, m, i):
    """Return the angular velocity of block i from its angular momentum and orientation."""
    return spin(b, columns_less_one(orientation(m, i)), three(m, MOMENTUM, i))


@formula
def turn_by_momentum(b, m, i, momentum):
    """Turn block i as a step with this angular momentum does."""
    p = orientation(m, i)
    axis = columns_less_one(p)[1]
    across = 1.0 / b.inertia_across
    excess = 1.0 / b.inertia_along - across
    own = 0.5 * b.dt * excess * dot(momentum, (axis[0], 1.0 + axis[1], axis[2]))
    k = 0.5 * b.dt * across
    first = product(p, turn_by(0.0, own, 0.0))
    w, x, y, z = product(turn_by(k * momentum[0], k * momentum[1], k * momentum[2]), first)
    k = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)  # unit length again, by one Newton step
    m[QUATERNION + i] = k * w
    put_three(m, ABOUT_X + i, (k * x, k * y, k * z))


@formula
def finite_relative(b, m, q, i):
    """Return the rates of joint i's displacement and rotation, in the right block's frame.

    Leave in the rows of relative motion the right face's displacement and columns x and z of 1 - A.
    """
    right, left = orientation(m, i + 1), orientation(m, i)
    back = right[0], -right[1], -right[2], -right[3]
    frame, a = columns_less_one(right), columns_less_one(product(back, left))
    apart = less(three(m, 0, i + 1), three(m, 0, i))
    x, y, z = turned_back(frame, apart)
    at = RELATIVE + i
    q[at + X] = x + b.arm * (2.0 * frame[0][1] - a[1][0])
    q[at + Y] = y + b.arm * (2.0 * frame[1][1] - a[1][1])
    q[at + Z] = z + b.arm * (2.0 * frame[2][1] - a[1][2])
    put_three(q, at + FIRST, (-a[0][0], -a[0][1], -a[0][2]))
    put_three(q, at + SECOND, (-a[2][0], -a[2][1], -a[2][2]))

    spin_left = spin(b, columns_less_one(left), three(m, MOMENTUM, i))
    spin_right = spin(b, frame, three(m, MOMENTUM, i + 1))
    turning = turned_back(frame, less(spin_left, spin_right))
    apart = (apart[0], apart[1] + 2.0 * b.arm, apart[2])
    rate = less(three(m, VELOCITY, i + 1), three(m, VELOCITY, i))
    rate = turned_back(frame, less(rate, cross(spin_right, apart)))
    lever = (b.arm * a[1][0], b.arm * (1.0 + a[1][1]), b.arm * a[1][2])
    return less(rate, cross(turning, lever)), turning


@formula
def put_rates(q, at, i, rate, w):
    """Leave the rates of joint i's displacement and columns for relative spin w in rows `at`."""
    x, z = three(q, RELATIVE + FIRST, i), three(q, RELATIVE + SECOND, i)
    i += at
    put_three(q, i, rate)
    put_three(q, i + FIRST, cross((1.0 - x[0], -x[1], -x[2]), w))
    put_three(q, i + SECOND, cross((-z[0], -z[1], 1.0 - z[2]), w))


@formula
def centred(h, i, rate):
    """Return three rates at the whole step, from half a step before it and, in h, one and a half;
    remember them for the next step."""
    x, y, z = h[i], h[LANES + i], h[2 * LANES + i]
    h[i], h[LANES + i], h[2 * LANES + i] = rate
    return 1.5 * rate[0] - 0.5 * x, 1.5 * rate[1] - 0.5 * y, 1.5 * rate[2] - 0.5 * z


@formula
def to_centroids(b, m, q, at, i):
    """Turn joint i's force and moment about the right face's centre, in that block's frame, in the
    rows from `at` on, into those about the centroids of both blocks."""
    frame = columns_less_one(orientation(m, i + 1))
    apart = less(three(m, 0, i + 1), three(m, 0, i))
    apart = (apart[0], apart[1] + 2.0 * b.arm, apart[2])
    f, moment = three(q, at, i + 1), three(q, at + ABOUT_X, i + 1)
    force = turned(frame, f)
    right = turned(frame, (moment[0] - b.arm * f[2], moment[1], moment[2] + b.arm * f[0]))
    other = cross(apart, force)
    left = -right[0] - other[0], -right[1] - other[1], -right[2] - other[2]
    at += i + 1
    put_three(q, at, force)
    put_three(q, at + ABOUT_X, right)
    put_three(q, at + LEFT, left)
