"""Rows and lattices of rigid blocks of any number, and functions that step rows."""

from pathlib import Path
from typing import Any

from timing import Timed

from jointwave import cases
from jointwave.cases.scene_type import pillar_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.validate import validated
from jointwave.compare.engines import solver
from jointwave.compare.scenes import find
from jointwave.dem.kernel.model import samples_for, state_at_rest
from jointwave.dem.prepare import prepared
from jointwave.dem.run import stepper

BLOCK_STEPS = 20_000_000  # of one run, about
LEAST = 64  # steps of one run
ELASTIC = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}


def changed(changes: dict, blocks: int = 1000) -> Scene:
    """Return the paper's pillar with a number of blocks and some dotted keys changed."""
    pillar = find("guo-li-2002/fig-03")
    return pillar_of(cases.load_variant(pillar, "", {"pillar.length": 0.5 * blocks, **changes}))


def lattice(blocks: int, law: dict, tables: dict[str, Any], dim: int = 2) -> RockMass:
    """Return a square or cubic lattice of about `blocks` 1 m blocks; tables : more of the scene."""
    side = max(2, round(blocks ** (1 / dim)))
    joints = {"spacing": 1.0, "through": [0.0] * dim} | law
    attitudes = [{"dip": 90.0}, {"dip": 0.0}]
    if dim == 3:
        attitudes = [{"dip": 0.0}, *({"dip": 90.0, "dip_direction": way} for way in (0.0, 90.0))]
    ours = {
        "title": "a lattice",
        "domain": {"size": [float(side)] * dim},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": [{"name": f"set {k}"} | one | joints for k, one in enumerate(attitudes)],
        "time": {"duration": 0.01},
        "record": {"points": [[0.5] * dim], "energy": False},
    }
    return validated(ours | tables, Path("lattice.toml"), frozenset())


def stretch(scene: Scene, threads: int = 1) -> Timed:
    """Return a function that steps a pillar under its load, and its number of block-steps."""
    dt = solver("dem").prepare(scene).dt
    samples = max(LEAST, BLOCK_STEPS // scene.block_count) * dt // scene.interval + 1
    tables = {
        "time": {"duration": samples * scene.interval},
        "numerics": {"dem": scene.numerics.dem.model_copy(update={"threads": threads})},
    }
    brief = scene.model_copy(
        update={key: getattr(scene, key).model_copy(update=one) for key, one in tables.items()}
    )
    system = prepared(brief)
    state, steps = state_at_rest(system.model), system.time.stride * system.time.samples
    step = stepper(system, state, samples_for(system.model, system.time.samples))
    return lambda: step(0, steps), steps * scene.block_count
