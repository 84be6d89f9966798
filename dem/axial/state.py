"""What changes in a run; absent parts are None."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem.axial.ends import end_state

if TYPE_CHECKING:
    from dem.axial.model import Chain

REGISTER = 8  # numbers in the widest vector register, which is as long as a cache line


class Ledger(NamedTuple):
    """Running sums of the work of every force that no potential gives.

    sums : viscous, boundary, work, up to the last step, and the viscous work that the damping of
        the blocks at that step still does behind it, J.
    forces : start, end and load force of the last step, N.
    dashpots : each joint's dashpot force at the last step, N; None without dashpots.
    """

    sums: np.ndarray
    forces: np.ndarray
    dashpots: Any


class State(NamedTuple):
    """What changes: displacement u at the step, velocity v half a step before it.

    gap_rate : each joint's one and a half steps before, m/s; None without dashpots.
    opening : each joint's largest gap so far, m; None without softening.
    broke : the step at which each joint lost its strength, -1 before; None without softening.
    start, end : [closure, reaction] of the ends, None where free. ledger : None when not kept.
    """

    u: np.ndarray
    v: np.ndarray
    gap_rate: Any
    opening: Any
    broke: Any
    start: Any
    end: Any
    ledger: Any


def _row(count: int) -> np.ndarray:
    """Return zeros whose second starts a vector register: there the loop over inner blocks starts,
    and no load or store of it straddles two cache lines."""
    room = np.zeros(count + REGISTER)
    past = room.ctypes.data // room.itemsize + 1
    first = -past % REGISTER
    return room[first : first + count]


def state_at_rest(chain: Chain, block_count: int, keep_ledger: bool) -> State:
    """Return the state at rest, with no array for anything that the chain does not have."""
    damped = chain.law.normal_viscosity is not None
    softens = chain.law.tensile_strength is not None
    ledger = None
    if keep_ledger:
        dashpots = _row(block_count - 1) if damped else None
        ledger = Ledger(np.zeros(4), np.zeros(3), dashpots)
    return State(
        u=_row(block_count),
        v=_row(block_count),
        gap_rate=_row(block_count - 1) if damped else None,
        opening=_row(block_count - 1) if softens else None,
        broke=np.full(block_count - 1, -1) if softens else None,
        start=end_state(chain.start),
        end=end_state(chain.end),
        ledger=ledger,
    )
