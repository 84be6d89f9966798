"""The free pillar in other codes and in ours: misfits, rates and ratios of one run."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import akantu_bar
import environment
import lammps_bonds
import measure
import ours
import table
from environment import Place
from job import Job

from jointwave import cases
from jointwave.cases.schema.scene import Scene
from jointwave.compare.report.peers import sentences
from jointwave.compare.runs.output import write_csv
from jointwave.compare.scenes import find


class Peer(NamedTuple):
    """Another code: where it is, its runs, and the curves that are missing without it."""

    place: Callable[[], Place]
    jobs: Callable[[Scene, Place, Path], list[Job]]
    curves: dict[str, str]


PEERS = {
    "lammps": Peer(
        environment.lammps,
        lammps_bonds.jobs,
        {style.curve: style.solves for style in (lammps_bonds.POINTS, lammps_bonds.SPHERES)},
    ),
    "akantu": Peer(
        environment.akantu,
        akantu_bar.jobs,
        {akantu_bar.CURVES[dim]: akantu_bar.SOLVES[dim] for dim in (1, 3)},
    ),
}


def written(names: list[str], scene: Scene, root: Path) -> tuple[list[Job], list[dict]]:
    """Write the inputs of all peers that can be had; return their runs and the missing rows."""
    jobs, missing = [], []
    for name in names:
        place = PEERS[name].place()
        if place.missing:
            missing += [table.missing_row(*c, place.missing) for c in PEERS[name].curves.items()]
        else:
            jobs += PEERS[name].jobs(scene, place, root)
    return jobs, missing


def beside(jobs: list[Job], scene: Scene, root: Path) -> tuple[list[Job], dict[int, int]]:
    """Return all runs, ours next to the first peer that each is held beside, and whose is whose."""
    every: list[Job] = []
    place: dict[object, int] = {}
    pairs = {}
    for job in jobs:
        assert job.twin is not None  # every peer has one
        if job.twin not in place:
            place[job.twin] = len(every)
            every.append(ours.job(scene, job.twin, root))
        pairs[len(every)] = place[job.twin]
        every.append(job)
    every += [ours.job(scene, twin, root) for twin in ours.ALONE]
    return every, pairs


def rows_of(every: list[Job], pairs: dict[int, int], rounds: int, references: dict) -> list[dict]:
    """Run everything in turns and return the rows, by curve."""
    turns = measure.take_turns(every, rounds)
    rows = [measure.row(job, taken, references) for job, taken in zip(every, turns, strict=True)]
    for peer, own in pairs.items():
        rows[peer] |= {"beside": every[own].curve, **measure.ratios(turns[peer], turns[own])}
    order = list(dict.fromkeys(row["curve"] for row in rows))
    return sorted(rows, key=lambda row: order.index(row["curve"]))


def main() -> None:
    """Run the peers that are named, or all, and write and print the table."""
    parser = argparse.ArgumentParser(prog="python tools/peers", description=__doc__)
    parser.add_argument("peers", nargs="*", metavar="PEER", help=f"of {', '.join(PEERS)}; all")
    parser.add_argument("--rounds", type=int, default=5, help="turns of each run")
    parser.add_argument("--out", type=Path, default=Path("out/peers"), help="inputs and table")
    options = parser.parse_args()
    if unknown := [name for name in options.peers if name not in PEERS]:
        parser.error(f"no peer {unknown[0]!r}; known: {', '.join(PEERS)}")
    if options.rounds < 1:
        parser.error("--rounds must be at least 1")
    measure.on_one_core()
    scene = cases.load_variant(find(ours.SCENE), "", ours.ALIKE)
    root = options.out.resolve()
    about = table.machine()  # its load before ours
    jobs, missing = written(options.peers or list(PEERS), scene, root)
    rows = rows_of(*beside(jobs, scene, root), options.rounds, ours.references(scene, root))
    print(f"{scene.title}; {options.rounds} rounds; {about}")
    found = table.frame([row | {"machine": about} for row in (*rows, *missing)])
    print(f"written: {write_csv(root / 'points.csv', found)}")
    for line in sentences(found[found.state == "done"]):
        print(line)


if __name__ == "__main__":
    main()
