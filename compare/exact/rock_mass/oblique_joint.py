"""Scenes of plane P and SV waves at one joint at any angle (`plane.oblique_joint`).

Holds for one linear joint, with a dashpot or without, in undamped rock whose sides waves leave
through, and any number of plane waves that meet it after the start (`stack`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from compare.exact.rock_mass import stack_waves
from compare.solvers.record import JOINTED, Answer, Rock, Solver, Words, thin

if TYPE_CHECKING:
    import xarray as xr

    from cases.schema.rock_mass import RockMass


def applies(scene: RockMass) -> Answer:
    """Return whether a scene is one of plane waves at one joint."""
    return stack_waves.holds(scene, one=True)


def solve(scene: RockMass) -> xr.Dataset:
    """Return what the receivers of a scene record of its waves at the joint."""
    return stack_waves.solve(scene, SOLVER.name)


SOLVER = Solver(
    name="oblique-joint",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=2,
    words=Words(JOINTED, "joint at an angle, exact", "斜节理（精确解）"),
    line=thin("#d55e00", 8, (4.5, 8.5), (6, 2.4, 1.2, 2.4)),
    applies=applies,
    run=solve,
    distances=stack_waves.DISTANCES,
)
