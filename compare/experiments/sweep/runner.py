"""How a sweep is run: every case once, kept as soon as it is done, on any executor."""

from __future__ import annotations

import json
from collections.abc import Iterator
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import cases
from cases.errors import SceneError
from compare.engines import Progress
from compare.experiments.pool import Pool
from compare.experiments.sweep.axis import Axis, settings
from compare.experiments.sweep.case import Case, Outcome, Work, key, outcome
from compare.runs.output import read_kept, write_text
from compare.scenes import find

KEPT = "points"  # the folder of what is done
LONGEST = 100  # characters of a folder's name


def cases_of(
    scene: str, changes: dict[str, Any], variant: str | None, axes: list[Axis], out: Path
) -> list[Case]:
    """Return the variants of a scene at every point.

    Raises SceneError where there is no scene at any point.
    """
    path, found, errors = find(scene), [], []
    for i, setting in enumerate(settings(axes)):
        folder, overrides = out / _folder(setting, i), {**changes, **setting}
        try:
            scenes = (
                cases.load(path, overrides)
                if variant is None
                else [cases.load_variant(path, variant, overrides)]
            )
        except SceneError as error:
            errors.append(error)
            found.append(Case(setting, folder, None, str(error)))
        else:
            found += [Case(setting, folder, one) for one in scenes]
    if errors and len(errors) == len(found):
        raise errors[0]
    return found


def _folder(setting: dict[str, Any], number: int) -> str:
    """Return the name of a point's folder: its values, or its number where they make no name."""
    name = ",".join(f"{k}={v}" for k, v in setting.items())
    plain = name.isprintable() and not set(name) & set("/\\") and len(name.encode()) <= LONGEST
    single = not any(isinstance(value, list | dict) for value in setting.values())
    return name if plain and single else f"point-{number + 1:05d}"


def run(
    wanted: list[Case],
    work: Work,
    out: Path | None,
    pool: Pool | None = None,
    progress: Progress | None = None,
) -> list[Outcome]:
    """Return what comes of all cases, in order; those that are done are taken from `out`.

    out : None: nothing is kept. pool : makes the executor; None: one after the other, here.
    """
    places = [_place(case, work, out) for case in wanted]
    found = {i: kept for i, place in enumerate(places) if (kept := _kept(place)) is not None}
    missing = [i for i in range(len(wanted)) if i not in found]
    for i, one in _made(wanted, missing, work, pool):
        found[i], place = one, places[i]
        if place is not None and one.message != LOST:
            write_text(place, json.dumps(one._asdict()))
        if progress:
            progress(len(found) / len(wanted))
    return [found[i] for i in range(len(wanted))]


LOST = "its process has ended before it was done, maybe for want of memory"


def _made(
    wanted: list[Case], missing: list[int], work: Work, pool: Pool | None
) -> Iterator[tuple[int, Outcome]]:
    """Yield (number, outcome) of cases as they are done."""
    if pool is None:
        for i in missing:
            yield i, outcome(wanted[i], work)
        return
    with pool() as executor:
        futures = {executor.submit(outcome, wanted[i], work): i for i in missing}
        for future in as_completed(futures):
            try:
                yield futures[future], future.result()
            except BrokenProcessPool:
                yield futures[future], Outcome("failed", LOST, [])


def _place(case: Case, work: Work, out: Path | None) -> Path | None:
    if out is None or case.scene is None:
        return None
    return out / KEPT / f"{key(case, work)}.json"


def _kept(place: Path | None) -> Outcome | None:
    """Return what was kept of a case; None where there is nothing, or its results are gone."""
    if place is None or not place.is_file():
        return None
    found = read_kept(place, Outcome)
    gone = any(not Path(str(row["file"])).is_file() for row in found.rows if "file" in row)
    return None if gone else found
