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
    """Springs, half of a joint, between a block and the dashpots of its end.

    lever : matrix from the block's motion to that of the end face [F, F]. stiffness, dashpot : of
    the face [F], N/m and N s/m, N m and N m s. eta : s.
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
    """Forces, dashpots and moving bases on the boundary of blocks.

    points : of dashpots, those at a moving base included. impedance : at the points [m, d, d],
    Pa s/m. borne : stiffness of the points while the weight comes to rest [m, d, d], Pa/m, 0 where
    they do not bear it. patterns : forces. bases : moving walls. springs : between blocks and
    dashpots. opened : forces of the walls of openings before excavation; None without. waves :
    function of (field, held blocks, clock) that returns the forces of incident waves; None without
    waves.
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
        """The held blocks, ascending."""
        own = [self.points.block, *(one.block for one in self.patterns)]
        return np.unique(np.concatenate(own))


def before_base(push: np.ndarray, moving: Shaking) -> Source:
    """Return the forces on the first block of dashpots driven by a moving base, at the base's mean
    velocity over both half steps; push : resultants per velocity [d + d^2, d], N s/m."""

    def acting(steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        found = np.zeros((len(steps), len(rows), len(onto)))
        begin = moving(np.maximum(steps - 1, 0))[:, 0] * (steps > 0)[:, None]
        mean = (begin + moving(steps)[:, 0]) / 2
        found[:, rows == 0] = (mean @ (onto @ push).T)[:, None]
        return found

    return acting
