"""The row of rigid blocks in space, exact in time: the equations of the rigid-block engine.

Stretching, torsion and the two bendings (`plane`), each solved by matrix exponentials (`linear`).

Valid for loads of any direction, eccentricity or couple, shaken bases, soft layers, dashpots,
mass-proportional damping, any ends, gravity and prestress; no joint opens, slips or softens.
"""

import numpy as np
import xarray as xr

from jointwave.cases.effects import is_spatial
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.lattice import HELD
from jointwave.compare.exact.blocks.plane import PLANES
from jointwave.compare.exact.blocks.system import response
from jointwave.compare.exact.conditions import holds
from jointwave.compare.exact.linear import bound
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

MOST_BLOCKS = 500


def applies(scene: Scene) -> Answer:
    """Return whether the scene's row of blocks is spatial, linear and not too long."""
    p = calibrate(scene)
    if not is_spatial(scene):
        return Answer("the motion is axial: see lattice")
    many = f"more than {MOST_BLOCKS:,} blocks: the matrix exponential is dense"
    return holds(
        scene,
        ("spatial motion", *HELD),
        (p.friction is not None or p.cohesion is not None, "a joint can slip"),
        (scene.motion.rotation == "finite", "rotations are finite"),
        (scene.pillar.block_count > MOST_BLOCKS, many),
    )


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, shear, velocity, displacement and rotation of the scene's row of blocks."""
    times, record = sample_times(scene), scene.record
    forces = np.zeros((2, len(record.stress), 6, len(times)))
    rate, motion = np.zeros((2, 2, len(record.velocity), 6, len(times)))
    for freedoms in PLANES[scene.motion.rotation]:
        for field, part in zip((forces, rate, motion), response(scene, freedoms), strict=True):
            field[:, :, list(freedoms)] = part
    waves = {
        "stress": forces[:, :, 1] / scene.pillar.area,
        "shear": forces[:, :, [0, 2]] / scene.pillar.area,
        "velocity": rate[:, :, :3],
        "displacement": motion[:, :, :3],
        "rotation": motion[:, :, 3:],
    }
    errors = {name: bound(*pair) for name, pair in waves.items()}
    stress, _ = waves.pop("stress")
    fields = {name: x[0].swapaxes(-1, -2) for name, x in waves.items()}
    return dataset(scene, SOLVER.name, times, stress, **fields, errors=errors)


SOLVER = Solver(
    name="spatial-lattice",
    rock=Rock.RIGID_BLOCKS,
    dimension=3,
    label="blocks in space, exact",
    line=thin("#00349a", 9, (0, 9)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks in space"}},
)
