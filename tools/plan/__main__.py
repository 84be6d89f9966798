"""What is planned for every shipped scene, held against a full study of it.

The study runs every family of the planner at two steps to a doubling. A family ends where it meets
the misfits, and where a run takes over three times the seconds of the cheapest that does, as finer
steps cost more, or over 2 s. It is not begun where its freedom-steps would take as long, even at
half of the least that one has taken. The configurations that are compared are timed in turns.
Rows that are done are kept, and not run again.
"""

import argparse
import csv
import hashlib
import io
import json
from pathlib import Path
from time import perf_counter

from held import rows_of

import cases
from cases.result import scene_hash
from cases.scene import Scene
from compare.output import write_text
from compare.scenes import shipped
from compare.studies.runner import program

WITHIN = 1.5  # times the cheapest of the study
COLUMNS = (
    *("scene", "variant", "asked", "reference", "reference_error", "chosen", "met", "ratio"),
    *("predicted_misfit", "misfit", "predicted_seconds", "obtained_seconds", "seconds"),
    *("best", "best_misfit", "best_seconds", "points", "trials", "planning", "message"),
)


def kept(path: Path, scene: Scene, misfits: list[float], rounds: int, folder: Path) -> list[dict]:
    """Return the rows of a scene, from the folder if they are there."""
    about = json.dumps([scene_hash(scene), misfits, rounds, program()])
    place = folder / f"{hashlib.sha256(about.encode()).hexdigest()[:16]}.json"
    if not place.is_file():
        write_text(place, json.dumps(rows_of(scene, misfits, rounds), indent=1))
    name = f"{path.parent.name}/{path.stem}"
    return [{"scene": name, **row} for row in json.loads(place.read_text(encoding="utf-8"))]


def line(row: dict) -> str:
    """Return a row of the printed table."""
    name = f"{row['scene']} {row['variant']}".strip()
    verdict = "met" if row["met"] else "missed"
    if not row.get("chosen"):
        best = f"; the study's best: {row['best']}" if "best" in row else "; nor does the study"
        return f"{name:55s} {verdict:7s} {row['message']}{best}"
    ratio = f"{row['ratio']:5.2f}" if "best" in row else "    –"
    return (
        f"{name:55s} {verdict:7s}{100 * row['predicted_misfit']:8.3g}{100 * row['misfit']:8.3g} "
        f"{1e3 * row['predicted_seconds']:8.3g}{1e3 * row['seconds']:8.3g} {ratio} "
        f"{row['planning']:7.1f}{row['trials']:4d}  {row['chosen']}"
        + ("" if row["ratio"] == 1 or "best" not in row else f" | {row['best']}")
    )


def show(rows: list[dict], misfit: float) -> None:
    """Print the rows of a misfit, and what they say in a sentence."""
    mine = [row for row in rows if row["asked"] == misfit]
    print(
        f"\n{'asked: ' + format(100 * misfit, 'g') + ' %':55s} {'':7s}{'misfit, %':>16s} ", end=""
    )
    print(f"{'stepping, ms':>16s} {'ratio':>5s} {'planning, s, runs':>11s}  chosen | study's best")
    print(f"{'':62s}{'told':>8s}{'found':>8s} {'told':>8s}{'found':>8s}")
    for row in mine:
        print(line(row))
    met = sum(row["met"] for row in mine)
    near = sum(row["met"] and row["ratio"] <= WITHIN for row in mine)
    out_of_reach = sum("best" not in row for row in mine)
    print(
        f"{100 * misfit:g} %: met in {met} of {len(mine)} scenes, at no more than {WITHIN} "
        f"times the cheapest of the full study in {near}; no configuration of the study meets it "
        f"in {out_of_reach}"
    )


def write(path: Path, rows: list[dict]) -> None:
    """Write the rows as CSV; a value that a row does not have stays empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_text(path, text.getvalue())


def main() -> None:
    """Hold the plans of the shipped scenes whose names contain a word, or of all."""
    parser = argparse.ArgumentParser(prog="python tools/plan", description=__doc__)
    parser.add_argument("word", nargs="?", default="", help="part of the names of scenes; all")
    parser.add_argument("--misfit", type=float, nargs="+", default=[0.01, 0.001])
    parser.add_argument("--rounds", type=int, default=9, help="of timing, for runs below 50 ms")
    parser.add_argument("--out", type=Path, default=Path("out/plan"), help="table and points")
    options = parser.parse_args()
    began, rows = perf_counter(), []
    for path in shipped():
        for scene in cases.load(path) if options.word in str(path) else ():
            rows += kept(path, scene, options.misfit, options.rounds, options.out / "points")
            print(f"{perf_counter() - began:6.0f} s  {rows[-1]['scene']} {scene.name}", flush=True)
    for misfit in options.misfit:
        show(rows, misfit)
    write(options.out / "plans.csv", rows)
    print(f"written: {options.out / 'plans.csv'}; {perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
