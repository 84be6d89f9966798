"""Rigid blocks in the plane and in space: rates against a row of blocks, by size and by threads.

The scenes are square and cubic lattices of 1 m blocks with orthogonal joint sets, all in motion.
"""

from statistics import median

import numpy as np
from kernels import SLIDES
from rows import ELASTIC, changed, lattice, stretch
from timing import Timed, in_turns, side_by_side

from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import Model, samples_for, state_at_rest
from jointwave.dem.prepare import prepared

COULOMB = ELASTIC | {"friction_angle": 30.0, "cohesion": 1e5}
PRESSURE = {"kind": "pressure", "side": "left", "shape": "step", "amplitude": 1e5}
SIZES = {2: (1024, 10_000, 102_400, 1_000_000), 3: (1000, 10_648, 103_823)}
BLOCK_STEPS, LEAST = 5_000_000, 48  # block-steps and steps of one call
POINTS = 4  # contact points per block: two contacts of two in the plane, one of 2 x 2 in the row


def model_of(blocks: int, law: dict, dim: int = 2) -> Model:
    """Return the constants of such a lattice."""
    return prepared(lattice(blocks, law, {"loads": [PRESSURE]}, dim)).model


def moving(model: Model, threads: int = 1) -> Timed:
    """Return a function that steps a lattice in motion, and its number of block-steps."""
    state, samples = state_at_rest(model), samples_for(model, 0)
    state.v[:] = 1e-3 * np.random.default_rng(1).uniform(-1.0, 1.0, state.v.shape)
    count = len(model.blocks.inertia)
    steps = max(LEAST, BLOCK_STEPS // (count * model.form.dim))

    def take() -> None:
        march(model, state, samples, 2 * steps, (1, 1 + steps), threads=threads)

    return take, steps * count


def main() -> None:
    """Print rates per contact point over those of the row in space, the cost of a block-step by
    number of blocks, and the gain of two threads."""
    print("blocks in the plane, 2 points a contact, Coulomb slip, over the row in space,")
    print("2 x 2 points, both per contact point: point-steps/s")
    for blocks in (1024, 102_400):
        plane, block_steps = moving(model_of(blocks, COULOMB))
        row, of_row = stretch(changed(SLIDES, blocks))
        one, other = (plane, POINTS * block_steps), (row, POINTS * of_row)
        side_by_side(f"{blocks:,} blocks, one thread", one, other)
    for dim, sizes in SIZES.items():
        where = {2: "in the plane", 3: "in space"}[dim]
        for name, law in {"elastic joints": ELASTIC, "Coulomb slip": COULOMB}.items():
            print(f"blocks {where}, {name}, ns a block-step, by size", flush=True)
            models = [model_of(blocks, law, dim) for blocks in sizes]
            rates = zip(*in_turns(*map(moving, models)), strict=True)
            for blocks, found in zip(sizes, rates, strict=True):
                print(f"  {blocks:>9,} blocks: {1e9 / median(found):6.1f}", flush=True)
        print(f"blocks {where}, Coulomb slip, two threads over one, block-steps/s", flush=True)
        for blocks, model in zip(sizes, models, strict=True):
            side_by_side(f"{blocks:,} blocks", moving(model, 2), moving(model))
