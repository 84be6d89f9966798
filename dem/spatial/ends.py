"""Reactions of the two ends of the row: springs and dashpots on the end block's outer face.

All six components act at the face's centre (three where blocks do not turn): the axial and the
shear force, and the moments that the same springs and dashpots give spread over the face. The
dashpots see the mean of the velocities before and after the step; with the face's velocity p,

    R = -(S w + C (p[n-1/2] + p[n+1/2]) / 2),   p[n+1/2] = p* + Y R,

p* is the velocity that all else would give and Y what a unit reaction adds to it in the step, so
R = -G (S w + C (p[n-1/2] + p*) / 2) with G = (1 + C Y / 2)^-1.
"""

from collections.abc import Callable
from math import inf
from typing import NamedTuple

import numpy as np

from cases.material.calibrate import Properties
from cases.material.face import face_points
from cases.schema.scene import Scene
from dem.spatial.finite import angular_velocity
from dem.spatial.layout import ABOUT_X, LEFT, Form, X, Y, Z
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import FALL, PUSH, Block
from joints.ends import half_spring
from joints.formula import formula

# Rows of an end's constants, each for the freedoms x, y, z, about x, about y, about z.
STIFFNESS, VISCOSITY = 0, 1  # S and C
DECAY, GAIN = 2, 3  # of w <- decay w + gain p[n+1/2], gain in s
STEADY = 4  # what acts on the face all the time, N and N m: a prestress
BASE = 5  # what a unit of base motion takes from the closure
MATRIX = 6  # G, a row for each freedom

# Rows of what changes at an end: w, m and rad; R on the block, N and N m; the face's velocity
# before the step, m/s and rad/s; what a step works with.
CLOSURE, REACTION, VELOCITY, MEAN = range(4)


class Face(NamedTuple):
    """The shares of a unit normal and a unit shear stiffness (Pa/m), or dashpot, in the freedoms
    x, y, z, about x, y, z of a face: float arrays [6], m2 and m4."""

    normal: np.ndarray
    shear: np.ndarray

    def spread(self, normal: float, shear: float, size: int) -> np.ndarray:
        """Return what normal and shear springs or dashpots make of the first `size` freedoms."""
        return (normal * self.normal + shear * self.shear)[:size]


def contact_points(scene: Scene) -> np.ndarray:
    """Return x, z (m) and area (m2) of the contact points of a scene's faces, [3, points]; the
    centre alone where blocks do not turn."""
    if scene.motion.rotation == "none":
        return np.array([[0.0], [0.0], [scene.pillar.area]])
    joints = scene.joints
    rule = joints.point_rule or "midpoint"
    return np.array(face_points(scene.pillar.side, joints.contact_points or 2, rule))


def face_of(points: np.ndarray) -> Face:
    """Return the shares of a face's springs in each freedom, from its contact points."""
    x, area = points[0], points[2].sum()
    across = (points[2] * x**2).sum()
    normal, shear = [0, area, 0, across, 0, across], [area, 0, area, 0, 2 * across, 0]
    return Face(np.array(normal), np.array(shear))


class Springs(NamedTuple):
    """Half-block springs (N/m, N m) and the dashpots (N s/m, N m s) of the rock beyond an end,
    each [freedoms], and the springs' time constant eta, s."""

    stiffness: np.ndarray
    dashpot: np.ndarray
    time_constant: float


def end_springs(p: Properties, face: Face, size: int) -> Springs:
    """Return the springs 2 K' and the dashpots Z of an end face, spread over its freedoms."""
    stiffness = face.spread(2 * p.regular_stiffness, 2 * p.regular_shear_stiffness, size)
    dashpot = face.spread(p.impedance, p.shear_impedance, size)
    return Springs(stiffness, dashpot, p.time_constant or 0.0)


def end_constants(
    kind: str, side: float, springs: Springs, block: Block, steady: np.ndarray, base: np.ndarray
) -> np.ndarray:
    """Return the constants of an end of this kind [MATRIX + freedoms, freedoms].

    side : +1 at the start, -1 at the end. steady : [freedoms], N and N m. base : [freedoms], what
    a unit of base motion takes from the closure.
    """
    pairs = zip(springs.stiffness, springs.dashpot, strict=True)
    rows = [_component(kind, k, springs.time_constant, z, block.dt) for k, z in pairs]
    size, viscosity = len(steady), np.array(rows)[:, 1]
    matrix = np.eye(size) + viscosity[:, None] * mobility(block, side, size) / 2
    return np.vstack([np.transpose(rows), steady, base, np.linalg.inv(matrix)])


def _component(kind: str, k: float, eta: float, z: float, dt: float) -> tuple[float, ...]:
    if kind == "free":
        return 0.0, 0.0, 0.0, 0.0
    if kind == "quiet":
        return 0.0, z, 0.0, 0.0
    spring = half_spring(k, eta, inf if kind == "fixed" else z, dt)
    return spring.stiffness, spring.viscosity, spring.decay, spring.gain


