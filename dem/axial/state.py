"""What changes in a run; absent parts are None."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dem.axial.ends import end_state
from numerics.aligned import zeros

if TYPE_CHECKING:
    from dem.axial.model import Chain

INNER = 1  # the first block, and joint, of the loop over all but the end blocks


class Ledger(NamedTuple):
    """Running sums of the work of every force that no potential gives, J.

    sums : boundary and work, up to the last step.
    forces : start, end and load force of the last step, N.
    viscous : work against what damps each block and the joint behind it, up to the last step; None
        without damping. A sum over all blocks would make each wait for the one before.
    behind : what the damping of each block at the last step still does behind it; None without.
    dashpots : each joint's dashpot force at the last step, N; None without dashpots.
    """

    sums: np.ndarray
    forces: np.ndarray
    viscous: Any
    behind: Any
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


def state_at_rest(chain: Chain, block_count: int, keep_ledger: bool) -> State:
    """Return the state at rest, with no array for anything that the chain does not have."""
    damped = chain.law.normal_viscosity is not None
    softens = chain.law.tensile_strength is not None
    return State(
        u=zeros(block_count, INNER),
        v=zeros(block_count, INNER),
        gap_rate=zeros(block_count - 1, INNER) if damped else None,
        opening=zeros(block_count - 1, INNER) if softens else None,
        broke=np.full(block_count - 1, -1) if softens else None,
        start=end_state(chain.start),
        end=end_state(chain.end),
        ledger=_ledger(chain, block_count, damped) if keep_ledger else None,
    )


def _ledger(chain: Chain, block_count: int, dashpots: bool) -> Ledger:
    blocks = chain.keep is not None or chain.local is not None
    return Ledger(
        sums=np.zeros(2),
        forces=np.zeros(3),
        viscous=zeros(block_count, INNER) if blocks or dashpots else None,
        behind=zeros(block_count, INNER) if blocks else None,
        dashpots=zeros(block_count - 1, INNER) if dashpots else None,
    )
