"""The cost of a step of one block or one freedom, with the effects that a scene calls for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import cases
from cases.effects import is_spatial
from cases.kinds import pillar_of
from cases.sampling import Clock
from cases.schema.scene import Scene
from compare.engines import solve
from compare.experiments.cost import timings

if TYPE_CHECKING:
    from cases.kinds import AnyScene

PILLAR = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
#: A function that takes some samples, and its number of block-steps.
Stretch = tuple[Callable[[], None], int]

REPEATS = 5
SHORTEST = 0.02  # s, of what a clock is read for
LONGEST = 0.5  # s: of stepping: continuum runs that took as long are not repeated
BLOCK_STEPS = 5_000_000  # of one call, at most, but for one sample
BLOCK_STEPS_IN_SPACE = 500_000  # each of them takes ten times as long
BLOCKS = 1000  # of the pillar that effects are compared on

#: A blow that moves blocks in all their freedoms.
ACROSS = {"load.direction": [0.6, 0.8, 0.0], "load.at": [0.1, 0.05]}

#: Every effect at once: the line against which a scene's own cost is held.
EVERYTHING = {
    **ACROSS,
    "motion.rotation": "finite",
    "joints.damping_ratio": 0.02,
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e5,
    "joints.residual_cohesion": 0.0,
    "joints.tensile_strength": 1e5,
    "joints.fracture_energy": 100.0,
    "soft_layers": [{"y": 0.5, "spacing_stiffness": 4.375e8}],
    "record.stress": [0.5],
    "damping.mass_proportional": 1.0,
    "gravity": {"direction": [1, 0, 0], "static": False},
    "ends.start": "matched",
    "ends.end": "quiet",
}


def changed(changes: dict, blocks: int = BLOCKS) -> Scene:
    """Return the paper's pillar with so many blocks and some dotted keys changed."""
    return pillar_of(cases.load_variant(PILLAR, "", {"pillar.length": 0.5 * blocks, **changes}))


def everything(blocks: int) -> Scene:
    """Return the paper's pillar with every effect and so many blocks, but for very many: few blocks
    share what a step costs however few they are."""
    return changed(EVERYTHING, min(max(blocks, 2), BLOCKS))


def everything_like(scene: AnyScene) -> AnyScene:
    """Return a scene of this kind with every effect and about as many rigid blocks."""
    if isinstance(scene, Scene):
        return everything(scene.pillar.block_count)
    from compare.experiments.cost.plane_step_cost import everything_in_plane

    return everything_in_plane(scene, BLOCKS)


def nanoseconds(scene: AnyScene, threads: int = 1) -> float:
    """Return what one step of one block of a scene costs, ns: the least of some stretches."""
    return in_turns([scene], threads)[0]


def in_turns(scenes: Sequence[AnyScene], threads: int = 1) -> list[float]:
    """Return the same of several scenes, their stretches in turns: what slows the machine for a
    while slows all of them."""
    timed = [stretch(scene, threads) for scene in scenes]
    for march, _ in timed:
        march()  # compiles, and sets the blocks in motion
    rounds = [[_seconds(march) for march, _ in timed] for _ in range(REPEATS)]
    least = map(min, zip(*rounds, strict=True))
    return [1e9 * s / block_steps for s, (_, block_steps) in zip(least, timed, strict=True)]


def freedoms_in_turns(engine: str, scenes: Sequence[AnyScene]) -> list[float]:
    """Return what one step of one freedom of a continuum engine costs, ns: the least of some runs,
    those of the scenes in turns.

    Raises SceneError where the engine does not apply, UnstableError where it goes unstable.
    """
    rounds: list[list[float]] = []
    while len(rounds) < REPEATS and sum(map(sum, rounds)) < LONGEST * len(scenes):
        runs = [solve(engine, scene).attrs for scene in scenes]
        rounds.append([run["seconds_stepping"] for run in runs])
    counts = [run["steps"] * run["degrees_of_freedom"] for run in runs]
    least = map(min, zip(*rounds, strict=True))
    return [1e9 * s / count for s, count in zip(least, counts, strict=True)]


def _seconds(march: Callable[[], None]) -> float:
    """Return the seconds of one call, from as many as a clock can tell."""
    calls, spent = 0, 0.0
    began = perf_counter()
    while spent < SHORTEST:
        march()
        calls, spent = calls + 1, perf_counter() - began
    return spent / calls


def stretch(scene: AnyScene, threads: int = 1) -> Stretch:
    """Return a function that takes some samples of a scene, and its number of block-steps."""
    if not isinstance(scene, Scene):
        from compare.experiments.cost.plane_step_cost import stretch_in_plane

        return stretch_in_plane(scene, threads)
    return stretches(scene, (False,), threads)[0]


def stretches(scene: Scene, guarded: tuple[bool, ...], threads: int = 1) -> list[Stretch]:
    """Return the same with the same arrays, once for each: `guarded`, under a divergence monitor
    that never finds anything, or not."""
    if is_spatial(scene):
        return _in_space(scene, guarded, threads)
    return _along_axis(scene, guarded)


def _along_axis(scene: Scene, guarded: tuple[bool, ...]) -> list[Stretch]:
    from dem.axial.samples import buffers
    from dem.axial.simulate import scheme_of
    from numerics.divergence import Guard, guard

    scheme = scheme_of(scene)
    model, state, time, _ = scheme.build(scene)
    count = samples_of(time, state.u.size)
    samples, block_steps = buffers(model, state, count), count * time.stride * state.u.size
    run = scheme.runner(scene, time)

    def timed(monitor: Guard | None) -> Stretch:
        return lambda: run(model, state, samples, time.stride, 0, count, monitor), block_steps

    return [timed(guard(inf) if held else None) for held in guarded]


def _in_space(scene: Scene, guarded: tuple[bool, ...], threads: int) -> list[Stretch]:
    from dem.spatial.build import buffers_for, samples_for, state_at_rest
    from dem.spatial.march import marcher
    from dem.spatial.simulate import prepare
    from numerics.divergence import guard

    p, model, time, _ = prepare(scene)
    count = samples_of(time, p.block_count, BLOCK_STEPS_IN_SPACE)
    state, samples = state_at_rest(model), samples_for(model, count)
    steps = count * time.stride

    def timed(held: bool) -> Stretch:
        buffers = buffers_for(model, threads, guard([inf] * 6) if held else None)
        march = marcher(model, state, buffers, samples)
        march(0, 0)
        return lambda: march(0, steps), steps * p.block_count

    return [timed(held) for held in guarded]


def samples_of(time: Clock, blocks: int, most: int = BLOCK_STEPS) -> int:
    """Return how many samples a stretch takes."""
    return min(time.samples, max(64, most // blocks) // time.stride + 1)


def remembered_whole(blocks: int) -> float | None:
    """Return `whole` where it was measured already, else None."""
    seconds = timings.whole(_of_everything(everything(blocks)))
    return None if seconds is None else 1e9 * seconds


def whole(blocks: int) -> float:
    """Return the cost of a block-step with every effect in a row of so many blocks, ns; measured
    once for each version."""
    known = remembered_whole(blocks)
    if known is None:
        scene = everything(blocks)
        known = nanoseconds(scene)
        timings.note_whole(_of_everything(scene), 1e-9 * known)
    return known


def _of_everything(scene: Scene) -> str:
    return f"every effect in {scene.pillar.block_count} blocks"
