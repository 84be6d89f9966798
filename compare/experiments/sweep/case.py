"""A case of a sweep: one variant at one point, and its runs or its comparison."""

from __future__ import annotations

from hashlib import sha256
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from cases.errors import InterruptedRun, SceneError, UnstableError
from cases.kinds import AnyScene
from compare.misfit.external import Curves
from compare.misfit.places import Place, places_of
from compare.studies import store
from results.dataset import scene_hash

Rows = list[dict[str, Any]]
PEAKS = ("stress", "velocity", "traction")


class SweepCase(NamedTuple):
    """A scene with its swept keys set. folder : for its files; variants have their own in it.

    scene : None if it is invalid, for the reason in `message`.
    """

    settings: dict[str, Any]
    folder: Path
    scene: AnyScene | None
    message: str = ""

    @property
    def variant(self) -> str:
        """The variant's name."""
        return "" if self.scene is None else self.scene.name


class SweepOutcome(NamedTuple):
    """The outcome of a case: "done" with its rows, or "failed" with the reason."""

    state: str
    message: str
    rows: Rows


class Running(NamedTuple):
    """Run a case as `jointwave run` does. runs : (engine, model) each, see `compare.runs.jobs`."""

    runs: list[tuple[str, str | None]]
    vtx: bool

    @property
    def about(self) -> list[Any]:
        """Everything besides the scene that determines a row."""
        return [self.runs, self.vtx]

    def solvers(self, scene: AnyScene) -> list[str]:
        """Return the names of a scene's solvers."""
        from compare.runs import jobs

        return [job.name for job in jobs.plan([scene], self.runs, Path())]

    def __call__(self, scene: AnyScene, folder: Path) -> Rows:
        """Write the results of a scene into a folder and return a row for each receiver of each."""
        from compare.runs import jobs
        from compare.runs import run as runs

        done = runs.execute(jobs.plan([scene], self.runs, folder), _silent, self.vtx)
        return [row for one in done for row in _of_run(one)]


class Comparing(NamedTuple):
    """Compare a case as `jointwave compare` does. writes : also figure, curves and distances.
    keeps : also the results, if it writes."""

    spectral: bool
    curves: list[Curves]
    align: bool
    writes: bool
    keeps: bool = False

    @property
    def about(self) -> list[Any]:
        """Everything besides the scene that determines a row, including samples of curves."""
        named = [[c.file, c.name, c.variant, list(map(str, c.waveforms))] for c in self.curves]
        samples = [
            sha256(np.asarray(values).tobytes()).hexdigest()
            for curve in self.curves
            for values in (curve.time, *curve.waveforms.values())
        ]
        return [self.spectral, self.align, self.writes, self.keeps, named, samples]

    def solvers(self, scene: AnyScene) -> list[str]:
        """Return the names of a scene's solvers."""
        from compare.engines import applies, names

        return [name for name in names() if applies(name, scene)]

    def __call__(self, scene: AnyScene, folder: Path) -> Rows:
        """Return a row for each distance."""
        from compare.misfit import pairs

        found = pairs.compare(scene, None, self.spectral, self.curves, self.align)
        if self.writes:
            from compare.figures.comparison import write_comparisons

            write_comparisons([found], folder / scene.name)
        if not found.rows:
            allowed = "has nothing to compare: no pair of solutions applies"
            raise SceneError(scene.where, "", None, allowed)
        files = self._kept(found.results, folder / scene.name)
        rows = [row.facts | {"faint": str(row.faint).lower()} for row in found.rows]
        for row in rows:
            both = {"file": files.get(row["one"]), "other_file": files.get(row["other"])}
            row |= {key: file for key, file in both.items() if file is not None}
        return [{k: v if isinstance(v, str) else _real(v) for k, v in row.items()} for row in rows]

    def _kept(self, results: dict[str, xr.Dataset], folder: Path) -> dict[str, str]:
        """Write results if they are to be kept; return their files by name."""
        if not (self.keeps and self.writes):
            return {}
        from compare.runs.output import write_dataset

        return {
            name: str(write_dataset(folder / f"{name}.nc", result))
            for name, result in results.items()
        }


Work = Running | Comparing


def outcome(case: SweepCase, work: Work) -> SweepOutcome:
    """Return the outcome of a case; for one that cannot be solved, the reason."""
    if case.scene is None:
        return SweepOutcome("failed", case.message, [])
    try:
        return SweepOutcome("done", "", work(case.scene, case.folder))
    except InterruptedRun:
        raise
    except (SceneError, UnstableError, MemoryError) as error:
        return SweepOutcome("failed", str(error) or "not enough memory", [])


def key(case: SweepCase, work: Work) -> str:
    """Return the key of a case: everything that determines its rows."""
    scene = case.message if case.scene is None else scene_hash(case.scene)
    return store.key(str(case.folder), case.variant, scene, type(work).__name__, work.about)


def _of_run(done: Any) -> Rows:
    """Return a row for each receiver of a result, with the peak there."""
    from results.netcdf import load_netcdf

    result = load_netcdf(done.job.path)
    about = {
        "engine": done.job.name,
        "steps": int(done.steps),
        "freedoms": float(result.attrs.get("degrees_of_freedom", nan)),
        "seconds": float(done.seconds),
        "energy_residual": _real(done.residual),
        "file": str(done.job.path),
    }
    peaks = [peak for quantity in PEAKS for peak in _peaks(result, quantity)]
    nowhere = {"quantity": "", "y": nan, "peak": nan, "time_of_peak": nan}
    return [about | peak for peak in peaks or [nowhere]]


def _real(value: float | None) -> float:
    return nan if value is None else float(value)


def _peaks(result: xr.Dataset, quantity: str) -> Rows:
    """Return the value of largest magnitude at each receiver, with its sign and time (SI).

    For several components the norm, without sign: the speed for a velocity in space.
    """
    rows = []
    places = places_of(result, quantity)[0] if quantity in result else []
    for i, at in enumerate(places):
        wave = result[quantity].values[i]
        in_space = wave.ndim == 2 and wave.shape[1] > 1
        values = np.linalg.norm(wave, axis=1) if in_space else wave.ravel()
        k = int(np.argmax(np.abs(values)))
        where = {"quantity": quantity, **Place(quantity, "", at).coordinates}
        rows.append(where | {"peak": float(values[k]), "time_of_peak": float(result.time[k])})
    return rows


def _silent(fraction: float) -> None:
    """Ignore progress: the sweep reports whole cases."""
