"""The summary of a sweep; for an ensemble also mean and percentiles over its members."""

from math import inf, nan
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import in_words
from jointwave.compare.figures import bands
from jointwave.compare.figures.export import save
from jointwave.compare.figures.style import UNITS
from jointwave.compare.figures.tables import SHOWN
from jointwave.compare.misfit.metrics import Distance
from jointwave.compare.misfit.places import Place
from jointwave.compare.runs.output import write_beside, write_dataset
from jointwave.compare.studies.experiment import Summary
from jointwave.compare.studies.sweep_keys import MEMBER
from jointwave.results.netcdf import load_netcdf

TABLES = ("sweep", "ensemble")
PERCENTILES = (5, 25, 50, 75, 95)
STATISTICS = ("mean", *(f"p{q}" for q in PERCENTILES))
#: Columns that, with the swept keys, identify a row.
OF_ROW = ("variant", "engine", "pair", "one", "other", "quantity", "x", "y", "z")
#: Numbers of a run at a receiver, and of a pair of solutions, by the column that names these.
NUMBERS = {
    "engine": ("peak", "time_of_peak", "steps", "freedoms", "seconds", "energy_residual"),
    "pair": Distance._fields,
}

#: Headings in a table of columns whose name is not enough, and factors.
HEADINGS: dict[str, tuple[str, float]] = {
    "time_of_peak": ("time of peak (s)", 1),
    "seconds": ("stepping (s)", 1),
} | dict(zip(Distance._fields, SHOWN.items(), strict=True))


def summarise(scene: str, keys: list[str], out: Path | None, rows: pd.DataFrame) -> Summary:
    """Return the summary of a sweep's table; write sweep.csv and, for an ensemble, its statistics.

    scene : its name. keys : the swept keys. out : folder, or None. Raises SceneError if all failed.
    """
    done, failed = rows[rows.state == "done"], rows[rows.state == "failed"]
    if done.empty:
        allowed = f"all {len(failed)} points fail: {failed.message.iloc[0]}"
        raise SceneError(scene, "", None, allowed)
    files = [] if out is None else write_beside(out / "sweep.csv", rows)
    facts = {"rows": rows.to_dict("records")}
    by = "pair" if "pair" in done else "engine"
    shown, numbers, legend = done, list(NUMBERS[by]), "All numbers are in sweep.csv."
    if MEMBER in keys:
        shown = statistics(done, keys, numbers)
        facts["statistics"] = shown.to_dict("records")
        if out is not None:
            files += write_ensemble(out, shown, done, keys)
        first, numbers = numbers[0], [*STATISTICS, "members"]
        name, factor = HEADINGS.get(first, (first, 1))
        shown = shown[shown.number == first].assign(
            **{each: factor * shown[each] for each in STATISTICS}
        )
        legend = f"{name}: mean and percentiles over the members; all are in ensemble.csv."
    elif by == "pair":  # keep the worst waveform of each pair
        loud = done[done.faint == "false"].sort_values("misfit")
        shown = loud.drop_duplicates([*keys, "variant", by], keep="last").sort_index()
        legend = f"The worst waveform of each pair. {legend}"
    if kept := [x.name for x in files if x.suffix == ".csv" and x.stem not in TABLES]:
        legend += f" Kept from earlier commands: {', '.join(kept)}."
    points = failed.agg(lambda row: ", ".join(f"{key}={row[key]}" for key in keys), axis=1)
    return Summary(
        "sweep",
        scene,
        _display(shown, by, [key for key in keys if key != MEMBER], numbers),
        [],
        [*((points + " " + failed.variant).str.strip() + ": " + failed.message)]
        if len(failed)
        else [],
        files,
        facts,
        legend=legend,
    )


def _display(rows: pd.DataFrame, by: str, keys: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return rows as the table of a summary, indexed by solver, point and receiver."""
    records = rows.to_dict("records")
    labels = {"": [": ".join(filter(None, [row["variant"], in_words(row[by])])) for row in records]}
    if keys:
        labels[", ".join(keys)] = [", ".join(str(row[key]) for key in keys) for row in records]
    labels["of"] = [_receiver(row) for row in records]
    heads = {name: HEADINGS[name] for name in numbers if name in HEADINGS}
    scaled = {name: factor * rows[name] for name, (_, factor) in heads.items() if factor != 1}
    names = {name: head for name, (head, _) in heads.items()}
    table = rows[numbers].assign(**scaled).rename(columns=names)
    return table.set_index(pd.MultiIndex.from_arrays([*labels.values()], names=labels))


def _receiver(row: dict[str, Any]) -> str:
    at = tuple(row[name] for name in ("x", "y", "z") if name in row)
    name = row["quantity"]
    unit = f" ({UNITS[name]})" if "peak" in row and name else ""
    return Place(name, "", at).heading + unit if name else ""


def statistics(done: pd.DataFrame, keys: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return mean and percentiles over the members of each number of the completed rows; of peaks
    the magnitude, since their sign differs between members.

    One row per number: swept keys, columns OF_ROW, `number`, STATISTICS, and count of `members`.
    """
    same = [key for key in (*keys, *OF_ROW) if key in done and key != MEMBER]
    sizes = {"peak": done["peak"].abs()} if "peak" in numbers else {}
    long = done.assign(**sizes).melt(same, numbers, "number")
    long = long.replace({"value": [inf, -inf]}, nan).dropna(subset="value")
    groups = long.groupby([*same, "number"], sort=False)["value"]
    found = groups.describe([q / 100 for q in PERCENTILES])
    found = found.rename(columns={f"{q}%": f"p{q}" for q in PERCENTILES} | {"count": "members"})
    return found[[*STATISTICS, "members"]].astype({"members": int}).reset_index()


def write_ensemble(
    out: Path, numbers: pd.DataFrame, done: pd.DataFrame, keys: list[str]
) -> list[Path]:
    """Write ensemble.csv, mean and percentiles of every waveform, and their figure.

    numbers : from `statistics`. done : rows of the members, with folders. keys : of the sweep.
    """
    files = write_beside(out / "ensemble.csv", numbers)
    others = [key for key in keys if key != MEMBER]
    for point, rows in done.groupby([*others, "variant"], sort=False):
        folders = [Path(folder) for folder in rows.folder.unique()]
        rest = ",".join(f"{key}={value}" for key, value in zip(others, point, strict=False))
        place = out / rest / point[-1]
        solved = {name for key in ("engine", "one", "other") if key in rows for name in rows[key]}
        results = sorted({file.stem for folder in folders for file in folder.glob("*.nc")})
        found = {
            name: waveforms([f for folder in folders if (f := folder / f"{name}.nc").is_file()])
            for name in results
            if name.removeprefix("exact-") in solved  # others are from earlier commands
        }
        files += [write_dataset(place / f"{name}-ensemble.nc", x) for name, x in found.items()]
        by_solver = {name.removeprefix("exact-"): x for name, x in found.items()}
        if (figure := bands.draw(by_solver)) is not None:
            files += save(figure, place, "ensemble-waveforms", "Waveforms of an ensemble").drawings
    return files


def waveforms(files: list[Path]) -> xr.Dataset:
    """Return mean and percentiles over the members of every waveform, with `statistic` as the first
    dimension. Members have the same times and receivers."""
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
