"""The free pillar and lattices in other codes and in jointwave: misfits, rates and ratios."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import akantu_bar
import environment
import lammps_bonds
import lattice
import measure
import ours
from environment import Place
from job import Job

from jointwave import cases
from jointwave.cases.schema.scene import Scene
from jointwave.compare.report.peers import sentences
from jointwave.compare.runs.output import write_csv
from jointwave.compare.scenes import find


class Peer(NamedTuple):
    """Another code: how to start it, its runs, and its curves (listed as missing without it)."""

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
        {akantu_bar.CURVES[d]: ours.KINDS[akantu_bar.TWINS[d]].solves for d in akantu_bar.CURVES},
    ),
}


def rows_of(jobs: list[Job], scene: Scene, rounds: int, root: Path) -> list[dict]:
    """Run all in turn, jointwave runs next to the peers compared with them; return the rows."""
    twins = [*dict.fromkeys(job.twin for job in jobs if job.twin), *ours.ALONE]
    own = {twin: ours.job(scene, twin, root) for twin in twins}
    every = [one for t, mine in own.items() for one in (mine, *(j for j in jobs if j.twin == t))]
    turns = dict(zip(every, measure.take_turns(every, rounds), strict=True))
    references = ours.references(scene, root)
    rows = [measure.row(job, turns[job], references) for job in (*jobs, *own.values())]
    for job, row in zip(jobs, rows, strict=False):
        mine = own[job.twin] if job.twin else job
        row |= {"beside": mine.curve, **measure.ratios(turns[job], turns[mine])}
    return rows


def main() -> None:
    """Run the named peers, or all; write the table and print ratios."""
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
    about = measure.machine()  # with the load before these runs
    places = {name: PEERS[name].place() for name in options.peers or PEERS}
    there = {name: place for name, place in places.items() if not place.missing}
    jobs = [job for name, place in there.items() for job in PEERS[name].jobs(scene, place, root)]
    rows = rows_of(jobs, scene, options.rounds, root)
    for name in places.keys() - there.keys():
        curves = PEERS[name].curves.items()
        rows += [measure.missing_row(*curve, places[name].missing) for curve in curves]
    print(f"{scene.title}; {options.rounds} rounds; {about}")
    found = measure.frame([row | {"machine": about} for row in rows])
    print(f"written: {write_csv(root / 'points.csv', found)}")
    for line in sentences(found[found.state == "done"]):
        print(line)
    if "lammps" in there:
        lattice.compare(there["lammps"], options.rounds, root / "lattice")


if __name__ == "__main__":
    main()
