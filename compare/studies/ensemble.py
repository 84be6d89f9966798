"""Ensembles: members of a scene that differ in the seed of their joints, and their statistics.

Members 1, 2, ... have the scene's own seed, the next one, ...; in a rock mass those of each joint
set. They are points of a sweep, whose key is `member`.
"""

from math import inf, nan
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.figures import bands
from jointwave.compare.figures.export import save
from jointwave.compare.runs.output import write_csv, write_dataset
from jointwave.results.netcdf import load_netcdf

MEMBER = "member"  # the key
PERCENTILES = (5, 25, 50, 75, 95)
STATISTICS = ("mean", *(f"p{q}" for q in PERCENTILES))
#: What identifies the numbers of a row, besides the swept keys.
OF_ROW = ("variant", "engine", "pair", "one", "other", "quantity", "x", "y", "z")


def seeds(scene: AnyScene, number: int) -> dict[str, int]:
    """Return the changes that turn a scene into its member `number`, from 1; raises SceneError if
    its joints are not random."""
    scatter = getattr(scene, "scatter", None)
    found = {} if scatter is None else {"scatter.seed": scatter.seed}
    for i, one in enumerate(getattr(scene, "joint_sets", [])):
        if one.seed is not None:
            found[f"joint_sets.{i}.seed"] = one.seed
    if not found:
        allowed = "needs random joints: [scatter] or joint_sets.*.scatter, with a seed"
        raise SceneError(scene.where, "--ensemble", None, allowed)
    return {key: seed + number - 1 for key, seed in found.items()}


def statistics(done: pd.DataFrame, keys: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return mean and percentiles over the members of each number of the completed rows.

    One row per number: the swept keys, its identification, `number`, STATISTICS, and `members`, the
    number of members that have it.
    """
    same = [key for key in (*keys, *OF_ROW) if key in done and key != MEMBER]
    long = done.melt(same, numbers, "number")
    long = long.replace({"value": [inf, -inf]}, nan).dropna(subset="value")
    groups = long.groupby([*same, "number"], sort=False)["value"]
    found = groups.describe([q / 100 for q in PERCENTILES])
    found = found.rename(columns={f"{q}%": f"p{q}" for q in PERCENTILES} | {"count": "members"})
    return found[[*STATISTICS, "members"]].astype({"members": int}).reset_index()


def write(out: Path, numbers: pd.DataFrame, done: pd.DataFrame, keys: list[str]) -> list[Path]:
    """Write ensemble.csv, and mean and percentiles of every waveform, with their figure.

    numbers : from `statistics`. done : rows of the members, with the folder of their results. keys
    : of the sweep.
    """
    files = [write_csv(out / "ensemble.csv", numbers)]
    others = [key for key in keys if key != MEMBER]
    for point, rows in done.groupby([*others, "variant"], sort=False):
        folders = [Path(folder) for folder in rows.folder.unique()]
        rest = ",".join(f"{key}={value}" for key, value in zip(others, point, strict=False))
        place = out / rest / point[-1]
        results = sorted({file.stem for folder in folders for file in folder.glob("*.nc")})
        found = {
            name: waveforms([f for folder in folders if (f := folder / f"{name}.nc").is_file()])
            for name in results
            if "." not in name  # as in NAME.stopped.nc, of a run that was interrupted
        }
        files += [write_dataset(place / f"{name}-ensemble.nc", x) for name, x in found.items()]
        by_solver = {name.removeprefix("exact-"): x for name, x in found.items()}
        if (figure := bands.draw(by_solver)) is not None:
            files += save(figure, place, "ensemble-waveforms", "Waveforms of an ensemble").drawings
    return files


def waveforms(files: list[Path]) -> xr.Dataset:
    """Return mean and percentiles over the members of every waveform, at the same times and
    receivers in all, with `statistic` as their first dimension."""
    results = [load_netcdf(file).drop_encoding() for file in files]
    first = results[0]
    same = [
        name
        for name, one in first.data_vars.items()
        if "time" in one.dims
        and one.size
        and all(name in other and other[name].shape == one.shape for other in results)
    ]
    same_grid: dict[str, Any] = {"join": "override", "coords": "minimal", "compat": "override"}
    members = xr.concat([one[same] for one in results], MEMBER, **same_grid)
    quantiles = members.quantile([q / 100 for q in PERCENTILES], MEMBER, keep_attrs=True)
    quantiles = quantiles.drop_vars("quantile").rename(quantile="statistic")
    found = [members.mean(MEMBER, keep_attrs=True), quantiles]
    about = {key: first.attrs[key] for key in ("engine", "model") if key in first.attrs}
    both = xr.concat(found, "statistic").assign_coords(statistic=list(STATISTICS))
    return both.transpose("statistic", ...).assign_attrs(about, members=len(results))
