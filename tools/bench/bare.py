"""The same updates as plain numba loops that a user would write by hand, without an engine.

They have no receivers, energy ledger, boundaries or other effects, and equal joints.
"""

import numba
import numpy as np

LANES, ROW = 64, 72


@numba.njit(cache=True, error_model="numpy")
def axial(u, v, rate, steps, dt, x, k, c, load):
    """Step a row of blocks with springs and dashpots; load : on the first block, N."""
    tail = u.size - 1
    for _ in range(steps):
        push = load
        for j in range(tail):
            r = v[j + 1] - v[j]
            f = -k * (u[j + 1] - u[j]) - c * (1.5 * r - 0.5 * rate[j])
            rate[j] = r
            v[j] += x * (push - f)
            u[j] += dt * v[j]
            push = f
        v[tail] += x * push
        u[tail] += dt * v[tail]


@numba.njit(cache=True, error_model="numpy")
def spatial(motion, slides, forces, steps, dt, k_n, k_s, b, mu, c, h, x, xi, xj):
    """Step a row of blocks: six freedoms, 2 x 2 points at +-b with Coulomb slip, 64 blocks a tile.

    motion : [tiles, 12 rows of 72], slides : [tiles, 8 rows of 64], forces : [6 rows of 72].
    """
    tiles = motion.shape[0]
    for _ in range(steps):
        for f in range(6):
            forces[f * ROW] = 0.0
        for t in range(tiles):
            m = motion[t]
            if t + 1 < tiles:
                following = motion[t + 1]
                for f in range(12):
                    m[f * ROW + LANES] = following[f * ROW]
            contacts(m, slides[t], forces, dt, k_n, k_s, b, mu, c, h)
            if t + 1 == tiles:
                for f in range(6):
                    forces[f * ROW + LANES] = 0.0
            move(m, forces, dt, h, x, xi, xj)
            for f in range(6):
                forces[f * ROW] = forces[f * ROW + LANES]


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def point(e, p, i, gap, dx, dz, k_n, k_s, mu, c):
    """Advance the elastic slip of one point and return its forces, N."""
    t_n = -k_n * gap
    ex, ez = e[2 * p * LANES + i] + dx, e[(2 * p + 1) * LANES + i] + dz
    strength, t = max(c + mu * t_n, 0.0), k_s * np.sqrt(ex * ex + ez * ez)
    share = strength / t if t > strength else 1.0
    ex *= share
    ez *= share
    e[2 * p * LANES + i], e[(2 * p + 1) * LANES + i] = ex, ez
    return t_n, -k_s * ex, -k_s * ez


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def contacts(m, e, q, dt, k_n, k_s, b, mu, c, h):
    """Compute the forces of a tile's joints."""
    for i in range(LANES):
        gy = m[ROW + i + 1] - m[ROW + i]
        px = m[3 * ROW + i + 1] - m[3 * ROW + i]
        pz = m[5 * ROW + i + 1] - m[5 * ROW + i]
        sx = m[6 * ROW + i + 1] - m[6 * ROW + i] + h * (m[11 * ROW + i + 1] + m[11 * ROW + i])
        sz = m[8 * ROW + i + 1] - m[8 * ROW + i] - h * (m[9 * ROW + i + 1] + m[9 * ROW + i])
        wy = m[10 * ROW + i + 1] - m[10 * ROW + i]
        sx, sz, wy = dt * sx, dt * sz, dt * wy
        bx, bz, by = b * px, b * pz, b * wy
        n0, x0, z0 = point(e, 0, i, gy - bz + bx, sx - by, sz + by, k_n, k_s, mu, c)
        n1, x1, z1 = point(e, 1, i, gy + bz + bx, sx - by, sz - by, k_n, k_s, mu, c)
        n2, x2, z2 = point(e, 2, i, gy - bz - bx, sx + by, sz + by, k_n, k_s, mu, c)
        n3, x3, z3 = point(e, 3, i, gy + bz - bx, sx + by, sz - by, k_n, k_s, mu, c)
        q[i + 1] = x0 + x1 + x2 + x3
        q[ROW + i + 1] = n0 + n1 + n2 + n3
        q[2 * ROW + i + 1] = z0 + z1 + z2 + z3
        q[3 * ROW + i + 1] = b * (n0 + n1 - n2 - n3)
        q[4 * ROW + i + 1] = b * (x2 + x3 - x0 - x1) - b * (z1 + z3 - z0 - z2)
        q[5 * ROW + i + 1] = b * (n1 + n3 - n0 - n2)


@numba.njit(cache=True, error_model="numpy", forceinline=True)
def move(m, q, dt, h, x, xi, xj):
    """Move a tile's blocks."""
    for i in range(LANES):
        vx = m[6 * ROW + i] + x * (q[i] - q[i + 1])
        vy = m[7 * ROW + i] + x * (q[ROW + i] - q[ROW + i + 1])
        vz = m[8 * ROW + i] + x * (q[2 * ROW + i] - q[2 * ROW + i + 1])
        turn = h * (q[2 * ROW + i] + q[2 * ROW + i + 1])
        wx = m[9 * ROW + i] + xi * (q[3 * ROW + i] - q[3 * ROW + i + 1] - turn)
        wy = m[10 * ROW + i] + xj * (q[4 * ROW + i] - q[4 * ROW + i + 1])
        turn = h * (q[i] + q[i + 1])
        wz = m[11 * ROW + i] + xi * (q[5 * ROW + i] - q[5 * ROW + i + 1] + turn)
        m[6 * ROW + i], m[7 * ROW + i], m[8 * ROW + i] = vx, vy, vz
        m[9 * ROW + i], m[10 * ROW + i], m[11 * ROW + i] = wx, wy, wz
        m[i] += dt * vx
        m[ROW + i] += dt * vy
        m[2 * ROW + i] += dt * vz
        m[3 * ROW + i] += dt * wx
        m[4 * ROW + i] += dt * wy
        m[5 * ROW + i] += dt * wz
