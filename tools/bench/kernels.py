"""The engine's kernels against the same updates as bare loops, in turn, as ratios."""

from collections.abc import Callable
from statistics import median
from time import perf_counter

import bare
import numpy as np
from rows import changed, stretch

from jointwave.cases.material.calibrate import calibrate

ROUNDS = 9
SHORTEST = 0.03  # s

Timed = tuple[Callable[[], None], int]  # takes steps; block-steps of one call


def rate(march: Callable[[], None], block_steps: int) -> float:
    """Return block-steps a second, from calls that take long enough to be timed."""
    calls, began, spent = 0, perf_counter(), 0.0
    while spent < SHORTEST:
        march()
        calls, spent = calls + 1, perf_counter() - began
    return calls * block_steps / spent


def in_words(pairs: list[tuple[float, float]], digits: int = 2) -> str:
    """Return the medians of two rates taken in turns and of their ratios, with least and most."""
    one, other = (median(rates) for rates in zip(*pairs, strict=True))
    ratios = [a / b for a, b in pairs]
    least, middle, most = (f"{f(ratios):.{digits}f}" for f in (min, median, max))
    return f"{one:8.2e} over {other:8.2e}: {middle} ({least} to {most})"


def side_by_side(label: str, one: Timed, other: Timed) -> None:
    """Time two kernels in turn and print both rates and the ratio one / other."""
    one[0]()
    other[0]()
    pairs = [(rate(*one), rate(*other)) for _ in range(ROUNDS)]
    print(f"  {label:42s} {in_words(pairs)}", flush=True)


def axial() -> None:
    """Springs, dashpots and recording against a bare fused loop."""
    print("axial kernel with dashpots and recording, over a bare fused loop, block-steps/s")
    for blocks in (100, 1000, 10_000, 100_000):
        changes = {"joints.damping_ratio": 0.02, "record.energy": False}
        scene = changed(changes, blocks)
        side_by_side(f"{blocks:,} blocks", stretch(scene), bare_axial(scene, blocks))


def bare_axial(scene, blocks: int) -> Timed:
    """Return the bare loop of a damped row."""
    p = calibrate(scene)
    k = p.regular_stiffness * p.area
    steps = max(1, 5_000_000 // blocks)
    u, v, rates = np.zeros(blocks), np.zeros(blocks), np.zeros(blocks - 1)
    numbers = (1e-5, 1e-5 / p.block_mass, k, k * p.time_constant, 1e3)
    return lambda: bare.axial(u, v, rates, steps, *numbers), steps * blocks


SLIDES = {
    "load.direction": [0.6, 0.8, 0.0],
    "load.at": [0.1, 0.05],
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e5,
    "record.energy": False,
}


def spatial() -> None:
    """Six freedoms, 2 x 2 points and Coulomb slip against a bare vectorised loop."""
    print("spatial kernel, 2 x 2 points, Coulomb slip, over a bare vectorised loop, block-steps/s")
    for blocks in (1024, 10_240, 102_400, 1_024_000):
        scene = changed(SLIDES, blocks)
        side_by_side(f"{blocks:,} blocks, one thread", stretch(scene), bare_spatial(scene, blocks))


def bare_spatial(scene, blocks: int) -> Timed:
    """Return the bare loop of a row that slides."""
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


def finite() -> None:
    """Finite rotations, in block-steps a second and over small ones."""
    print("finite over small rotations, the same scene, block-steps/s")
    for blocks in (1024, 102_400):
        small = changed(SLIDES, blocks)
        turned = changed({**SLIDES, "motion.rotation": "finite"}, blocks)
        side_by_side(f"{blocks:,} blocks, one thread", stretch(turned), stretch(small))


def threads() -> None:
    """Two threads over one."""
    print("spatial kernel, two threads over one, block-steps/s")
    for blocks in (10_240, 102_400, 1_024_000):
        scene = changed(SLIDES, blocks)
        side_by_side(f"{blocks:,} blocks", stretch(scene, 2), stretch(scene, 1))


def main() -> None:
    """Print all ratios."""
    axial()
    spatial()
    finite()
    threads()


if __name__ == "__main__":
    main()
