"""Relative motion at contacts of blocks that turn by any angle in space, and its adjoint.

As `dem.kernel` has it: points of block i, seen from block j in the axes that turn with it. Rows of
relative motion are the jump at the centre of the face, then what further points along the first and
the second tangent add to it, per metre.
"""

from collections.abc import Callable

import numpy as np

from jointwave.dem.chunks import LANES as L
from jointwave.dem.model import KernelFlags
from jointwave.dem.rotation import (
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
from jointwave.joints.formula import formula


@formula
def put(q, row, values):
    """Put three numbers into rows of the buffer."""
    q[row], q[row + L], q[row + 2 * L] = values


def orientations_for(form: KernelFlags) -> Callable:
    """Return the formula of the quaternions of the blocks of a contact, among what is gathered."""
    VECTOR, SCALAR = form.buffer.gathered + 3 * L, form.buffer.gathered + 9 * L

    @formula
    def orientations(q, c):
        """Return those of i and of j in lane c."""
        x, y, z = three(q, VECTOR + c, L)
        i = q[SCALAR + c], x, y, z
        x, y, z = three(q, VECTOR + 3 * L + c, L)
        return i, (q[SCALAR + L + c], x, y, z)

    return orientations


def finite_jump_for(form: KernelFlags) -> Callable:
    """Return the formula of the relative motion of a chunk's contacts, of what is gathered."""
    ARM_I, ARM_J, FRAME = form.table.arm_i, form.table.arm_j, form.table.frame
    GATHERED, JUMP = form.buffer.gathered, form.buffer.jump
    SCALAR, orientations = GATHERED + 9 * L, orientations_for(form)

    @formula
    def finite_jump(turn, at, k, q):
        """Put the rows of relative motion; turn : scalar parts of the blocks' quaternions."""
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
    """Return the formula of the force on j and the moments about both centroids."""
    ARM_I, ARM_J, FRAME = form.table.arm_i, form.table.arm_j, form.table.frame
    rows, orientations = form.buffer, orientations_for(form)
    GATHERED, JUMP, FORCE, SPREAD, ON_J, ON_I = (
        rows.gathered, rows.jump, rows.force, rows.spread, rows.on_j, rows.on_i
    )  # fmt: skip

    @formula
    def from_frame(k, c, a):
        """Return a vector given in the frame of a contact."""
        found = times(a[0], three(k, FRAME + c, L))
        found = plus(found, times(a[1], three(k, FRAME + 3 * L + c, L)))
        return plus(found, times(a[2], three(k, FRAME + 6 * L + c, L)))

    @formula
    def finite_moments(k, q):
        """Put the force on j, and the moments about the centroids of j and of i, into rows."""
        for c in range(L):
            force, jump = three(q, FORCE + c, L), three(q, JUMP + c, L)
            x, y, z = three(q, JUMP + 3 * L + c, L)
            moment = cross((-x, 1.0 - y, -z), three(q, SPREAD + c, L))
            x, y, z = three(q, JUMP + 6 * L + c, L)
            moment = plus(moment, cross((-x, -y, 1.0 - z), three(q, SPREAD + 3 * L + c, L)))
            moment = from_frame(k, c, minus(moment, cross(jump, force)))
            force, arm = from_frame(k, c, force), three(k, ARM_J + c, L)
            frame = columns_less_one(orientations(q, c)[1])
            moment = turned(frame, plus(moment, cross(arm, force)))
            force = turned(frame, force)
            apart = plus(three(q, GATHERED + c, L), minus(three(k, ARM_I + c, L), arm))
            put(q, ON_J + c, force)
            put(q, ON_J + 3 * L + c, moment)
            put(q, ON_I + c, plus(moment, cross(apart, force)))

    return finite_moments
