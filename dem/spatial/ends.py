"""What holds the two ends of the row: springs and dashpots on the end block's outer face.

All six components act at the face's centre (three where blocks do not turn): the axial and the
shear force, and the moments that the same springs and dashpots give spread over the face. The
dashpots see the mean of the velocities before and after the step; with the face's velocity p,

    R = -(S w + C (p[n-1/2] + p[n+1/2]) / 2),   p[n+1/2] = p* + Y R,

p* is the velocity that all else would give and Y what a unit reaction adds to it in the step, so
R = -G (S w + C (p[n-1/2] + p*) / 2) with G = (1 + C Y / 2)^-1.
"""

from math import inf
from typing import Any, NamedTuple

import numpy as np

from cases.material.calibrate import Properties
from dem.spatial.motion import (
    Motion,
)
from dem.spatial.section import Face
from joints.ends import half_spring


class End(NamedTuple):
    """One end; arrays [freedoms] in the order x, y, z, about x, about y, about z.

    side : +1 at the start, -1 at the end. arm : from the centroid to the face, m, signed; None
    where blocks do not turn. matrix : G, [freedoms, freedoms].
    stiffness, viscosity : S and C. decay, gain : of w <- decay w + gain p[n+1/2], gain in s.
    steady : what acts on the face all the time, N and N m: a prestress.
    base : what a unit of base motion takes from the closure.
    """

    side: float
    arm: Any
    matrix: np.ndarray
    stiffness: np.ndarray
    viscosity: np.ndarray
    decay: np.ndarray
    gain: np.ndarray
    steady: np.ndarray
    base: np.ndarray


class EndState(NamedTuple):
    """What changes at an end, each [freedoms].

    closure : w, m and rad. reaction : R on the block, N and N m. velocity : of the face before
    the step, m/s and rad/s. mean : room for one step.
    """

    closure: np.ndarray
    reaction: np.ndarray
    velocity: np.ndarray
    mean: np.ndarray


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


def build_end(
    kind: str, side: float, springs: Springs, motion: Motion, steady: np.ndarray, base: np.ndarray
) -> End | None:
    """Return the end of this kind; None where it is free and carries nothing.

    side : +1 at the start, -1 at the end. steady : [freedoms], N and N m. base : [freedoms], what
    a unit of base motion takes from the closure.
    """
    if kind == "free" and not steady.any():
        return None
    parts = np.array(
        [
            _component(kind, k, springs.time_constant, z, motion.dt)
            for k, z in zip(*springs[:2], strict=True)
        ]
    )
    stiffness, viscosity, decay, gain = np.ascontiguousarray(parts.T)
    arm = None if motion.arm is None else side * motion.arm
    matrix = np.eye(len(steady)) + viscosity[:, None] * mobility(motion, arm) / 2
    return End(side, arm, np.linalg.inv(matrix), stiffness, viscosity, decay, gain, steady, base)


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


def mobility(motion: Motion, arm: float | None) -> np.ndarray:
    """Return Y [freedoms, freedoms]: what a unit reaction adds to the face's velocity in a step."""
    turns = () if motion.twist is None else motion.twist
    response = np.diag([motion.push] * 3 + list(turns))
    lever = lever_matrix(arm, len(response))
    return lever @ response @ lever.T


def end_state(end: End | None) -> EndState | None:
    """Return the state of an end at rest."""
    return None if end is None else EndState(*np.zeros((4, len(end.steady))))
