"""Run a sweep: every variant at every point once, on any executor."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

from cases.errors import SceneError
from compare.engines import Progress
from compare.experiments.pool import Pool
from compare.experiments.store import Store
from compare.experiments.sweep.axis import Axis, settings
from compare.experiments.sweep.case import Case, Outcome, Work, key, outcome
from compare.scenes import find, load, load_variant

POINTS = "points"  # the folder of what is done
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
                load(path, overrides)
                if variant is None
                else [load_variant(path, variant, overrides)]
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
    """Return the outcomes of all cases, in order; those that are done are taken from `out`.

    out : None: nothing is saved.
    """
    outcomes: Store[Outcome] = Store(Outcome, out and out / POINTS, _has_files)
    key_of, outcome_of = partial(key, work=work), partial(outcome, work=work)
    return outcomes.compute(wanted, key_of, outcome_of, pool, progress, lost=LOST)


LOST = Outcome("failed", "its process has ended before it was done, maybe for want of memory", [])


def _has_files(found: Outcome) -> bool:
    """Return whether the results of a case are still there."""
    return all(Path(str(row["file"])).is_file() for row in found.rows if "file" in row)
