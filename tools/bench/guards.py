"""What looking at a run from within costs: kernels with their guard over the same without.

Both work on the same arrays, each in many turns and taken at its best: whatever disturbs a turn
only slows it. Where a process puts their machine code counts for as much as the guard, so that
several processes measure one after the other.
"""

from concurrent.futures import ProcessPoolExecutor
from math import inf
from multiprocessing import get_context

from kernels import SLIDES, Timed, in_words, rate
from rock import Engine, engine_of

from compare.experiments.cost.scenes import changed
from compare.experiments.cost.step_cost import stretches
from continuum.explicit.march import march
from numerics.divergence import Guard, guard

FREEDOM_STEPS = 5_000_000
PROCESSES = 7
TURNS = 10

SCENES = {
    "axis": {"record.energy": False},
    "axis, ledger": {},
    "axis, dashpots": {"joints.damping_ratio": 0.02, "record.energy": False},
    "space, Coulomb slip": SLIDES,
}

Rates = dict[str, tuple[float, float]]


def at_best(guarded: Timed, bare: Timed) -> tuple[float, float]:
    """Return the best rates of both, timed in turns."""
    guarded[0]()
    bare[0]()
    turns = [(rate(*guarded), rate(*bare)) for _ in range(TURNS)]
    return max(turn[0] for turn in turns), max(turn[1] for turn in turns)


def blocks() -> Rates:
    """Return the rates of rigid blocks, block-steps/s, guarded and not."""
    return {
        f"{name}, {count:,}": at_best(*stretches(changed(changes, count), (True, False)))
        for name, changes in SCENES.items()
        for count in (100, 10_000)
    }


def rock() -> Rates:
    """Return the rates of deformable rock in three dimensions, freedom-steps/s, likewise."""
    engines = {f"rock, {case} hexahedra": engine_of(case) for case in ("linear", "cubic")}
    return {
        name: at_best(marching(engine, guard(inf)), marching(engine, None))
        for name, engine in engines.items()
    }


def measured() -> Rates:
    """Return all rates of one process."""
    return blocks() | rock()


def marching(engine: Engine, held: Guard | None) -> Timed:
    """Return what takes some steps, and its number of freedom-steps."""
    size = engine.state.u.size
    steps = max(64, FREEDOM_STEPS // size)
    take = march(engine.model, engine.state, engine.samples, engine.time.stride, held)
    return lambda: take(1, 1 + steps), steps * size


def main() -> None:
    """Print the ratios: the median of all processes, the least and the most."""
    print(f"steps/s of blocks and freedoms, guarded over not, of {PROCESSES} processes", flush=True)
    found = []
    for _ in range(PROCESSES):
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
            found.append(process.submit(measured).result())
    for name in found[0]:
        print(f"  {name:32s} {in_words([rates[name] for rates in found], 3)}", flush=True)


if __name__ == "__main__":
    main()
