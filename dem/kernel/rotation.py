"""Rotations of any size by unit quaternions, and the free rotation of blocks.

With I_1 <= I_2 <= I_3 a block's principal moments of inertia, a and c its axes of I_1 and I_3, and
L its angular momentum, twice its energy is

    L.L / I_2 + (1/I_1 - 1/I_2) (L.a)^2 + (1/I_3 - 1/I_2) (L.c)^2.

Each term alone turns the block about a constant axis, L, a or c. A step composes these rotations:
half about c, about a, half about c, about L. It conserves L and is exact where two moments are
equal, else of second order and symplectic (Touma & Wisdom, Astron. J. 107, 1994; Dullweber,
Leimkuhler & McLachlan, J. Chem. Phys. 107, 1997).

In kernels vectors, quaternions (scalar part first) and the columns of R - 1 are tuples of numbers.
"""

import numpy as np

from jointwave.dem.kernel.model import Blocks
from jointwave.joints.formula import formula

ALIKE = 1e-12  # relative difference below which moments of inertia count as equal
# Columns of the constants of free motion: a, c, 1/I_2, then 1/I_1 - 1/I_2 and 1/I_3 - 1/I_2.
SMALLEST, LARGEST, MIDDLE, EXCESS = 0, 3, 6, 7


def free_motion(blocks: Blocks) -> np.ndarray:
    """Return the constants of free rotation of the blocks [N, 9]."""
    tensor = blocks.tensor
    if tensor is None:
        tensor = blocks.inertia[:, 3:, None] * np.eye(3)
    moments, axes = np.linalg.eigh(tensor)
    back = 1 / moments
    excess = back[:, [0, 2]] - back[:, [1]]
    excess[np.abs(excess) < ALIKE * back[:, [1]]] = 0.0
    return np.concatenate([axes[..., 0], axes[..., 2], back[:, [1]], excess], axis=1)


@formula
def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@formula
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@formula
def plus(a, b):
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@formula
def minus(a, b):
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@formula
def times(k, a):
    """Return k a, k a number."""
    return k * a[0], k * a[1], k * a[2]


@formula
def three(m, i, stride):
    """Return three entries of an array from i on."""
    return m[i], m[i + stride], m[i + 2 * stride]


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
    """Return the columns of R - 1, which keep the digits of small rotations."""
    w, x, y, z = q
    return (
        (-2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        (2.0 * (x * y - w * z), -2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), -2.0 * (x * x + y * y)),
    )


@formula
def further(c, a):
    """Return R a - a from the columns c of R - 1."""
    return (
        c[0][0] * a[0] + c[1][0] * a[1] + c[2][0] * a[2],
        c[0][1] * a[0] + c[1][1] * a[1] + c[2][1] * a[2],
        c[0][2] * a[0] + c[1][2] * a[1] + c[2][2] * a[2],
    )


@formula
def further_back(c, a):
    """Return R^T a - a from the columns c of R - 1."""
    return dot(c[0], a), dot(c[1], a), dot(c[2], a)


@formula
def turned(c, a):
    """Return R a from the columns c of R - 1."""
    return plus(a, further(c, a))


@formula
def turn_by(a):
    """Return the unit quaternion of a rotation by twice the vector a, for small angles.

    cos and sin by their series to the eighth power: errors below 1e-16 up to 0.2 rad a step.
    """
    s = dot(a, a)
    c = 1.0 - s * (0.5 - s * (1.0 / 24.0 - s * (1.0 / 720.0 - s / 40320.0)))
    k = 1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0 - s / 362880.0)))
    return c, k * a[0], k * a[1], k * a[2]


@formula
def angular_velocity(free, q, momentum):
    """Return the angular velocity of an angular momentum; free : a row of `free_motion`."""
    found, c = times(free[MIDDLE], momentum), columns_less_one(q)
    for k in range(2):
        if free[EXCESS + k] != 0.0:
            axis = turned(c, three(free, 3 * k, 1))
            found = plus(found, times(free[EXCESS + k] * dot(momentum, axis), axis))
    return found


@formula
def angular_momentum(free, rate):
    """Return the angular momentum of an unrotated block from its angular velocity."""
    middle = 1.0 / free[MIDDLE]
    found = times(middle, rate)
    for k in range(2):
        axis, moment = three(free, 3 * k, 1), 1.0 / (free[MIDDLE] + free[EXCESS + k])
        found = plus(found, times((moment - middle) * dot(rate, axis), axis))
    return found


@formula
def turned_about(free, k, q, momentum, dt):
    """Return a quaternion after dt, s, of rotation about the block's own axis k alone."""
    if free[EXCESS + k] == 0.0:
        return q
    axis = three(free, 3 * k, 1)
    along = dot(momentum, turned(columns_less_one(q), axis))
    return product(q, turn_by(times(0.5 * dt * free[EXCESS + k] * along, axis)))


@formula
def turned_freely(free, q, momentum, dt):
    """Return a quaternion after dt, s, of free rotation."""
    q = turned_about(free, 1, q, momentum, 0.5 * dt)
    q = turned_about(free, 0, q, momentum, dt)
    q = turned_about(free, 1, q, momentum, 0.5 * dt)
    w, x, y, z = product(turn_by(times(0.5 * dt * free[MIDDLE], momentum)), q)
    k = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)  # unit length again, by one Newton step
    return k * w, k * x, k * y, k * z


@formula
def quaternion(turn, u, block):
    """Return the quaternion of a block from its vector part in u and its scalar part in turn."""
    x, y, z = three(u, 6 * block + 3, 1)
    return turn[block], x, y, z


@formula
def turn_blocks(blocks, first, turn, u, v, dt):
    """Rotate the blocks from `first` on by their angular momenta over dt, s."""
    for block in range(u.size // 6):
        i, free = 6 * block + 3, blocks.free[first + block]
        q = quaternion(turn, u, block)
        turn[block], u[i], u[i + 1], u[i + 2] = turned_freely(free, q, three(v, i, 1), dt)


@formula
def rate(blocks, first, turn, u, v, i):
    """Return component i of velocity and angular velocity, of blocks from `first` on."""
    block = i // 6
    if i % 6 < 3:
        return v[i]
    q, momentum = quaternion(turn, u, block), three(v, 6 * block + 3, 1)
    return angular_velocity(blocks.free[first + block], q, momentum)[i % 6 - 3]
