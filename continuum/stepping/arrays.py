"""Arguments of the kernel of explicit steps: constants, state, work vectors, and samples."""

from typing import NamedTuple

import numpy as np

from jointwave.continuum.stepping.memory import Memory
from jointwave.continuum.stepping.problem import Readings
from jointwave.continuum.stepping.product import Table
from jointwave.continuum.stepping.tractions import Points
from jointwave.joints.law import LawFlags
from jointwave.results.dataset import TERMS

#: Rows of the sums of a ledger, J: what was dissipated and what went in.
VISCOUS, FRICTION, BOUNDARY, WORK = range(4)


class StepFlags(NamedTuple):
    """Which effects a body has: constants of the compiled kernel.

    product : kind of the stiffness, `continuum.stepping.product`. law : None without joints.
    stressed : whether these carry anything at u = 0. damped : whether the rock has dashpots.
    relaxing : whether it has a quality factor. ledger : whether energies are recorded. sprung :
    whether springs are in front of dashpots of sides.
    """

    dim: int
    product: str
    law: LawFlags | None
    stressed: bool
    damped: bool
    relaxing: bool
    ledger: bool
    sprung: bool = False


class Jumps(NamedTuple):
    """The jump operator by pairs of nodes: first, uint32 array [points, 2], where the first freedom
    of each is in vectors, the others `Product.stride` further on; frame, float array
    [points, d, d]."""

    first: np.ndarray
    frame: np.ndarray


class Quiet(NamedTuple):
    """Nodes on dashpots: freedom, int array [k, d]; viscosity [k, d, d], N s/m; beta [k, d, d],
    dt / (2 M (1 + alpha dt / 2)) times it, and solve, the inverse of 1 + beta. stiffness (N/m) :
    of springs in front of dashpots, whose closure becomes decay times it + gain (s) times the
    velocity in a step: [k, d], [0, d] without (`joints.ends`)."""

    freedom: np.ndarray
    viscosity: np.ndarray
    beta: np.ndarray
    solve: np.ndarray
    stiffness: np.ndarray
    decay: np.ndarray
    gain: np.ndarray


class Constants(NamedTuple):
    """The constants of steps; what is absent is empty.

    dt : s. mass : float array [n], kg, of the freedoms that steps move, which are the first of
    all vectors. inverse : dt / (M (1 + alpha dt / 2)), s/kg; 0 of padding.
    keep : (1 - alpha dt / 2) / (1 + alpha dt / 2). alpha : of mass-proportional damping, 1/s.
    memory : of the rock. stiffness, damping : `product.Table`. jumps : B; points :
    `tractions.Points`. steady : float array [n], N. driven : int array [k], freedoms of forces with
    a history. fixed : int array [f], freedoms whose motion is given: direction [f] times what moves
    in a step. receivers : with a `Table` in place of each matrix, empty where it is absent.
    """

    dt: float
    mass: np.ndarray
    inverse: np.ndarray
    keep: float
    alpha: float
    memory: Memory
    stiffness: Table
    damping: Table
    jumps: Jumps
    points: Points
    steady: np.ndarray
    driven: np.ndarray
    quiet: Quiet
    fixed: np.ndarray
    direction: np.ndarray
    receivers: Readings


class State(NamedTuple):
    """The state.

    u : displacement, m. v, v_before : velocity half a step before u, and one and a half before,
    m/s. elongation : of mechanisms [l, n], m. history : of points, `tractions`. sums : of the
    ledger, J. closure : of springs in front of dashpots [k, d], m.
    """

    u: np.ndarray
    v: np.ndarray
    v_before: np.ndarray
    elongation: np.ndarray
    history: np.ndarray
    sums: np.ndarray
    closure: np.ndarray


class Work(NamedTuple):
    """Vectors that a step fills: force, rate, drag, and of rock with a quality factor strained, m,
    and rock, N [n]; of points [points * d]; [0] if absent. braking : of quiet nodes [k, d], N."""

    force: np.ndarray
    rate: np.ndarray
    drag: np.ndarray
    strained: np.ndarray
    rock: np.ndarray
    jump: np.ndarray
    moved: np.ndarray
    jump_rate: np.ndarray
    loads: np.ndarray
    drags: np.ndarray
    braking: np.ndarray


class Samples(NamedTuple):
    """What is recorded: velocity, displacement, stress, traction, jump [rows, samples]; energy
    [terms, samples], in the order of `results.dataset.TERMS`, no samples where it is not."""

    velocity: np.ndarray
    displacement: np.ndarray
    stress: np.ndarray
    traction: np.ndarray
    jump: np.ndarray
    energy: np.ndarray


def samples_for(readings: Readings, samples: int, energy: bool) -> Samples:
    """Return empty samples."""
    read = readings.motion, readings.motion, readings.stress, readings.traction, readings.jump
    shapes = [(one.shape[0], samples) for one in read]
    return Samples(*map(np.zeros, [*shapes, (len(TERMS), samples if energy else 0)]))
