"""Sweeps: a scene run or compared at every value of some keys.

Each point has a folder named by its values, with the files that the command writes without
`--sweep`. An ensemble is a sweep of the seed of random joints.
"""

from collections.abc import Callable, Iterator
from functools import partial
from math import nan
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.errors import InterruptedRun, SceneError
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
from jointwave.compare.studies import store
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.store import DIED, FAILURES
from jointwave.compare.studies.sweep_keys import Case
from jointwave.compare.studies.sweep_table import summarise
from jointwave.results.dataset import scene_hash
from jointwave.results.netcdf import load_netcdf
from jointwave.results.stress import tensors

PEAKS = ("stress", "velocity", "traction")
Rows = list[dict[str, Any]]
#: Solves a scene, anew or not, writes its files into a folder and returns its rows.
Work = Callable[[AnyScene, Path | None, bool], Rows]


def experiment(
    scene: str, cases: list[Case], out: Path | None, fresh: bool, work: Work
) -> Experiment:
    """Return a sweep. Its table has the rows of all cases in order, with their keys, variant and
    folder, `state` ("done" or "failed") and, if failed, the reason in `message`.

    scene : its name. out : the folder; None writes nothing. fresh : compute all cases anew; else
    completed cases are read from `out` if their files still exist.
    """

    def key(case: Case) -> str:
        about = case.message if case.scene is None else [case.scene.name, scene_hash(case.scene)]
        return store.key(str(case.folder), about, joblib.hash(work))

    def summary(found: list[Rows]) -> Summary:
        points = zip(cases, found, strict=True)
        rows = [case.columns | row for case, some in points for row in some]
        return summarise(scene, list(cases[0].settings), out, pd.DataFrame(rows))

    return Experiment(
        f"{len(cases)} points",
        cases,
        out and out / "points",
        key,
        partial(_outcome, work=work, fresh=fresh),
        summary,
        is_valid=lambda rows: all(Path(row["file"]).is_file() for row in rows if "file" in row),
        fresh=fresh,
        lost=lambda _: _failed(DIED),
    )


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
    """Run a scene as `jointwave run` does; return a row with the peak at each receiver of each
    result. runs : pairs of engine and model, see `compare.runs.jobs`."""
    rows: Rows = []
    settings = CheckpointSettings(0.0, False, Signals(), fresh)
    jobs, left_out = plan([scene], runs, folder or Path())
    if left_out:
        raise left_out[0]
    for done in execute(jobs, lambda fraction: None, settings=settings):
        result, facts = load_netcdf(done.job.path), done.facts
        about = {
            "engine": done.job.name,
            "steps": facts["steps"],
            "freedoms": float(result.attrs.get("degrees_of_freedom", nan)),
            "seconds": facts["seconds_stepping"],
            "energy_residual": nan if (x := facts["energy_residual"]) is None else x,
            "file": facts["file"],
        }
        nowhere = {"quantity": "", "y": nan, "peak": nan, "time_of_peak": nan}
        rows += [about | peak for peak in [*_peaks(result)] or [nowhere]]
    return rows


def _peaks(result: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield the value of largest magnitude at each receiver, with its sign and time (SI)."""
    for quantity in (name for name in PEAKS if name in result):
        for at, wave in zip(places_of(result, quantity)[0], result[quantity].values, strict=True):
            values = _in_one(quantity, wave)
            k = int(np.argmax(np.abs(values)))
            peak = {"peak": float(values[k]), "time_of_peak": float(result.time[k])}
            yield {"quantity": quantity, **Place(quantity, "", at).coordinates, **peak}


def _in_one(quantity: str, wave: np.ndarray) -> np.ndarray:
    """Return one number per sample [n]: the only component, the length of a vector, or the
    principal stress of larger magnitude."""
    if wave.ndim == 1 or wave.shape[1] == 1:
        return wave.ravel()
    if quantity != "stress":
        return np.linalg.norm(wave, axis=1)
    least, *_, most = np.linalg.eigvalsh(tensors(wave)).T
    return np.where(np.abs(least) > np.abs(most), least, most)


def compare_scene(
    scene: AnyScene,
    folder: Path | None,
    fresh: bool,
    spectral: bool,
    curves: list[Curves],
    align: bool,
) -> Rows:
    """Compare a scene as `jointwave compare` does, store all results; return a row per misfit."""
    stored = ResultFolder(folder, fresh)
    found = comparison.compare(scene, curves, None, align, spectral, stored)
    if folder is not None:
        write_comparisons([found], folder / scene.name)
    if not found.rows:
        allowed = "has nothing to compare: no pair of solutions applies"
        raise SceneError(scene.where, "", None, allowed)
    rows = [
        {name: nan if x is None else x for name, x in row.facts.items()}
        | {"pair": row.solutions, "faint": str(row.faint).lower()}
        for row in found.rows
    ]
    return rows + [one for name in found.failed for one in _failed(found.reasons[name])]
