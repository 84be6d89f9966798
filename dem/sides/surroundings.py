"""Surroundings of blocks in any dimension: forces, dashpots and moving bases on ends and sides."""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from jointwave.cases.sampling import Clock
from jointwave.dem.sides.boundaries import BoundaryPoints
from jointwave.dem.sides.loads import Pattern, Source
from jointwave.dem.sides.shaking import Base, Shaking
from jointwave.joints.ends import half_spring

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField


class EndSpring(NamedTuple):
    """Springs between a block and the dashpots of its end: the half of a joint.

    lever : makes the block's motion that of the end face [F, F]. stiffness, dashpot : of the face
    against its motion [F], N/m and N s/m, N m and N m s. eta : s.
    """

    block: int
    lever: np.ndarray
    stiffness: np.ndarray
    dashpot: np.ndarray
    eta: float

    def at(self, dt: float) -> np.ndarray:
        """Return the matrices of `model.Held` for steps of dt, s [3, F, F]."""
        half = half_spring(self.stiffness, self.eta, self.dashpot, dt)
        along = half.gain[:, None] * self.lever
        return np.stack([np.diag(half.decay), along, self.lever.T * half.stiffness])

    @property
    def critical(self) -> np.ndarray:
        """Stiffness at the critical step [F, F]."""
        half = half_spring(self.stiffness, self.eta, self.dashpot)
        return self.lever.T * half.critical_stiffness @ self.lever


class Surroundings(NamedTuple):
    """What acts on blocks from outside.

    points : where dashpots act, sides that waves pass among them; before a base that moves those
    of the first block. impedance : there [m, d, d], Pa s/m. borne : what bears the weight there,
    likewise, of 1 or 0. patterns : forces. opened : by which walls of openings hold their blocks
    before these are excavated; None without. bases : walls that move. springs : before dashpots.
    waves : of a field, the blocks of the rows and the clock, what the field does to them; None
    where no wave enters.
    """

    points: BoundaryPoints
    impedance: np.ndarray
    borne: np.ndarray
    patterns: list[Pattern]
    bases: list[Base]
    springs: tuple[EndSpring, ...] = ()
    opened: Pattern | None = None
    waves: "Callable[[IncidentField | None, np.ndarray, Clock], list[Source]] | None" = None

    @property
    def rows(self) -> np.ndarray:
        """The blocks that something acts on, ascending."""
        own = [self.points.block, *(one.block for one in self.patterns)]
        return np.unique(np.concatenate(own))


def before_base(push: np.ndarray, moving: Shaking) -> Source:
    """Return what the dashpots before a moving base push the first block with, by its mean velocity
    over both half steps; push : resultants over the base's velocity [d + d^2, d], N s/m.
    """

    def acting(steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        found = np.zeros((len(steps), len(rows), len(onto)))
        begin = moving(np.maximum(steps - 1, 0))[:, 0] * (steps > 0)[:, None]
        mean = (begin + moving(steps)[:, 0]) / 2
        found[:, rows == 0] = (mean @ (onto @ push).T)[:, None]
        return found

    return acting
