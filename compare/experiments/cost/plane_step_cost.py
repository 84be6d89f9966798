"""The cost of a step of one rigid block of a rock mass in the plane."""

from __future__ import annotations

from math import isqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases.validate import validated
from compare.experiments.cost.step_cost import BLOCK_STEPS_IN_SPACE, Stretch, samples_of
from compare.solvers.incident import incident

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

ELASTIC = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
STEP = {"shape": "step", "amplitude": 1e5}
#: Every effect at once, but for periodic sides: the line against which a scene's cost is held.
EVERYTHING: dict[str, Any] = {
    "boundaries": {"left": "quiet", "right": "quiet", "bottom": "fixed"},
    "waves": [STEP | {"kind": "P", "direction": [1.0, 0.0]}],
    "loads": [
        STEP | {"kind": "pressure", "side": "top"},
        STEP
        | {"kind": "base", "side": "bottom", "direction": [1.0, 0.0]}
        | {"quantity": "velocity", "amplitude": 1e-3},
    ],
    "damping": {"mass_proportional": 1.0, "local": 0.1},
    "gravity": {"static": False},
    "prestress": {"xx": 1e5, "yy": 1e5},
    "record": {"points": [[0.5, 0.5]]},
}
FRICTION = {"damping_ratio": 0.02, "friction_angle": 30.0, "cohesion": 1e6}
#: The joints along y and along x of that.
FAILING = (
    ELASTIC | FRICTION | {"residual_cohesion": 0.0, "tension": False},
    ELASTIC | FRICTION | {"tensile_strength": 1e6, "fracture_energy": 1e3},
)


def lattice(blocks: int, along_y: dict, along_x: dict, tables: dict[str, Any]) -> RockMass:
    """Return a square lattice of about so many blocks of 1 m, free where tables say nothing else.

    along_y, along_x : the law of the joints that run so. tables : of the scene, in place of ours.
    """
    side = max(2, isqrt(blocks))
    joints = {"spacing": 1.0, "through": [0.0, 0.0]}
    sets = [
        {"name": "x", "dip": 90.0} | joints | along_y,
        {"name": "y", "dip": 0.0} | joints | along_x,
    ]
    ours = {
        "title": "a square lattice",
        "domain": {"size": [float(side), float(side)]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": sets,
        "time": {"duration": 0.01},
        "record": {"points": [[0.5, 0.5]], "energy": False},
    }
    return validated(ours | tables, Path("lattice.toml"), frozenset())


def everything_in_plane(scene: RockMass, most: int) -> RockMass:
    """Return a lattice with every effect, of as many blocks as a scene has, but of `most`."""
    from dem.blocks.build import rigid_blocks

    blocks = min(rigid_blocks(scene).partition.count, most)
    return lattice(blocks, *FAILING, EVERYTHING)


def stretch_in_plane(scene: RockMass, threads: int = 1) -> Stretch:
    """Return a function that takes some samples of a scene from rest, with what acts on it, and its
    number of block-steps."""
    from dem.blocks.leapfrog import samples_for
    from dem.blocks.model import state_at_rest
    from dem.blocks.simulate import step
    from dem.blocks.system import prepared

    system = prepared(scene, incident(scene))._replace(threads=threads)
    blocks = system.blocks.partition.count
    count = samples_of(system.time, blocks, BLOCK_STEPS_IN_SPACE)
    state, samples = state_at_rest(system.model), samples_for(system.model, count)
    steps = count * system.time.stride
    return lambda: step(system, state, samples, 0, steps), steps * blocks
