"""The effects of many scenes: each scene once, kept as soon as it is done."""

from __future__ import annotations

import hashlib
import json
from concurrent.futures import Executor, Future, as_completed
from pathlib import Path
from typing import NamedTuple

import cases
from cases.schema.scene import Scene
from compare.engines import Progress
from compare.experiments.ablation.ablation import Balance, Dropped, balance, prepare
from compare.experiments.cost import timings
from compare.experiments.cost.step_cost import BLOCKS, everything, stretch
from compare.experiments.pool import Pool
from compare.experiments.study.runner import alone
from compare.runs.checkpoint.signature import program
from compare.runs.output import read_kept, write_text
from compare.scenes import find, shipped
from results.dataset import scene_hash

RATE = "effects of a variant"  # what the seconds of cases are remembered by
PREPARING = 0.8  # of the time, where nothing is compiled yet

#: Scenes of the report's page, each with the variants that it takes: what is compiled there anyhow.
REPORTED = {
    "guo-li-2002/fig-03": ["zeta 0.05"],
    "guo-li-2002/fig-05": ["matched"],
    "guo-li-2002/fig-07": ["soft layer"],
    "guo-li-2002/fig-09": ["no tension"],
}


class Case(NamedTuple):
    """One variant of a scene, and the scene's name as its user knows it."""

    name: str
    scene: Scene

    @property
    def key(self) -> str:
        """What tells cases apart: everything that decides the answer, this program included."""
        text = json.dumps([self.name, self.scene.name, scene_hash(self.scene), program()])
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def all_shipped() -> list[Case]:
    """Return every variant of every shipped scene."""
    return [
        Case(f"{path.parent.name}/{path.stem}", scene)
        for path in shipped()
        for scene in cases.load(path)
    ]


def reported() -> list[Case]:
    """Return the cases of the report's page."""
    return [
        Case(name, cases.load_variant(find(name), variant))
        for name, variants in REPORTED.items()
        for variant in variants
    ]


def run(
    wanted: list[Case], folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[Balance]:
    """Return the balances of all cases, in order; those that are done are taken from `folder`.

    pool : makes the executor that solves and compiles; timings are taken here and one at a time.
    """
    incomplete = [case for case in wanted if not is_complete(case, folder)]
    with timings.timing(RATE, len(incomplete)):
        return _run(wanted, folder, pool, progress or (lambda fraction: None))


def _run(wanted: list[Case], folder: Path, pool: Pool | None, tell: Progress) -> list[Balance]:
    new = unprepared(wanted, folder)
    if pool is None or not new:
        for i, case in enumerate(new):
            prepare_case(case, folder)
            tell(PREPARING * (i + 1) / len(new))
    else:
        with pool() as executor:
            futures = submit(executor, new, folder)
            for i, future in enumerate(as_completed(futures)):
                future.result()
                tell(PREPARING * (i + 1) / len(futures))
    return complete(wanted, folder, lambda done: tell(PREPARING + (1 - PREPARING) * done))


def unprepared(wanted: list[Case], folder: Path) -> list[Case]:
    """Return the cases of which nothing is known yet."""
    return [
        case
        for case in wanted
        if not (_answers(case, folder).is_file() or _file(case, folder).is_file())
    ]


def is_complete(case: Case, folder: Path) -> bool:
    """Return whether the effects of a case are weighed already."""
    return _file(case, folder).is_file()


def submit(executor: Executor, new: list[Case], folder: Path) -> list[Future]:
    """Let an executor prepare cases that are not yet, and the step that all are held against."""
    whole = [executor.submit(prepare_whole)] if new else []
    return whole + [executor.submit(prepare_case, case, folder) for case in new]


def prepare_whole() -> None:
    """Compile the block-step with every effect."""
    stretch(everything(BLOCKS))[0]()


def prepare_case(case: Case, folder: Path) -> None:
    """Solve a case without each effect, compile what will be timed, and keep the answers."""
    answers = [one._asdict() for one in prepare(case.scene)]
    write_text(_answers(case, folder), json.dumps(answers, indent=1))


def complete(wanted: list[Case], folder: Path, progress: Progress | None = None) -> list[Balance]:
    """Time the cases that are prepared, one after the other while no other timing is running."""
    with alone():
        for i, case in enumerate(wanted):
            if not _file(case, folder).is_file():
                _time(case, folder)
            if progress:
                progress((i + 1) / len(wanted))
    return [read_kept(_file(case, folder), Balance) for case in wanted]


def _time(case: Case, folder: Path) -> None:
    answers = read_kept(_answers(case, folder), list[Dropped])
    found = balance(case.name, case.scene, answers)
    facts = found._asdict() | {"effects": [one._asdict() for one in found.effects]}
    write_text(_file(case, folder), json.dumps(facts, indent=1))
    _answers(case, folder).unlink()


def _file(case: Case, folder: Path) -> Path:
    return folder / f"{case.key}.json"


def _answers(case: Case, folder: Path) -> Path:
    return folder / f"{case.key}-answers.json"
