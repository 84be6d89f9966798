"""The chain of rigid blocks, exact in time: the equations of the rigid-block engine.

The axial motion of `system`, solved by matrix exponentials (`linear`). Without
dashpots and with free ends its modes are omega_n = 2 sqrt(k/m) sin(n pi / 2N) of shape
cos(n pi (j - 1/2) / N), j = 1..N; Kelvin-Voigt dashpots are proportional and damp each mode at the
rate eta omega_n^2 / 2 (Brillouin, Wave Propagation in Periodic Structures, 1946).

Its only error is round-off, bounded by the difference from a perturbed twin solution.

Valid for any load or shaken base, soft layers, segments, dashpots, mass-proportional damping, ends,
gravity along the axis and prestress; every joint carries tension.
"""

import xarray as xr

from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.plane import STRETCHING
from jointwave.compare.exact.blocks.system import response
from jointwave.compare.exact.conditions import DAMPED, LAYERS, holds
from jointwave.compare.exact.linear import errors
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

MOST_BLOCKS = 2000
HELD = (
    "reversed load",
    "segments",
    "scatter",
    "gravity",
    "prestress",
    "mass damping",
    "fixed start",
    *DAMPED,
    *LAYERS,
)


def applies(scene: Scene) -> Answer:
    """Return whether the scene's chain of rigid blocks is linear and not too long."""
    many = f"more than {MOST_BLOCKS:,} blocks: the matrix exponential is dense"
    return holds(scene, HELD, (scene.block_count > MOST_BLOCKS, many))


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's rigid-block chain."""
    forces, velocity, displacement = (x[:, :, 0] for x in response(scene, STRETCHING))
    found, twin = zip(forces / scene.pillar.area, velocity, displacement, strict=True)
    bounds = errors(found, twin)
    return dataset(scene, SOLVER.name, sample_times(scene), *found, errors=bounds)


SOLVER = Solver(
    name="lattice",
    rock=Rock.RIGID_BLOCKS,
    label="rigid blocks, exact",
    line=thin("#00349a", 9, (0, 4)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks"}},
)
