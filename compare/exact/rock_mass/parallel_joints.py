"""Scenes of plane P and SV waves at parallel joints at any angle (`plane.parallel_joints`).

Valid for any parallel linear joints, with dashpots or without, in undamped rock with sides through
which waves leave, and any number of plane waves that meet them after the start (`stack`).
"""

from functools import partial

from jointwave.compare.exact.rock_mass import stack_waves
from jointwave.compare.solvers.record import Rock, Solver, thin

SOLVER = Solver(
    name="parallel-joints",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=2,
    label="parallel joints, exact",
    line=thin("#a83200", 8, (9, 18)),
    applies=partial(stack_waves.holds, one=False),
    run=partial(stack_waves.solve, name="parallel-joints"),
    distances=stack_waves.DISTANCES,
)
