"""Sweeps: a scene run or compared at every value of some keys.

Each point has a folder named by its values, with the files that the command writes without
`--sweep`. An ensemble is a sweep of the seed of random joints, see `compare.studies.ensemble`.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import joblib
import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.errors import InterruptedRun, SceneError
from jointwave.cases.read import parse_override
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.figures.tables import write_comparisons
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place, places_of
from jointwave.compare.runs import comparison
from jointwave.compare.runs.checkpoint.resume import CheckpointSettings
from jointwave.compare.runs.checkpoint.signals import Signals
from jointwave.compare.runs.jobs import plan
from jointwave.compare.runs.reuse import ResultFolder
from jointwave.compare.runs.run import execute
from jointwave.compare.scenes import find, load, load_variants
from jointwave.compare.studies import ensemble, store
from jointwave.compare.studies.ensemble import MEMBER
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.store import DIED, FAILURES, Store
from jointwave.compare.studies.sweep_keys import axes
from jointwave.compare.studies.sweep_table import summarise
from jointwave.results.dataset import scene_hash
from jointwave.results.netcdf import load_netcdf

LONGEST = 100  # characters of a folder's name
PEAKS = ("stress", "velocity", "traction")
Rows = list[dict[str, Any]]
#: Solves a scene, anew or not, writes its files into a folder and returns its rows.
Work = Callable[[AnyScene, Path | None, bool], Rows]


class Case(NamedTuple):
    """A variant of a scene with its swept keys set.

    folder : for its files, in which variants have their own; None writes nothing. scene : None if
    it is invalid, for the reason in `message`.
    """

    settings: dict[str, Any]
    folder: Path | None
    scene: AnyScene | None
    message: str = ""

    @property
    def point(self) -> str:
        """The keys with their values."""
        return ", ".join(f"{key}={value}" for key, value in self.settings.items())

    @property
    def variant(self) -> str:
        """The name of its variant."""
        return self.scene.name if self.scene else ""


def cases_of(
    scene: str,
    changes: list[str],
    variant: str | None,
    given: list[str],
    out: Path | None,
    members: int = 0,
) -> list[Case]:
    """Return all variants at every point of `--set`, `--variant`, `--sweep` and `--ensemble`;
    raises SceneError in one line, also if no point has a valid scene."""
    fixed = dict(map(parse_override, changes))
    values = axes(given, list(fixed)) | ({MEMBER: [*range(1, members + 1)]} if members else {})
    path, found, errors = find(scene), [], []
    for i, combination in enumerate(product(*values.values()), start=1):
        setting = dict(zip(values, combination, strict=True))
        folder = None if out is None else out / _folder(setting, i)
        try:
            scenes = _scenes(path, variant, {**fixed, **setting})
        except SceneError as error:
            errors.append(error)
            found.append(Case(setting, folder, None, str(error)))
        else:
            found += [Case(setting, folder, one) for one in scenes]
    if errors and len(errors) == len(found):
        raise errors[0]
    return found


def _scenes(path: Path, variant: str | None, changes: dict[str, Any]) -> list[AnyScene]:
    if (number := changes.pop(MEMBER, 0)) > 0:
        changes |= ensemble.seeds(load(path, variant or "", changes), number)
    return load_variants(path, changes) if variant is None else [load(path, variant, changes)]


def _folder(setting: dict[str, Any], number: int) -> str:
    """Return the name of a point's folder: its values, or its number if they are no valid name."""
    name = ",".join(f"{k}={v}" for k, v in setting.items())
    plain = name.isprintable() and not set(name) & set("/\\[{") and len(name.encode()) <= LONGEST
    return name if plain else f"point-{number:05d}"


def experiment(
    scene: str, cases: list[Case], out: Path | None, fresh: bool, work: Work
) -> Experiment:
    """Return a sweep. Its table has the rows of all cases in order, with their keys, variant and
    folder, `state`, "done" or "failed", and the reason in `message`.

    scene : its name. out : the folder; None writes nothing. Completed cases are read from it, if
    their files are still there. fresh : compute them anew.
    """

    def key(case: Case) -> str:
        about = case.message if case.scene is None else [case.variant, scene_hash(case.scene)]
        return store.key(str(case.folder), about, joblib.hash(work))

    def told(found: list[Rows]) -> Summary:
        return summarise(scene, list(cases[0].settings), out, table_of(cases, found))

    folder, lost = out and out / "points", lambda _: _failed(DIED)
    saved = Store[Case, Rows](Rows, folder, key, _has_files, fresh, lost)
    measure = partial(_outcome, work=work, fresh=fresh)
    return Experiment(f"{len(cases)} points", cases, saved, measure, list, told)


