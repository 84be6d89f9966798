"""Scenes of plane P and SV waves at one joint at any angle (`plane.oblique_joint`).

Valid for one linear joint, with a dashpot or without, in undamped rock with sides through which
waves leave, and any number of plane waves that meet it after the start (`stack`).
"""

from functools import partial

from jointwave.compare.exact.rock_mass import stack_waves
from jointwave.compare.solvers.record import Rock, Solver, thin

SOLVER = Solver(
    name="oblique-joint",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=2,
    label="joint at an angle, exact",
    line=thin("#d55e00", 8, (4.5, 8.5)),
    applies=partial(stack_waves.holds, one=True),
    run=partial(stack_waves.solve, name="oblique-joint"),
    distances=stack_waves.DISTANCES,
)
