"""Rows and lattices of rigid blocks of any size, and functions that take their steps alone."""

from pathlib import Path
from typing import Any

from timing import Timed

from jointwave import cases
from jointwave.cases.effects import is_spatial
from jointwave.cases.sampling import Clock
from jointwave.cases.scene_type import pillar_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.validate import validated
from jointwave.compare.scenes import find
from jointwave.dem.axial.samples import buffers
from jointwave.dem.axial.simulate import scheme_of
from jointwave.dem.spatial.build import buffers_for, samples_for, state_at_rest
from jointwave.dem.spatial.march import make_stepper
from jointwave.dem.spatial.simulate import prepare

BLOCK_STEPS = 5_000_000  # of one call, at most, unless it has a single sample
BLOCK_STEPS_IN_SPACE = 50_000  # each takes ten times as long
ELASTIC = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}


def changed(changes: dict, blocks: int = 1000) -> Scene:
    """Return the paper's pillar with this number of blocks and some dotted keys changed."""
    pillar = find("guo-li-2002/fig-03")
    return pillar_of(cases.load_variant(pillar, "", {"pillar.length": 0.5 * blocks, **changes}))


def lattice(blocks: int, law: dict, tables: dict[str, Any], dim: int = 2) -> RockMass:
    """Return a square or cubic lattice of about this number of 1 m blocks; tables : more of it."""
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
    """Return a function that takes some samples of a pillar, and its number of block-steps."""
    return _in_space(scene, threads) if is_spatial(scene) else _along_axis(scene)


def _along_axis(scene: Scene) -> Timed:
    scheme = scheme_of(scene)
    model, state, time, _ = scheme.build(scene)
    count = _samples(time, state.u.size, BLOCK_STEPS)
    samples = buffers(model, state, count)
    march = scheme.make_stepper(scene, time)(model, state, samples, time.stride, None)
    return lambda: march(0, count), count * time.stride * state.u.size


def _in_space(scene: Scene, threads: int) -> Timed:
    p, model, time, _ = prepare(scene)
    count = _samples(time, p.block_count, BLOCK_STEPS_IN_SPACE)
    state, samples, steps = state_at_rest(model), samples_for(model, count), count * time.stride
    march = make_stepper(model, state, buffers_for(model, threads, None), samples)
    march(0, 0)
    return lambda: march(0, steps), steps * p.block_count


def _samples(time: Clock, blocks: int, most: int) -> int:
    return min(time.samples, max(64, most // blocks) // time.stride + 1)
