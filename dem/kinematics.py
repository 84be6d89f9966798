"""Relative motion of blocks at contacts in the plane and in space; its adjoint, their forces."""

from collections.abc import Callable

import numpy as np

from jointwave.dem.chunks import LANES as L
from jointwave.dem.finite import finite_jump_for, finite_moments_for
from jointwave.dem.model import KernelFlags
from jointwave.joints.formula import formula


@formula
def cross(ax, ay, az, bx, by, bz):
    """Return a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def relative_for(form: KernelFlags) -> Callable:
    """Return the formula of the relative motion of a chunk's contacts."""
    dim, turns, freedoms, rotations = form.dim, form.turns, form.freedoms, form.rotations
    shaken, in_row, GATHERED = form.shaken, form.in_row, form.buffer.gathered
    finite, finite_jump = form.finite, finite_jump_for(form)
    FRAME, ARM_I, ARM_J = form.table.frame, form.table.arm_i, form.table.arm_j

    @formula
    def gather(m, walls, n, kind, still, at, row_from, q):
        """Put displacements of j less those of i, and the rotations of both, into rows. Loops that
        gather are not vectorised, those along a row of blocks from `row_from` on are."""
        if in_row and row_from >= 0:
            i = m[row_from:]
            for b in range(dim):
                for c in range(L):
                    q[GATHERED + b * L + c] = i[freedoms * (c + 1) + b] - i[freedoms * c + b]
            for b in range(rotations):
                for c in range(L):
                    q[GATHERED + (dim + b) * L + c] = i[freedoms * c + dim + b]
                    q[GATHERED + (freedoms + b) * L + c] = i[freedoms * (c + 1) + dim + b]
            return
        for c in range(L):
            i, j = np.uint64(at[c]), np.uint64(at[L + c])  # unsigned: they do not wrap around
            for b in range(dim):
                a = np.uint64(b)
                moved = m[j + a]
                if shaken:
                    w = at[L + c] - still
                    moved = walls[n, kind, w + b] if w > 0 else moved
                q[GATHERED + b * L + c] = moved - m[i + a]
            for b in range(rotations):
                a = np.uint64(dim + b)
                q[GATHERED + (dim + b) * L + c] = m[i + a]
                q[GATHERED + (freedoms + b) * L + c] = m[j + a]

    @formula
    def relative(m, turn, walls, n, kind, still, at, row_from, k, q, to):
        """Put the jump at the centres of contacts, and the rotation of j against i, in their frame,
        into the rows from `to` on.

        m : motion of blocks. turn : as in `State`. kind : row of it in the motion of walls. still :
        where theirs begins, less one block. k : the chunk's table. q : the buffer.
        """
        gather(m, walls, n, kind, still, at, row_from, q)
        if finite:
            finite_jump(turn, at, k, q)
            return
        for c in range(L):
            r = GATHERED + c
            if dim == 2:
                n_x, n_y, x, y = k[FRAME + c], k[FRAME + L + c], q[r], q[r + L]
                i, j = q[r + 2 * L], q[r + 3 * L]
                x -= j * k[ARM_J + L + c] - i * k[ARM_I + L + c]
                y += j * k[ARM_J + c] - i * k[ARM_I + c]
                q[to + c], q[to + L + c] = n_x * x + n_y * y, n_x * y - n_y * x
                q[to + 2 * L + c] = j - i
            else:
                x, y, z, tx, ty, tz = q[r], q[r + L], q[r + 2 * L], 0.0, 0.0, 0.0
                if turns:
                    a, b, i, j = ARM_I + c, ARM_J + c, r + 3 * L, r + 6 * L
                    ix, iy, iz = q[i], q[i + L], q[i + 2 * L]
                    jx, jy, jz = q[j], q[j + L], q[j + 2 * L]
                    sx, sy, sz = cross(jx, jy, jz, k[b], k[b + L], k[b + 2 * L])
                    tx, ty, tz = cross(ix, iy, iz, k[a], k[a + L], k[a + 2 * L])
                    x, y, z = x + (sx - tx), y + (sy - ty), z + (sz - tz)
                    tx, ty, tz = jx - ix, jy - iy, jz - iz
                for a in range(3):
                    e, f = FRAME + 3 * a * L + c, to + a * L + c
                    e_x, e_y, e_z = k[e], k[e + L], k[e + 2 * L]
                    q[f] = e_x * x + e_y * y + e_z * z
                    if turns:
                        q[f + 3 * L] = e_x * tx + e_y * ty + e_z * tz

    return relative


