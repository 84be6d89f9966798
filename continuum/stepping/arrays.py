"""Arguments of the kernel of explicit steps: constants, state, work vectors, and samples."""

from typing import NamedTuple

import numpy as np

from jointwave.continuum.stepping.memory import Memory
from jointwave.continuum.stepping.problem import Readings
from jointwave.continuum.stepping.product import Table
from jointwave.continuum.stepping.tractions import Points
from jointwave.joints.law import LawFlags
from jointwave.results.dataset import TERMS

#: Rows of the sums of a ledger, J: dissipated energies, and the work of external forces.
VISCOUS, FRICTION, BOUNDARY, WORK = range(4)


class StepFlags(NamedTuple):
    """The effects of a body: constants of the compiled kernel.

    product : kind of the stiffness, `continuum.stepping.product`. law : None without joints.
    stressed : whether joints carry tractions at u = 0. damped : whether the rock has dashpots.
    relaxing : whether it has a quality factor. ledger : whether energies are recorded. sprung :
    whether springs are in front of boundary dashpots.
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
    """The jump operator by pairs of nodes: first, uint32 [points, 2], place of each node's first
    freedom in vectors, with the others at intervals of `Product.stride`; frame [points, d, d]."""

    first: np.ndarray
    frame: np.ndarray


class Quiet(NamedTuple):
    """Nodes on dashpots.

    freedom : [k, d]. viscosity : [k, d, d], N s/m. beta : dt / (2 M (1 + alpha dt / 2)) times the
    viscosity. solve : inverse of 1 + beta. stiffness : N/m, of springs in front of dashpots; a step
    changes their closure to decay times the closure + gain (s) times the velocity: [k, d], [0, d]
    without springs (`joints.ends`).
    """

    freedom: np.ndarray
    viscosity: np.ndarray
    beta: np.ndarray
    solve: np.ndarray
    stiffness: np.ndarray
    decay: np.ndarray
    gain: np.ndarray


class Constants(NamedTuple):
    """The constants of steps; absent ones are empty.

    dt : s. mass : of the stepped freedoms, the first of all vectors [n], kg. inverse :
    dt / (M (1 + alpha dt / 2)), s/kg, 0 for padding. keep : (1 - alpha dt / 2) / (1 + alpha dt /
    2). alpha : of mass-proportional damping, 1/s. memory : of the rock. stiffness, damping :
    `product.Table`. jumps : B. points : `tractions.Points`. steady : constant forces [n], N.
    driven : freedoms of forces with a history [k]. fixed : freedoms with prescribed motion [f],
    direction [f] times the move of each step. receivers : with a `Table` for each matrix.
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

    u : displacement, m. v, v_before : velocity half a step and one and a half steps before u, m/s.
    elongation : of mechanisms [l, n], m. history : of points, see `tractions`. sums : of the
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
    """Work vectors of a step, [0] if absent: force to rock [n], the last two with a quality factor
    only; jump to drags [points * d]; braking, of quiet nodes [k, d], N."""

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
    """Recorded samples: velocity, displacement, stress, traction, jump [rows, samples]; energy in
    the order of `results.dataset.TERMS` [terms, samples], [terms, 0] without a ledger."""

    velocity: np.ndarray
    displacement: np.ndarray
    stress: np.ndarray
    traction: np.ndarray
    jump: np.ndarray
    energy: np.ndarray


def samples_for(readings: Readings, samples: int, energy: bool) -> Samples:
    """Return arrays of zeros for `samples` samples."""
    read = readings.motion, readings.motion, readings.stress, readings.traction, readings.jump
    shapes = [(one.shape[0], samples) for one in read]
    return Samples(*map(np.zeros, [*shapes, (len(TERMS), samples if energy else 0)]))
