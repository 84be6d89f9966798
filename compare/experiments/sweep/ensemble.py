"""Ensembles: members of a scene that differ in the seed of their joints, and their statistics.

Members 1, 2, ... have the scene's own seed, the next one, ...; in a rock mass those of each joint
set. They are points of a sweep, whose key is `member`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.experiments.sweep.axis import MEMBER
from compare.experiments.sweep.case import SweepCase, SweepOutcome
from compare.runs.output import write_dataset
from results.netcdf import load_netcdf

PERCENTILES = (5, 25, 50, 75, 95)
STATISTICS = ("mean", *(f"p{q}" for q in PERCENTILES))
#: Keys of the rows of one statistic, besides the swept keys.
OF_ROW = ("variant", "engine", "one", "other", "quantity", "x", "y")
ENSEMBLE = "ensemble"


def member(scene: AnyScene, number: int) -> dict[str, int]:
    """Return the changes that turn a scene into its member `number`, from 1; raises SceneError if
    its joints are not random."""
    scatter = getattr(scene, "scatter", None)
    seeds = {} if scatter is None else {"scatter.seed": scatter.seed}
    for i, one in enumerate(getattr(scene, "joint_sets", [])):
        if one.seed is not None:
            seeds[f"joint_sets.{i}.seed"] = one.seed
    if not seeds:
        allowed = "needs random joints: [scatter] or joint_sets.*.scatter, with a seed"
        raise SceneError(scene.where, "--ensemble", None, allowed)
    return {key: seed + number - 1 for key, seed in seeds.items()}


def statistics(rows: pd.DataFrame, axes: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return mean and percentiles over the members of each number of the completed rows.

    One row per number: the swept keys, its identification, `number`, STATISTICS, and `members`, the
    number of members that have it.
    """
    keys = [key for key in (*axes, *OF_ROW) if key in rows and key != MEMBER]
    found = []
    for point, group in rows.groupby(keys, sort=False, dropna=False):
        for name in numbers:
            values = group[name].to_numpy(dtype=float)
            values = values[np.isfinite(values)]
            if values.size:
                of = dict(zip(keys, point, strict=True))
                found.append(of | {"number": name, **_of(values), "members": values.size})
    return pd.DataFrame(found)


def _of(values: np.ndarray) -> dict[str, float]:
    every = [values.mean(), *np.percentile(values, PERCENTILES)]
    return dict(zip(STATISTICS, map(float, every), strict=True))


def members_of(
    cases: list[SweepCase], outcomes: list[SweepOutcome], out: Path
) -> dict[Path, list[Path]]:
    """Return the completed results of the members of one scene by one solver, by the file of their
    statistics."""
    found: dict[Path, list[Path]] = {}
    for case, one in zip(cases, outcomes, strict=True):
        rest = ",".join(f"{k}={v}" for k, v in case.settings.items() if k != MEMBER)
        named = (row.get(key) for row in one.rows for key in ("file", "other_file"))
        for path in map(Path, dict.fromkeys(str(file) for file in named if file)):
            within = path.relative_to(case.folder).with_name(f"{path.stem}-{ENSEMBLE}.nc")
            found.setdefault(out / rest / within, []).append(path)
    return found


def waveforms(out: Path, files: list[Path]) -> Path:
    """Write mean and percentiles over the members of every waveform, at the same times and
    receivers in all, with `statistic` as their first dimension; return the file.

    files : the results of the members.
    """
    results = [load_netcdf(file) for file in files]
    first = results[0]
    shared = [name for name in map(str, first.data_vars) if _is_wave(results, name)]
    found = {}
    for name in shared:
        every = np.stack([one[name].values for one in results])
        values = np.concatenate(
            [every.mean(axis=0)[None], np.percentile(every, PERCENTILES, axis=0)]
        )
        found[name] = (("statistic", *first[name].dims), values, first[name].attrs)
    coords: dict[str, Any] = {
        str(name): values.astype(str) if values.dtype == object else values
        for name, values in first.coords.items()
        if values.size
    }
    coords["statistic"] = ("statistic", list(STATISTICS))
    about = {key: first.attrs[key] for key in ("engine", "model") if key in first.attrs}
    data = xr.Dataset(found, coords, {**about, "members": len(results)})
    return write_dataset(out, data)


def _is_wave(results: list[xr.Dataset], name: str) -> bool:
    """Return whether all results record a variable over time, with equal shapes."""
    shape = results[0][name].shape
    recorded = "time" in results[0][name].dims and 0 not in shape
    return recorded and all(name in one and one[name].shape == shape for one in results)
