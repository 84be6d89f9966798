"""Relative motion of blocks at contacts in the plane and in space, and its adjoint, the forces.

With finite rotations, the motion of points of block i in axes that turn with block j (see `loop`).
The rows are then the jump at the centre of the face, and its gradients along both tangents.
"""

from collections.abc import Callable

import numpy as np

from jointwave.dem.contacts.chunks import LANES as L
from jointwave.dem.kernel.model import KernelFlags
from jointwave.dem.kernel.rotation import (
    columns_less_one,
    cross,
    dot,
    further,
    further_back,
    minus,
    plus,
    product,
    three,
    times,
    turned,
)
from jointwave.dem.kernel.sharing import of_motion, shared
from jointwave.joints.formula import formula


@formula
def set_three(q, row, values):
    """Set three consecutive rows of the buffer."""
    q[row], q[row + L], q[row + 2 * L] = values


@formula
def in_axes(k, frame, a):
    """Return in global axes a vector a of a contact's frame, which begins at k of the table."""
    found = plus(times(a[0], three(k, frame, L)), times(a[1], three(k, frame + 3 * L, L)))
    return plus(found, times(a[2], three(k, frame + 6 * L, L)))


def orientations_for(form: KernelFlags) -> Callable:
    """Return the kernel that reads a contact's two quaternions from the gathered rows."""
    VECTOR, SCALAR = form.buffer.gathered + 3 * L, form.buffer.gathered + 9 * L

    @formula
    def orientations(q, c):
        """Return the quaternions of blocks i and j in lane c."""
        x, y, z = three(q, VECTOR + c, L)
        i = q[SCALAR + c], x, y, z
        x, y, z = three(q, VECTOR + 3 * L + c, L)
        return i, (q[SCALAR + L + c], x, y, z)

    return orientations


