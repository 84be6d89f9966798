"""Motion of the blocks of one tile, by the forces of their two joints.

m v' = F_left - F_right + m g,   I omega' = M_left - M_right + h y x (-(F_left + F_right)),

with y x F = (F_z, 0, -F_x): the shear forces of both joints turn a block the same way. With finite
rotations the angular momentum advances by the moments about the centroid, and turns the block.
"""

from collections.abc import Callable
from math import copysign
from typing import NamedTuple

import numpy as np

from dem.spatial.finite import angular_velocity, put_three, three, turn_by_momentum
from dem.spatial.layout import ABOUT_X, ABOUT_Y, ABOUT_Z, BEFORE, LEFT, MOMENTA, Form, X, Y, Z
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from joints.formula import formula


class Block(NamedTuple):
    """The constants of one block and of the face between two; kernels take them as one array.

    dt : s. arm : half the thickness, m. half_side : of the section, m. keep : what
    mass-proportional damping leaves of a velocity in a step. local : Cundall's damping. mass : kg;
    inertia_across : about x and z, inertia_along : about y, kg m2. freedoms : 3 or 6; kernels take
    it as a number, which keeps compilers from writing out the loops over it.

    The rest are float arrays [6], for x, y, z and the rotations about them. inertia : kg and kg m2.
    push : what a force or moment adds to a velocity in a step, dt / m and dt / I, less by
    mass-proportional damping. fall : what gravity adds, m/s. weight : m g, N. face : sums over the
    points of a face: A, m2, three times, then A z^2, A (x^2 + z^2) and A x^2, m4.
    """

    dt: float
    arm: float
    half_side: float
    keep: float
    local: float
    mass: float
    inertia_across: float
    inertia_along: float
    freedoms: int
    inertia: np.ndarray
    push: np.ndarray
    fall: np.ndarray
    weight: np.ndarray
    face: np.ndarray

    def as_array(self) -> np.ndarray:
        """Return all in one array [6, 9], as kernels take them."""
        rows = np.zeros((6, 9))
        rows[0], rows[1:, :6] = self[:9], self[9:]
        return rows


class Constants(NamedTuple):
    """A block as kernels use it: `rows` is the whole array, a quantity's row for each freedom.

    One array, not five: every array makes every call that passes it longer to compile.
    """

    dt: float
    arm: float
    half_side: float
    keep: float
    local: float
    mass: float
    inertia_across: float
    inertia_along: float
    freedoms: int
    rows: np.ndarray


INERTIA, PUSH, FALL, WEIGHT, FACE = range(1, 6)  # rows


@formula
def constants_of(c):
    """Return the constants of a block from its array."""
    return Constants(
        c[0, 0], c[0, 1], c[0, 2], c[0, 3], c[0, 4], c[0, 5], c[0, 6], c[0, 7], int(c[0, 8]), c
    )


def motion_for(form: Form) -> Callable:
    """Return the formula that advances the blocks of a tile by one step."""
    velocity, turns, finite, ledger = form.freedoms * R, form.turns, form.finite, form.ledger
    gravity, local_damping = form.gravity, form.local_damping
    mass_damping = form.mass_damping or form.relaxed

    @formula
    def advanced(b, v, gain):
        """Return a velocity after the step, from that before it and what its forces would add."""
        if local_damping:  # less by local |gain| along v
            gain = gain - b.local * copysign(abs(gain), v) if v != 0.0 else gain
        if mass_damping:
            v = b.keep * v
        return v + gain

    @formula
    def advance_one(b, m, q, i, f, push, fall):
        """Advance one component of velocity and displacement, or of both angular ones, by f."""
        gain = push * f
        if gravity:
            gain += fall
        old = m[velocity + i]
        if ledger:
            q[BEFORE + i] = old
        new = advanced(b, old, gain)
        m[velocity + i] = new
        m[i] += b.dt * new

    @formula
    def turn(b, m, q, n):
        """Advance angular momenta by the moments of a step, and turn the blocks by them."""
        gain = b.rows[PUSH, 0] * b.mass  # dt, less by mass-proportional damping
        for i in range(min(n, L)):
            momentum, at = three(m, velocity + ABOUT_X, i), i + 1 + LEFT
            moment = three(q, ABOUT_X, i)
            if ledger:
                put_three(q, MOMENTA + i, momentum)
                put_three(q, BEFORE + ABOUT_X + i, angular_velocity(b, m, i))
            momentum = (
                advanced(b, momentum[0], gain * (moment[0] + q[at + X])),
                advanced(b, momentum[1], gain * (moment[1] + q[at + Y])),
                advanced(b, momentum[2], gain * (moment[2] + q[at + Z])),
            )
            put_three(m, velocity + ABOUT_X + i, momentum)
            turn_by_momentum(b, m, i, momentum)

    @formula
    def advance(b, m, q, n):
        """Advance the first n blocks of a tile; the ledger finds their velocities before it in q.

        m : motion of the tile. q : its buffer, with the forces of all joints.
        """
        push, x, y, z = b.rows[PUSH, 0], b.rows[FALL, 0], b.rows[FALL, 1], b.rows[FALL, 2]
        for i in range(min(n, L)):
            advance_one(b, m, q, X + i, q[X + i] - q[X + i + 1], push, x)
            advance_one(b, m, q, Y + i, q[Y + i] - q[Y + i + 1], push, y)
            advance_one(b, m, q, Z + i, q[Z + i] - q[Z + i + 1], push, z)
        if finite:
            turn(b, m, q, n)
        elif turns:
            across, along = b.rows[PUSH, 3], b.rows[PUSH, 4]
            for i in range(min(n, L)):
                x = q[ABOUT_X + i] - q[ABOUT_X + i + 1] - b.arm * (q[Z + i] + q[Z + i + 1])
                z = q[ABOUT_Z + i] - q[ABOUT_Z + i + 1] + b.arm * (q[X + i] + q[X + i + 1])
                advance_one(b, m, q, ABOUT_X + i, x, across, 0.0)
                advance_one(b, m, q, ABOUT_Y + i, q[ABOUT_Y + i] - q[ABOUT_Y + i + 1], along, 0.0)
                advance_one(b, m, q, ABOUT_Z + i, z, across, 0.0)

    return advance
