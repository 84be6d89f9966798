"""Reactions of the two ends of the row: springs and dashpots on the end block's outer face.

All six components act at the face's centre (three where blocks do not turn): the axial and the
shear force, and the moments that the same springs and dashpots give spread over the face. The
dashpots see the mean of the velocities before and after the step; with the face's velocity p,

    R = -(S w + C (p[n-1/2] + p[n+1/2]) / 2),   p[n+1/2] = p* + Y R,

p* is the velocity that all else would give and Y what a unit reaction adds to it in the step, so
R = -G (S w + C (p[n-1/2] + p*) / 2) with G = (1 + C Y / 2)^-1.
"""

from math import inf
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties
from jointwave.cases.material.contact_points import face_points
from jointwave.cases.schema.scene import Scene
from jointwave.dem.spatial.model import Block
from jointwave.joints.ends import half_spring

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
    return np.array(face_points(scene.pillar.side, joints.contact_points, joints.point_rule))


def face_of(points: np.ndarray) -> Face:
    """Return the shares of a face's springs in each freedom, from its contact points."""
    x, area = points[0], points[2].sum()
    across = (points[2] * x**2).sum()
    normal, shear = [0, area, 0, across, 0, across], [area, 0, area, 0, 2 * across, 0]
    return Face(np.array(normal), np.array(shear))


class Springs(NamedTuple):
    """The springs of an end face (N/m, N m) and the dashpots (N s/m, N m s) of the rock beyond it,
    each [freedoms], and the springs' time constant eta, s."""

    stiffness: np.ndarray
    dashpot: np.ndarray
    time_constant: float


def end_springs(kind: str, p: Properties, face: Face, size: int) -> Springs:
    """Return the springs, 2 K' or those of half a block of rock to a wall, and the dashpots Z of an
    end face of this kind, spread over its freedoms."""
    springs = 2 * p.regular_stiffness, 2 * p.regular_shear_stiffness
    if kind == "fixed":
        springs = p.wall_stiffness, p.wall_shear_stiffness
    stiffness = face.spread(*springs, size)
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
