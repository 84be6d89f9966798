"""Rates of the kernels of rows of blocks over those of plain loops with the same updates."""

import bare
import numpy as np
from rows import changed, stretch
from timing import Timed, side_by_side

from jointwave.cases.material.calibrate import calibrate

SLIDES = {
    "load.direction": [0.6, 0.8, 0.0],
    "load.at": [0.1, 0.05],
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e5,
    "record.energy": False,
}


def bare_axial(scene, blocks: int) -> Timed:
    """Return the plain loop of a damped row, for timing."""
    p = calibrate(scene)
    k = p.regular_stiffness * p.area
    steps = max(1, 5_000_000 // blocks)
    u, v, rates = np.zeros(blocks), np.zeros(blocks), np.zeros(blocks - 1)
    numbers = (1e-5, 1e-5 / p.block_mass, k, k * p.time_constant, 1e3)
    return lambda: bare.axial(u, v, rates, steps, *numbers), steps * blocks


def bare_spatial(scene, blocks: int) -> Timed:
    """Return the plain loop of a row with slip, for timing."""
    p = calibrate(scene)
    tiles, steps, dt = blocks // bare.LANES, max(1, 2_000_000 // blocks), 1e-5
    motion, slides = np.zeros((tiles, 12 * bare.ROW)), np.zeros((tiles, 8 * bare.LANES))
    motion[:, 7 * bare.ROW :] = 1e-3 * np.sin(np.arange(5 * bare.ROW))  # everything moves
    point = p.area / 4
    numbers = (
        dt,
        p.regular_stiffness * point,
        p.regular_shear_stiffness * point,
        p.side / 4,
        np.tan(np.pi / 6),
        1e5 * point,
        p.spacing / 2,
        dt / p.block_mass,
        dt / p.inertia_across,
        dt / p.inertia_along,
    )
    forces = np.zeros(6 * bare.ROW)
    return lambda: bare.spatial(motion, slides, forces, steps, *numbers), steps * blocks


def main() -> None:
    """Print all ratios."""
    print("axial kernel with dashpots and recording, over a bare fused loop, block-steps/s")
    for blocks in (100, 1000, 10_000, 100_000):
        scene = changed({"joints.damping_ratio": 0.02, "record.energy": False}, blocks)
        side_by_side(f"{blocks:,} blocks", stretch(scene), bare_axial(scene, blocks))
    print("spatial kernel, 2 x 2 points, Coulomb slip, over a bare vectorised loop, block-steps/s")
    for blocks in (1024, 10_240, 102_400, 1_024_000):
        scene = changed(SLIDES, blocks)
        side_by_side(f"{blocks:,} blocks, one thread", stretch(scene), bare_spatial(scene, blocks))
    print("finite over small rotations, the same scene, block-steps/s")
    for blocks in (1024, 102_400):
        turned = stretch(changed(SLIDES | {"motion.rotation": "finite"}, blocks))
        side_by_side(f"{blocks:,} blocks, one thread", turned, stretch(changed(SLIDES, blocks)))
    print("spatial kernel, two threads over one, block-steps/s")
    for blocks in (10_240, 102_400, 1_024_000):
        scene = changed(SLIDES, blocks)
        side_by_side(f"{blocks:,} blocks", stretch(scene, 2), stretch(scene, 1))
