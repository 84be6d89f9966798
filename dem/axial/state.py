"""The state of a run; arrays of absent effects are None."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.axial.model import Effects
from jointwave.numerics.cache_lines import zeros


class State(NamedTuple):
    """Displacement u [N] at a whole step, velocity v [N] half a step before it, and history.

    force : of the contacts 0 .. N at the last step, N, compression positive.
    gap_rate : of each joint one and a half steps before, m/s; None without dashpots.
    opening : each joint's largest gap so far, m; None without softening.
    broke : the step at which each joint lost its strength, -1 before; None without softening.
    start, end : [closure (m), reaction at the last step (N)] of the ends; zero where free.

    The ledger, None without: the work (J) of every nonconservative force, up to the last
    step.
    work : [of the ends, of the load]. last_force : of start, end and load at the last step, N.
    viscous : against the damping of each block and of the joint behind it; None without damping.
    behind : of the damping of each block at the last step over the half step behind it; None
        without damping of blocks.
    dashpot_force : each joint's dashpot force at the last step, N; None without dashpots.
    """

    u: np.ndarray
    v: np.ndarray
    force: np.ndarray
    gap_rate: Any
    opening: Any
    broke: Any
    start: np.ndarray
    end: np.ndarray
    work: Any
    last_force: Any
    viscous: Any
    behind: Any
    dashpot_force: Any


def state_at_rest(effects: Effects, block_count: int, ledger: bool) -> State:
    """Return the state at rest, without arrays for absent effects."""
    damped, softens = effects.joints.dashpots, effects.joints.softening
    damps_blocks = effects.mass_damping or effects.local_damping

    def of_joints(present: bool) -> np.ndarray | None:
        return zeros(block_count - 1) if present else None

    def of_blocks(present: bool) -> np.ndarray | None:
        return zeros(block_count) if present else None

    return State(
        u=zeros(block_count),
        v=zeros(block_count),
        force=zeros(block_count + 1, 1),
        gap_rate=of_joints(damped),
        opening=of_joints(softens),
        broke=np.full(block_count - 1, -1) if softens else None,
        start=np.zeros(2),
        end=np.zeros(2),
        work=np.zeros(2) if ledger else None,
        last_force=np.zeros(3) if ledger else None,
        viscous=of_blocks(ledger and (damped or damps_blocks)),
        behind=of_blocks(ledger and damps_blocks),
        dashpot_force=of_joints(ledger and damped),
    )
