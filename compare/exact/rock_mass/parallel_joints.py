"""Scenes of plane P and SV waves at parallel joints at any angle (`plane.parallel_joints`).

Holds for any parallel linear joints, with dashpots or without, in undamped rock whose sides waves
leave through, and any number of plane waves that meet them after the start (`stack`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from compare.exact.rock_mass import stack_waves
from compare.solvers.record import JOINTED, Answer, Rock, Solver, Words, thin

if TYPE_CHECKING:
    import xarray as xr

    from cases.schema.rock_mass import RockMass


def applies(scene: RockMass) -> Answer:
    """Return whether a scene is one of plane waves at several joints."""
    return stack_waves.holds(scene, one=False)


def solve(scene: RockMass) -> xr.Dataset:
    """Return what the receivers of a scene record of its waves at the joints."""
    return stack_waves.solve(scene, SOLVER.name)


SOLVER = Solver(
    name="parallel-joints",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=2,
    words=Words(JOINTED, "parallel joints, exact", "平行节理（精确解）"),
    line=thin("#a83200", 8, (9, 18), (9, 2.4, 1.2, 2.4)),
    applies=applies,
    run=solve,
    distances=stack_waves.DISTANCES,
)