def onto_blocks_for(form: KernelFlags) -> Callable:
    """Return the formula that adds the forces of a chunk's contacts to their blocks."""
    dim, turns, freedoms, in_row = form.dim, form.turns, form.freedoms, form.in_row
    finite, finite_moments = form.finite, finite_moments_for(form)
    FRAME, ARM_I, ARM_J = form.table.frame, form.table.arm_i, form.table.arm_j
    FORCE, SPREAD, ON_J, ON_I = (
        form.buffer.force, form.buffer.spread, form.buffer.on_j, form.buffer.on_i
    )  # fmt: skip

    @formula
    def about_centroids(k, q):
        """Put the force on j, and the moments about the centroids of j and of i, into rows."""
        for c in range(L):
            f_n, j, i = q[FORCE + c], ON_J + c, ON_I + c
            if dim == 2:
                n_x, n_y, f_t = k[FRAME + c], k[FRAME + L + c], q[FORCE + L + c]
                x, y, m = n_x * f_n - n_y * f_t, n_y * f_n + n_x * f_t, -q[SPREAD + c]
                q[j], q[j + L] = x, y
                q[j + 2 * L] = m + (k[ARM_J + c] * y - k[ARM_J + L + c] * x)
                q[i] = m + (k[ARM_I + c] * y - k[ARM_I + L + c] * x)
            else:
                x, y, z, mx, my, mz, m_n, m_1, m_2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                if turns:
                    s = SPREAD + c
                    m_n, m_1, m_2 = q[s + 2 * L] - q[s + 4 * L], q[s + 3 * L], -q[s]
                for a in range(3):
                    e, f = FRAME + 3 * a * L + c, q[FORCE + a * L + c]
                    x, y, z = x + k[e] * f, y + k[e + L] * f, z + k[e + 2 * L] * f
                    if turns:
                        f = m_n if a == 0 else (m_1 if a == 1 else m_2)
                        mx, my, mz = mx + k[e] * f, my + k[e + L] * f, mz + k[e + 2 * L] * f
                q[j], q[j + L], q[j + 2 * L] = x, y, z
                if turns:
                    a, j = ARM_J + c, j + 3 * L
                    ax, ay, az = cross(k[a], k[a + L], k[a + 2 * L], x, y, z)
                    q[j], q[j + L], q[j + 2 * L] = mx + ax, my + ay, mz + az
                    a = ARM_I + c
                    ax, ay, az = cross(k[a], k[a + L], k[a + 2 * L], x, y, z)
                    q[i], q[i + L], q[i + 2 * L] = mx + ax, my + ay, mz + az

    @formula
    def onto_blocks(k, q, at, row_from, lanes, last, force):
        """Add what acts on blocks, in the order of the contacts.

        lanes : contacts of the chunk. last : where the motion of walls begins.
        """
        if finite:
            finite_moments(k, q)
        else:
            about_centroids(k, q)
        if in_row and row_from >= 0:
            own = force[row_from:]
            for b in range(freedoms):
                on_j, on_i = ON_J + b * L, (ON_J if b < dim else ON_I - dim * L) + b * L
                own[b] -= q[on_i]
                for c in range(1, L):
                    own[freedoms * c + b] += q[on_j + c - 1] - q[on_i + c]
                own[freedoms * L + b] += q[on_j + L - 1]
            return
        for c in range(lanes):
            i, j = np.uint64(at[c]), np.uint64(at[L + c])
            for b in range(freedoms):
                on_i = (ON_J if b < dim else ON_I - dim * L) + b * L
                force[i + np.uint64(b)] -= q[on_i + c]
            if at[L + c] < last:
                for b in range(freedoms):
                    force[j + np.uint64(b)] += q[ON_J + b * L + c]

    return onto_blocks
