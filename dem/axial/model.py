"""The constants of a chain."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.sampling import Interpolation
from jointwave.dem.axial.ends import End
from jointwave.joints.law import LawFlags


class Receivers(NamedTuple):
    """Receivers: sections between contacts 0 .. N, points between block centres."""

    sections: Interpolation
    points: Interpolation


class Effects(NamedTuple):
    """The effects of a chain: compile-time constants of its kernel.

    joints : parts of their law. masses : whether blocks differ in mass. start, end : whether these
    have a spring or a dashpot. base : whether the start moves. ledger : whether energies are
    recorded.
    """

    joints: LawFlags
    masses: bool = False
    start: bool = False
    end: bool = False
    base: bool = False
    mass_damping: bool = False
    local_damping: bool = False
    gravity: bool = False
    ledger: bool = False


class Chain(NamedTuple):
    """The constants of one step; those of absent effects change nothing.

    dt : s; mass : of a block, kg, of the lightest where they differ; area : m2.
    impulse_to_speed : dt / m, s/kg, less by mass-proportional damping.
    keep : factor of a velocity per step under mass-proportional damping.
    local : Cundall's damping. weight : m g along y, N.
    start_force, end_force : of a prestress on the start and the end, N.
    """

    dt: float
    mass: float
    area: float
    impulse_to_speed: float
    keep: float = 1.0
    local: float = 0.0
    weight: float = 0.0
    start_force: float = 0.0
    end_force: float = 0.0
    start: End = End()
    end: End = End()


class Model(NamedTuple):
    """The constants of a run.

    laws : of the joints, per unit area, as `joints.law.table_of` returns them.
    blocks : float array [N, 2], mass (kg) and `impulse_to_speed` (s/kg) of each block; None where
        all are alike.
    load : float array, N, mean of the load over each step, cut after the last that acts.
    base : float array, m, the displacement increment of a shaken base in each step, against y
        (outward), the first the one before the run, cut after the last that moves.
    """

    effects: Effects
    chain: Chain
    laws: np.ndarray
    load: np.ndarray
    base: np.ndarray
    receivers: Receivers
    blocks: np.ndarray | None = None
