"""Sweeps: a scene run or compared at every value of some keys, as one table and on a grid.

Each point has a folder named by its values, with the files that the command writes without
`--sweep`. An ensemble is a sweep of the seed of random joints, see `compare.studies.ensemble`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import product
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import joblib
import numpy as np
import xarray as xr

from jointwave.cases.errors import InterruptedRun, SceneError
from jointwave.cases.read import parse_override
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress, applies, names
from jointwave.compare.figures.comparison import write_comparisons
from jointwave.compare.misfit.external import Curves
from jointwave.compare.misfit.places import Place, places_of
from jointwave.compare.runs import comparison
from jointwave.compare.runs.jobs import plan
from jointwave.compare.runs.output import write_dataset
from jointwave.compare.runs.run import Done, execute
from jointwave.compare.scenes import find, load, load_variant
from jointwave.compare.studies import ensemble, store
from jointwave.compare.studies.ensemble import MEMBER
from jointwave.compare.studies.store import DIED, FAILURES, Pool, Store
from jointwave.compare.studies.sweep_keys import axes
from jointwave.results.dataset import scene_hash
from jointwave.results.netcdf import load_netcdf

LONGEST = 100  # characters of a folder's name
PEAKS = ("stress", "velocity", "traction")
Rows = list[dict[str, Any]]


class Running(NamedTuple):
    """Run a point as `jointwave run` does. runs : (engine, model) each, see `compare.runs.jobs`."""

    runs: list[tuple[str, str | None]]

    def solvers(self, scene: AnyScene) -> list[str]:
        """Return the names of a scene's solvers."""
        return [job.name for job in plan([scene], self.runs, Path())]

    def __call__(self, scene: AnyScene, folder: Path) -> Rows:
        """Write the results of a scene into a folder and return a row for each receiver of each."""
        done = execute(plan([scene], self.runs, folder), lambda fraction: None)
        return [row for one in done for row in _rows_of_run(one)]


class Comparing(NamedTuple):
    """Compare a point as `jointwave compare` does. writes : also figure, curves and distances.
    keeps : also the results."""

    spectral: bool
    curves: list[Curves]
    align: bool
    writes: bool
    keeps: bool = False

    def solvers(self, scene: AnyScene) -> list[str]:
        """Return the names of a scene's solvers."""
        return [name for name in names() if applies(name, scene)]

    def __call__(self, scene: AnyScene, folder: Path) -> Rows:
        """Return a row for each distance."""
        found = comparison.compare(scene, None, self.spectral, self.curves, self.align)
        if self.writes:
            write_comparisons([found], folder / scene.name)
        for name, result in found.results.items() if self.keeps else ():
            write_dataset(folder / scene.name / f"{name}.nc", result)
        if not found.rows:
            allowed = "has nothing to compare: no pair of solutions applies"
            raise SceneError(scene.where, "", None, allowed)
        rows = (row.facts | {"faint": str(row.faint).lower()} for row in found.rows)
        return [{name: nan if x is None else x for name, x in row.items()} for row in rows]


Work = Running | Comparing


class SweepCase(NamedTuple):
    """A scene with its swept keys set; None if it is invalid, for the reason in `message`.

    folder : for its files; variants have their own in it.
    """

    settings: dict[str, Any]
    folder: Path
    scene: AnyScene | None
    message: str = ""


class SweepOutcome(NamedTuple):
    """The rows of a case; without rows why it has failed."""

    message: str
    rows: Rows


class Sweep(NamedTuple):
    """A sweep of a scene.

    scene : its name. axes : the values by swept key. cases : all variants at every point. out : the
    folder; None writes nothing.
    """

    scene: str
    axes: dict[str, list[Any]]
    cases: list[SweepCase]
    out: Path | None

    @property
    def scenes(self) -> list[AnyScene]:
        """The scenes of all cases that have one."""
        return [case.scene for case in self.cases if case.scene is not None]

    def runs(self, work: Work) -> tuple[list[tuple[str, AnyScene, str]], dict[str, str]]:
        """Return the point, scene and solver of every run, and why points have no valid scene."""
        runs: list[tuple[str, AnyScene, str]] = []
        failing = {}
        for case in self.cases:
            point = point_of(case.settings)
            if case.scene is None:
                failing[point] = case.message
            else:
                runs += [(point, case.scene, name) for name in work.solvers(case.scene)]
        return runs, failing


