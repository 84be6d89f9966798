"""The cost of a step of one block or one degree of freedom, with the effects of a scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

from cases.effects import is_spatial
from cases.kinds import AnyScene
from cases.sampling import Clock
from cases.schema.scene import Scene
from compare.experiments.cost import timings
from compare.experiments.cost.scenes import everything
from compare.solvers.incident import incident
from compare.solvers.record import Solver

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass
    from continuum.simulate import Start

#: A function that takes some samples, and its number of block-steps.
Stretch = tuple[Callable[[], None], int]

REPEATS = 5
SHORTEST = 0.01  # s, least duration of a timing
LONGEST = 0.25  # s, of stepping: longer continuum runs are not repeated
BLOCK_STEPS = 5_000_000  # of one call, at most, unless it has a single sample
BLOCK_STEPS_IN_SPACE = 50_000  # each takes ten times as long, with every effect a hundred times
FREEDOM_STEPS = 3_000_000  # of one call in the continuum, likewise


class StepCost(NamedTuple):
    """The minimum of some timings of a step, ns, and the excess of their median: the resolution of
    timings on this machine."""

    ns: float
    noise: float


def nanoseconds(scene: AnyScene, threads: int = 1) -> float:
    """Return the cost of one step of one block of a scene, ns: the minimum of some stretches."""
    return in_turns([scene], threads)[0].ns


def in_turns(scenes: Sequence[AnyScene], threads: int = 1) -> list[StepCost]:
    """Return the costs of several scenes, with alternating stretches, so that temporary load of the
    machine affects all of them."""
    timed = [stretch(scene, threads) for scene in scenes]
    for march, _ in timed:
        march()  # compiles, and sets the blocks in motion
    rounds = [[_seconds(march) for march, _ in timed] for _ in range(REPEATS)]
    return _least(rounds, [block_steps for _, block_steps in timed])


def freedoms_in_turns(engine: Solver, scenes: Sequence[AnyScene]) -> list[StepCost]:
    """Return the cost of one step of one freedom of a continuum engine: the minimum of two runs or
    more of the first samples, alternating between the scenes.

    Raises SceneError if the engine does not apply, UnstableError if it becomes unstable.
    """
    from continuum.simulate import start

    whole = [start(scene, str(engine.model), incident=incident(scene)) for scene in scenes]
    begun = [_shortened(one) for one in whole]
    for one in begun:
        one.engine.compile()
    timed = [one.march_again() for one in begun]
    rounds: list[list[float]] = []
    most = LONGEST * len(scenes)
    while len(rounds) < 2 or (len(rounds) < REPEATS and sum(map(sum, rounds)) < most):
        rounds.append([_once(march) for march in timed])
    steps = [one.run.choice.time.steps for one in begun]
    freedoms = [one.run.discrete.body.degrees_of_freedom for one in begun]
    return _least(rounds, [n * count for n, count in zip(steps, freedoms, strict=True)])


def _shortened(begun: Start) -> Start:
    """Return a run of the continuum that ends after its first samples."""
    run, time = begun.run, begun.run.choice.time
    count = samples_of(time, run.discrete.body.degrees_of_freedom, FREEDOM_STEPS)
    choice = run.choice._replace(time=time._replace(samples=count))
    return begun._replace(run=run._replace(choice=choice))


def _once(march: Callable[[], None]) -> float:
    """Return the seconds of one call."""
    began = perf_counter()
    march()
    return perf_counter() - began


def _least(rounds: list[list[float]], counts: list[int]) -> list[StepCost]:
    """Return the cost of one step, from seconds [round][scene] of `counts` steps."""
    found = []
    for seconds, count in zip(zip(*rounds, strict=True), counts, strict=True):
        least, middle = min(seconds), median(seconds)
        found.append(StepCost(1e9 * least / count, 1e9 * (middle - least) / count))
    return found


def _seconds(march: Callable[[], None]) -> float:
    """Return the seconds of one call, from enough calls for the clock's resolution."""
    calls, spent = 0, 0.0
    began = perf_counter()
    while spent < SHORTEST:
        march()
        calls, spent = calls + 1, perf_counter() - began
    return spent / calls


def stretch(scene: AnyScene, threads: int = 1) -> Stretch:
    """Return a function that takes some samples of a scene, and its number of block-steps."""
    if not isinstance(scene, Scene):
        return _in_plane(scene, threads)
    return stretches(scene, (False,), threads)[0]


def stretches(scene: Scene, guarded: tuple[bool, ...], threads: int = 1) -> list[Stretch]:
    """Return such functions on the same arrays, one per entry of `guarded`: with or without a
    divergence monitor, which never triggers."""
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
    marcher = scheme.marcher(scene, time)

    def timed(monitor: Guard | None) -> Stretch:
        march = marcher(model, state, samples, time.stride, monitor)
        return lambda: march(0, count), block_steps

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


def _in_plane(scene: RockMass, threads: int) -> Stretch:
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


def samples_of(time: Clock, blocks: int, most: int = BLOCK_STEPS) -> int:
    """Return the number of samples of a stretch."""
    return min(time.samples, max(64, most // blocks) // time.stride + 1)


def remembered_whole(blocks: int) -> float | None:
    """Return `whole` if it was measured already, else None."""
    seconds = timings.whole(_of_everything(everything(blocks)))
    return None if seconds is None else 1e9 * seconds


def whole(blocks: int) -> float:
    """Return the cost of a block-step with every effect in a row of this number of blocks, ns;
    measured once per version."""
    known = remembered_whole(blocks)
    if known is None:
        scene = everything(blocks)
        known = nanoseconds(scene)
        timings.note_whole(_of_everything(scene), 1e-9 * known)
    return known


def _of_everything(scene: Scene) -> str:
    return f"every effect in {scene.block_count} blocks"
