"""What is planned for every shipped scene, held against a full study of it.

The study runs every family of the planner at two steps to a doubling. A family ends where it meets
the misfits, where a run takes over three times the seconds of the cheapest that does (finer steps
cost more) or over 2 s, and where no finer step could come within a misfit even if the error fell
with the square root of the step alone. It is not begun where its freedom-steps would be too dear
at half of the least that one has taken. The configurations that are compared are timed in turns.
Rows that are done are kept, and not run again.
"""

import argparse
from pathlib import Path
from time import perf_counter

from full_study import rows_of
from table import show, write

import cases
from cases.kinds import AnyScene
from compare.experiments import store
from compare.experiments.store import Store
from compare.scenes import shipped
from results.dataset import scene_hash


def kept(
    path: Path, scene: AnyScene, misfits: list[float], rounds: int, folder: Path
) -> list[dict]:
    """Return the rows of a scene, from the folder if they are there."""
    (found,) = Store[list[dict]](list[dict], folder).compute(
        [scene],
        lambda one: store.key(scene_hash(one), misfits, rounds),
        lambda one: rows_of(one, misfits, rounds),
    )
    return [{"scene": f"{path.parent.name}/{path.stem}", **row} for row in found]


def main() -> None:
    """Hold the plans of the shipped scenes whose names contain a word, or of all pillars."""
    parser = argparse.ArgumentParser(prog="python tools/plan", description=__doc__)
    parser.add_argument(
        "word", nargs="?", default="", help="part of the names of scenes; all pillars"
    )
    parser.add_argument("--misfit", type=float, nargs="+", default=[0.01, 0.001])
    parser.add_argument("--rounds", type=int, default=9, help="of timing, for runs below 50 ms")
    parser.add_argument("--out", type=Path, default=Path("out/plan"), help="table and points")
    options = parser.parse_args()
    began, rows = perf_counter(), []
    for path in shipped():
        for scene in cases.load(path) if options.word in str(path) else ():
            if not options.word and not isinstance(scene, cases.Scene):
                continue  # rock masses take minutes each: they are planned by name
            rows += kept(path, scene, options.misfit, options.rounds, options.out / "points")
            print(f"{perf_counter() - began:6.0f} s  {rows[-1]['scene']} {scene.name}", flush=True)
    for misfit in options.misfit:
        show(rows, misfit)
    write(options.out / "plans.csv", rows)
    print(f"written: {options.out / 'plans.csv'}; {perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