def sweep_of(
    scene: str,
    changes: list[str],
    variant: str | None,
    given: list[str],
    out: Path | None,
    members: int = 0,
) -> Sweep:
    """Return the sweep of `--set`, `--variant`, `--sweep` and `--ensemble`; raises SceneError in
    one line, also if no point has a valid scene."""
    fixed = dict(map(parse_override, changes))
    values = axes(given, list(fixed)) | ({MEMBER: [*range(1, members + 1)]} if members else {})
    path, found, errors = find(scene), [], []
    for i, combination in enumerate(product(*values.values())):
        setting = dict(zip(values, combination, strict=True))
        folder = (out or Path()) / _folder(setting, i)
        try:
            scenes = _scenes(path, variant, {**fixed, **setting})
        except SceneError as error:
            errors.append(error)
            found.append(SweepCase(setting, folder, None, str(error)))
        else:
            found += [SweepCase(setting, folder, one) for one in scenes]
    if errors and len(errors) == len(found):
        raise errors[0]
    return Sweep(scene, values, found, out)


def _scenes(path: Path, variant: str | None, changes: dict[str, Any]) -> list[AnyScene]:
    if (number := changes.pop(MEMBER, 0)) > 0:
        changes |= ensemble.seeds(load_variant(path, variant or "", changes), number)
    return load(path, changes) if variant is None else [load_variant(path, variant, changes)]


def _folder(setting: dict[str, Any], number: int) -> str:
    """Return the name of a point's folder: its values, or its number if they are no valid name."""
    name = ",".join(f"{k}={v}" for k, v in setting.items())
    single = not any(isinstance(value, list | dict) for value in setting.values())
    plain = name.isprintable() and not set(name) & set("/\\") and len(name.encode()) <= LONGEST
    return name if plain and single else f"point-{number + 1:05d}"


def run(
    asked: Sweep, work: Work, pool: Pool | None = None, progress: Progress | None = None
) -> list[SweepOutcome]:
    """Return the outcomes of all cases, in order; completed ones are read from its folder, if their
    files are still there."""

    def has_files(found: SweepOutcome) -> bool:
        return all(Path(str(row["file"])).is_file() for row in found.rows if "file" in row)

    folder = asked.out and asked.out / "points"
    outcomes: Store[SweepOutcome] = Store(SweepOutcome, folder, has_files)
    about, lost = partial(_key, work=work), SweepOutcome(DIED, [])
    outcome = partial(_outcome, work=work)
    return outcomes.compute(asked.cases, about, outcome, pool, progress, lost=lambda case: lost)


def _key(case: SweepCase, work: Work) -> str:
    scene = case.message if case.scene is None else [case.scene.name, scene_hash(case.scene)]
    return store.key(str(case.folder), scene, joblib.hash(work))


def _outcome(case: SweepCase, work: Work) -> SweepOutcome:
    if case.scene is None:
        return SweepOutcome(case.message, [])
    try:
        return SweepOutcome("", work(case.scene, case.folder))
    except InterruptedRun:
        raise
    except (*FAILURES, MemoryError) as error:
        return SweepOutcome(str(error) or "not enough memory", [])


def _rows_of_run(done: Done) -> Rows:
    """Return a row for each receiver of a result, with the peak there."""
    result = load_netcdf(done.job.path)
    about = {
        "engine": done.job.name,
        "steps": done.steps,
        "freedoms": float(result.attrs.get("degrees_of_freedom", nan)),
        "seconds": done.seconds,
        "energy_residual": nan if done.residual is None else done.residual,
        "file": str(done.job.path),
    }
    peaks = [peak for quantity in PEAKS if quantity in result for peak in _peaks(result, quantity)]
    nowhere = {"quantity": "", "y": nan, "peak": nan, "time_of_peak": nan}
    return [about | peak for peak in peaks or [nowhere]]


def _peaks(result: xr.Dataset, quantity: str) -> Iterator[dict[str, Any]]:
    """Yield the value of largest magnitude at each receiver, with its sign and time (SI).

    For several components the norm, without sign: the speed for a velocity in space.
    """
    for at, wave in zip(places_of(result, quantity)[0], result[quantity].values, strict=True):
        in_space = wave.ndim == 2 and wave.shape[1] > 1
        values = np.linalg.norm(wave, axis=1) if in_space else wave.ravel()
        k = int(np.argmax(np.abs(values)))
        where = {"quantity": quantity, **Place(quantity, "", at).coordinates}
        yield where | {"peak": float(values[k]), "time_of_peak": float(result.time[k])}


def point_of(setting: Any) -> str:
    """Return the keys of a point with their values."""
    return ", ".join(f"{key}={value}" for key, value in setting.items())
