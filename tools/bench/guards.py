"""What looking at a run from within costs: kernels with their guard over the same without.

Both work on the same arrays: where they lie in memory can count for more than the guard.
"""

from collections.abc import Callable
from math import inf

from kernels import SLIDES, side_by_side
from rock import Engine, engine_of

from compare.effort import changed, stretches
from continuum.explicit import run
from joints.guard import Guard, guard

FREEDOM_STEPS = 5_000_000


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
            side_by_side(f"{name}, {count:,}", *stretches(scene, (True, False)))


def rock() -> None:
    """Print the ratios for deformable rock in three dimensions."""
    print("deformable rock, guarded over not, freedom-steps/s")
    for case in ("linear", "cubic"):
        engine = engine_of(case)
        side_by_side(case, marching(engine, guard(inf)), marching(engine, None))


def marching(engine: Engine, held: Guard | None) -> tuple[Callable[[], None], int]:
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
