"""Vectors, rotation matrices and unit quaternions as tuples of numbers, for use in kernels."""

from numerics.jit import inlined


@inlined
def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def sum_of(a, b):
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def less(a, b):
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def times(k, a):
    """Return k a."""
    return k * a[0], k * a[1], k * a[2]


@inlined
def product(p, q):
    """Return the quaternion p q, scalar part first: q first, then p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    )


@inlined
def back(q):
    """Return the quaternion of the opposite rotation."""
    return q[0], -q[1], -q[2], -q[3]


@inlined
def columns_less_one(q):
    """Return the three columns of R - 1, with nothing lost where the rotation is small."""
    w, x, y, z = q
    return (
        (-2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        (2.0 * (x * y - w * z), -2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), -2.0 * (x * x + y * y)),
    )


@inlined
def turned(columns, a):
    """Return R a, from the columns of R - 1."""
    c = columns
    return (
        a[0] + (c[0][0] * a[0] + c[1][0] * a[1] + c[2][0] * a[2]),
        a[1] + (c[0][1] * a[0] + c[1][1] * a[1] + c[2][1] * a[2]),
        a[2] + (c[0][2] * a[0] + c[1][2] * a[1] + c[2][2] * a[2]),
    )


@inlined
def turned_back(columns, a):
    """Return the transpose of R times a, from the columns of R - 1."""
    c = columns
    return a[0] + dot(c[0], a), a[1] + dot(c[1], a), a[2] + dot(c[2], a)


@inlined
def turn_by(half):
    """Return the unit quaternion of a rotation by twice the vector `half`, for small angles.

    cos and sin by their series up to the sixth power: below 1e-16 up to 0.02 rad a step.
    """
    s = dot(half, half)
    c = 1.0 - s * (0.5 - s * (1.0 / 24.0 - s / 720.0))
    k = 1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s / 5040.0))
    return c, k * half[0], k * half[1], k * half[2]


@inlined
def normalised(q):
    """Return q brought back to unit length, from which round-off takes it: one Newton step."""
    k = 1.5 - 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return k * q[0], k * q[1], k * q[2], k * q[3]