def table_of(cases: list[Case], found: list[Rows]) -> pd.DataFrame:
    """Return the rows of all cases as a table, SI."""
    return pd.DataFrame(
        {
            k: json.dumps(v, default=str) if isinstance(v, list | dict) else v
            for k, v in case.settings.items()
        }
        | {"variant": case.variant}
        | {"folder": str(case.folder / case.variant if case.folder else "")}
        | row
        for case, rows in zip(cases, found, strict=True)
        for row in rows
    )


def _has_files(rows: Rows) -> bool:
    return all(Path(row["file"]).is_file() for row in rows if "file" in row)


def _outcome(case: Case, work: Work, fresh: bool) -> Rows:
    if case.scene is None:
        return _failed(case.message)
    try:
        found = work(case.scene, case.folder, fresh)
    except InterruptedRun:
        raise
    except (*FAILURES, MemoryError) as error:
        return _failed(str(error) or "not enough memory")
    return [{"state": "done", "message": ""} | row for row in found]


def _failed(message: str) -> Rows:
    return [{"state": "failed", "message": message}]


def run_scene(
    scene: AnyScene, folder: Path | None, fresh: bool, runs: list[tuple[str, str | None]]
) -> Rows:
    """Run a scene as `jointwave run` does; return a row for each receiver of each result, with the
    peak there. runs : (engine, model) each, see `compare.runs.jobs`."""
    rows: Rows = []
    settings = CheckpointSettings(0.0, False, Signals(), fresh)
    jobs, left_out = plan([scene], runs, folder or Path())
    if left_out:
        raise left_out[0]
    for done in execute(jobs, lambda fraction: None, settings=settings):
        result = load_netcdf(done.job.path)
        facts, residual = done.facts, done.facts["energy_residual"]
        about = {
            "engine": done.job.name,
            "steps": facts["steps"],
            "freedoms": float(result.attrs.get("degrees_of_freedom", nan)),
            "seconds": facts["seconds_stepping"],
            "energy_residual": nan if residual is None else residual,
            "file": facts["file"],
        }
        nowhere = {"quantity": "", "y": nan, "peak": nan, "time_of_peak": nan}
        rows += [about | peak for peak in [*_peaks(result)] or [nowhere]]
    return rows


def _peaks(result: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield the value of largest magnitude at each receiver, with its sign and time (SI).

    For several components the norm, without sign: the speed for a velocity in space.
    """
    for quantity in (name for name in PEAKS if name in result):
        for at, wave in zip(places_of(result, quantity)[0], result[quantity].values, strict=True):
            several = wave.ndim > 1 and wave.shape[1] > 1
            values = np.linalg.norm(wave, axis=1) if several else wave.ravel()
            k = int(np.argmax(np.abs(values)))
            peak = {"peak": float(values[k]), "time_of_peak": float(result.time[k])}
            yield {"quantity": quantity, **Place(quantity, "", at).coordinates, **peak}


def compare_scene(
    scene: AnyScene,
    folder: Path | None,
    fresh: bool,
    spectral: bool,
    curves: list[Curves],
    align: bool,
) -> Rows:
    """Compare a scene as `jointwave compare` does, and keep all results; return a row for each
    distance."""
    stored = ResultFolder(folder, fresh)
    found = comparison.compare(scene, curves, None, align, spectral, stored)
    if folder is not None:
        write_comparisons([found], folder / scene.name)
    if not found.rows:
        allowed = "has nothing to compare: no pair of solutions applies"
        raise SceneError(scene.where, "", None, allowed)
    rows: Rows = []
    for row in found.rows:
        facts = {name: nan if x is None else x for name, x in row.facts.items()}
        rows.append(facts | {"pair": row.solutions, "faint": str(row.faint).lower()})
    return rows