def face_stiffness(kind: str, springs: Springs) -> np.ndarray:
    """Return what an end adds to its block's stiffness at the critical step, [freedoms]."""
    if kind in ("free", "quiet"):
        return np.zeros_like(springs.stiffness)
    z = np.full_like(springs.dashpot, inf) if kind == "fixed" else springs.dashpot
    pairs = zip(springs.stiffness, z, strict=True)
    return np.array([half_spring(k, springs.time_constant, z).critical_stiffness for k, z in pairs])


def lever_matrix(arm: float | None, size: int) -> np.ndarray:
    """Return T [size, size]: the velocity of a face from that of the block's centroid."""
    lever = np.eye(size)
    if arm is not None:
        lever[0, 5], lever[2, 3] = arm, -arm
    return lever


def mobility(block: Block, side: float, size: int) -> np.ndarray:
    """Return Y [size, size]: what a unit reaction adds to the face's velocity in a step."""
    lever = lever_matrix(side * block.arm if size == 6 else None, size)
    return lever @ np.diag(block.push[:size]) @ lever.T


def ends_for(form: Form) -> tuple[Callable, Callable, Callable]:
    """Return the formulas that add a force at the outer face of an end's block, that add the end's
    reaction, and that advance its closure."""
    turns, finite, velocity = form.turns, form.finite, form.freedoms * R

    @formula
    def add_at_face(b, q, i, side, factor, f):
        """Add factor times force and moment f at the face of block i; side : +1 at the start, -1 at
        the end."""
        lane = i if side > 0.0 else i + 1
        for k in range(3 if finite else b.freedoms):
            q[k * R + lane] += side * (factor * f[k])
        if finite:  # about the centroid
            lane += ABOUT_X if side > 0.0 else LEFT
            q[lane + X] += factor * (f[3] - side * b.arm * f[2])
            q[lane + Y] += factor * f[4]
            q[lane + Z] += factor * (f[5] + side * b.arm * f[0])

    @formula
    def put_velocity(b, p, m, i):
        """Put the velocity of block i, and its angular velocity, into p."""
        for k in range(b.freedoms):
            p[k] = m[velocity + k * R + i]
        if finite:
            p[3], p[4], p[5] = angular_velocity(b, m, i)

    @formula
    def at_face(b, p, side):
        """Turn the velocity of a block into that of its face, in place."""
        if turns:
            p[0] += side * b.arm * p[5]
            p[2] -= side * b.arm * p[3]

    @formula
    def put_net_force(b, p, q, i):
        """Put the force of both joints on block i, and their moment about its centroid, into p."""
        for k in range(b.freedoms):
            p[k] = q[k * R + i] - q[k * R + i + 1]
        if finite:
            for k in range(3):
                p[3 + k] = q[ABOUT_X + k * R + i] + q[LEFT + k * R + i + 1]
        elif turns:
            p[3] -= b.arm * (q[Z + i] + q[Z + i + 1])
            p[5] += b.arm * (q[X + i] + q[X + i + 1])

    @formula
    def add_reaction(b, end, state, m, q, i, side, moved):
        """Add the reaction of an end on block i to the buffer.

        end, state : its constants and what changes at it. moved : the displacement of its base
        over the step before and the one to come, m.
        """
        add_at_face(b, q, i, side, 1.0, end[STEADY])
        w, r, before, mean = state[CLOSURE], state[REACTION], state[VELOCITY], state[MEAN]
        put_velocity(b, before, m, i)
        put_net_force(b, mean, q, i)
        for k in range(b.freedoms):  # the velocity after the step without the end
            gain = b.rows[PUSH, k] * mean[k] + b.rows[FALL, k]
            mean[k] = b.keep * before[k] + gain
        at_face(b, before, side)
        at_face(b, mean, side)
        for k in range(b.freedoms):
            both = before[k] + mean[k] - moved * end[BASE, k] / b.dt
            mean[k] = end[STIFFNESS, k] * w[k] + 0.5 * end[VISCOSITY, k] * both
        for k in range(b.freedoms):
            r[k] = 0.0
            for j in range(b.freedoms):
                r[k] -= end[MATRIX + k, j] * mean[j]
        add_at_face(b, q, i, side, 1.0, r)

    @formula
    def advance_closure(b, end, state, m, i, side, moved):
        """Advance the closure of an end by the step just taken and its base's displacement (m)."""
        w, after = state[CLOSURE], state[MEAN]
        put_velocity(b, after, m, i)
        at_face(b, after, side)
        for k in range(b.freedoms):
            w[k] = end[DECAY, k] * w[k] + end[GAIN, k] * after[k] - moved * end[BASE, k]

    return add_at_face, add_reaction, advance_closure