def finite_jump_for(form: KernelFlags) -> Callable:
    """Return the kernel of relative motion under finite rotation, from the gathered rows."""
    ARM_I, ARM_J, FRAME = form.table.arm_i, form.table.arm_j, form.table.frame
    GATHERED, JUMP = form.buffer.gathered, form.buffer.jump
    SCALAR, orientations = GATHERED + 9 * L, orientations_for(form)

    @formula
    def finite_jump(turn, at, k, q):
        """Set the rows of relative motion; turn : scalar parts of the blocks' quaternions."""
        for c in range(L):
            i, j = np.uint64(at[c]), np.uint64(at[L + c])
            q[SCALAR + c], q[SCALAR + L + c] = turn[i // np.uint64(6)], turn[j // np.uint64(6)]
        for c in range(L):
            of_i, of_j = orientations(q, c)
            back = of_j[0], -of_j[1], -of_j[2], -of_j[3]
            seen, frame = columns_less_one(product(back, of_i)), columns_less_one(of_j)
            arm, apart = three(k, ARM_I + c, L), three(q, GATHERED + c, L)
            between = plus(apart, minus(arm, three(k, ARM_J + c, L)))
            jump = minus(plus(apart, further_back(frame, between)), further(seen, arm))
            first, second = FRAME + 3 * L + c, FRAME + 6 * L + c
            along = further(seen, three(k, first, L))
            across = further(seen, three(k, second, L))
            for a in range(3):
                e, row = three(k, FRAME + 3 * a * L + c, L), JUMP + a * L + c
                q[row] = dot(e, jump)
                q[row + 3 * L] = -dot(e, along)
                q[row + 6 * L] = -dot(e, across)

    return finite_jump


def finite_moments_for(form: KernelFlags) -> Callable:
    """Return the kernel of forces and moments under finite rotation."""
    ARM_I, ARM_J, FRAME = form.table.arm_i, form.table.arm_j, form.table.frame
    rows, orientations = form.buffer, orientations_for(form)
    GATHERED, JUMP, FORCE, SPREAD, ON_J, ON_I = (
        rows.gathered, rows.jump, rows.force, rows.spread, rows.on_j, rows.on_i
    )  # fmt: skip

    @formula
    def finite_moments(k, q):
        """Set the rows of the force on j and of the moments about the centroids of j and i."""
        for c in range(L):
            force, jump = three(q, FORCE + c, L), three(q, JUMP + c, L)
            x, y, z = three(q, JUMP + 3 * L + c, L)
            moment = cross((-x, 1.0 - y, -z), three(q, SPREAD + c, L))
            x, y, z = three(q, JUMP + 6 * L + c, L)
            moment = plus(moment, cross((-x, -y, 1.0 - z), three(q, SPREAD + 3 * L + c, L)))
            moment = in_axes(k, FRAME + c, minus(moment, cross(jump, force)))
            force, arm = in_axes(k, FRAME + c, force), three(k, ARM_J + c, L)
            frame = columns_less_one(orientations(q, c)[1])
            moment = turned(frame, plus(moment, cross(arm, force)))
            force = turned(frame, force)
            apart = plus(three(q, GATHERED + c, L), minus(three(k, ARM_I + c, L), arm))
            set_three(q, ON_J + c, force)
            set_three(q, ON_J + 3 * L + c, moment)
            set_three(q, ON_I + c, plus(moment, cross(apart, force)))

    return finite_moments


@shared(of_motion)
def relative_for(form: KernelFlags) -> Callable:
    """Return the kernel of the relative motion of a chunk's contacts."""
    dim, turns, freedoms, rotations = form.dim, form.turns, form.freedoms, form.rotations
    shaken, in_row, GATHERED = form.shaken, form.in_row, form.buffer.gathered
    finite, finite_jump = form.finite, finite_jump_for(form)
    FRAME, ARM_I, ARM_J = form.table.frame, form.table.arm_i, form.table.arm_j

    @formula
    def gather(m, walls, n, kind, still, at, row_from, q):
        """Set the rows of displacements of j less those of i, and of both rotations. Loops that
        gather are not vectorised; those along a row of blocks from `row_from` on are."""
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
        """Set the rows from `to` on: jump at the centre, and rotation of j less that of i, in the
        contact's frame.

        m : motion of blocks. turn : as in `State`. kind : row of walls, 0 displacement, 1 velocity.
        still : offset of the walls' motion, less one block. k : the chunk's table. q : the buffer.
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
                    ix, iy, iz = three(q, i, L)
                    jx, jy, jz = three(q, j, L)
                    sx, sy, sz = cross((jx, jy, jz), three(k, b, L))
                    tx, ty, tz = cross((ix, iy, iz), three(k, a, L))
                    x, y, z = x + (sx - tx), y + (sy - ty), z + (sz - tz)
                    tx, ty, tz = jx - ix, jy - iy, jz - iz
                for a in range(3):
                    e, f = FRAME + 3 * a * L + c, to + a * L + c
                    e_x, e_y, e_z = k[e], k[e + L], k[e + 2 * L]
                    q[f] = e_x * x + e_y * y + e_z * z
                    if turns:
                        q[f + 3 * L] = e_x * tx + e_y * ty + e_z * tz

    return relative


@shared(of_motion)
def onto_blocks_for(form: KernelFlags) -> Callable:
    """Return the kernel that adds the forces of a chunk's contacts to their blocks."""
    dim, turns, freedoms, in_row = form.dim, form.turns, form.freedoms, form.in_row
    finite, finite_moments = form.finite, finite_moments_for(form)
    FRAME, ARM_I, ARM_J = form.table.frame, form.table.arm_i, form.table.arm_j
    FORCE, SPREAD, ON_J, ON_I = (
        form.buffer.force, form.buffer.spread, form.buffer.on_j, form.buffer.on_i
    )  # fmt: skip

    @formula
    def about_centroids(k, q):
        """Set the rows of the force on j and of the moments about the centroids of j and i."""
        for c in range(L):
            f_n, j, i = q[FORCE + c], ON_J + c, ON_I + c
            if dim == 2:
                n_x, n_y, f_t = k[FRAME + c], k[FRAME + L + c], q[FORCE + L + c]
                x, y, m = n_x * f_n - n_y * f_t, n_y * f_n + n_x * f_t, -q[SPREAD + c]
                q[j], q[j + L] = x, y
                q[j + 2 * L] = m + (k[ARM_J + c] * y - k[ARM_J + L + c] * x)
                q[i] = m + (k[ARM_I + c] * y - k[ARM_I + L + c] * x)
            else:
                force = in_axes(k, FRAME + c, three(q, FORCE + c, L))
                set_three(q, j, force)
                if turns:
                    s = SPREAD + c
                    moment = q[s + 2 * L] - q[s + 4 * L], q[s + 3 * L], -q[s]
                    moment = in_axes(k, FRAME + c, moment)
                    set_three(q, j + 3 * L, plus(moment, cross(three(k, ARM_J + c, L), force)))
                    set_three(q, i, plus(moment, cross(three(k, ARM_I + c, L), force)))

    @formula
    def onto_blocks(k, q, at, row_from, lanes, last, force):
        """Add forces and moments to the blocks, in the order of the contacts.

        lanes : contacts of the chunk. last : offset of the walls' motion.
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
