"""What looking at a run from within costs: kernels with their guard over the same without.

Both work on the same arrays: where they lie in memory can count for more than the guard. To tell a
hundredth, each has many turns and is taken at its best: whatever disturbs a turn only slows it.
"""

from collections.abc import Callable
from math import inf
from statistics import median

from kernels import SLIDES, rate
from rock import Engine, engine_of

from compare.effort import changed, stretches
from continuum.explicit import run
from joints.guard import Guard, guard

FREEDOM_STEPS = 5_000_000
TURNS = 25

Timed = tuple[Callable[[], None], int]


def at_best(label: str, guarded: Timed, bare: Timed) -> None:
    """Time both in turns; print the best rate of each, their ratio, and that of the medians."""
    guarded[0]()
    bare[0]()
    turns = [(rate(*guarded), rate(*bare)) for _ in range(TURNS)]
    (best, free), (middle, usual) = (map(f, zip(*turns, strict=True)) for f in (max, median))
    ratios = f"{best / free:.3f}, medians {middle / usual:.3f}"
    print(f"  {label:42s} {best:8.2e} over {free:8.2e}: {ratios}", flush=True)


def blocks() -> None:
    """Print the ratios for rigid blocks."""
    print("rigid blocks, guarded over not, block-steps/s")
    scenes = {
        "axis": {"record.energy": False},
        "axis, ledger": {},
        "axis, dashpots": {"joints.damping_ratio": 0.02, "record.energy": False},
        "space, Coulomb slip": SLIDES,
    }
    for name, changes in scenes.items():
        for count in (100, 10_000):
            scene = changed(changes, count)
            at_best(f"{name}, {count:,}", *stretches(scene, (True, False)))


def rock() -> None:
    """Print the ratios for deformable rock in three dimensions."""
    print("deformable rock, guarded over not, freedom-steps/s")
    for case in ("linear", "cubic"):
        engine = engine_of(case)
        at_best(case, marching(engine, guard(inf)), marching(engine, None))


def marching(engine: Engine, held: Guard | None) -> Timed:
    """Return what takes some steps, and its number of freedom-steps."""
    size = engine.state.u.size
    steps = max(64, FREEDOM_STEPS // size)

    def march() -> None:
        run(engine.model, engine.state, engine.samples, engine.time.stride, 1, 1 + steps, held)

    return march, steps * size


def main() -> None:
    """Print all ratios."""
    blocks()
    rock()


if __name__ == "__main__":
    main()
