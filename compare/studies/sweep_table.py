"""The table of a sweep, one row for each receiver of each run or pair, on a grid as well.

Of an ensemble also the statistics over its members.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.compare.misfit.metrics import Distance
from jointwave.compare.misfit.places import Place
from jointwave.compare.studies import ensemble
from jointwave.compare.studies.ensemble import MEMBER
from jointwave.compare.studies.summary import Summary, cell, write_tables
from jointwave.compare.studies.sweep import Rows, Sweep, SweepOutcome, point_of

UNITS = {"x": "m", "y": "m", "time_of_peak": "s", "seconds": "s", "delay": "s"}
#: Numbers of a run at a receiver, and of a pair of solutions at a receiver.
OF_RUNS = ("peak", "time_of_peak", "steps", "freedoms", "seconds", "energy_residual")
OF_PAIRS = Distance._fields


def table(asked: Sweep, found: list[SweepOutcome]) -> pd.DataFrame:
    """Return one row for each receiver of each run or pair, or for each case that failed; SI."""
    rows: Rows = []
    for case, one in zip(asked.cases, found, strict=True):
        about = {key: cell(value) for key, value in case.settings.items()}
        about |= {"variant": "" if case.scene is None else case.scene.name}
        about |= {"state": "done" if one.rows else "failed", "message": one.message}
        rows += [about | row for row in one.rows or [{}]]
    return pd.DataFrame(rows)


def summarise(asked: Sweep, found: list[SweepOutcome]) -> Summary:
    """Return the summary of a sweep; write sweep.csv and sweep.nc, of an ensemble its statistics.

    Raises SceneError if all cases have failed.
    """
    if not any(one.rows for one in found):
        allowed = f"all {len(found)} points fail: {found[0].message}"
        raise SceneError(asked.scene, "", None, allowed)
    rows, keys = table(asked, found), list(asked.axes)
    done, failed = rows[rows.state == "done"], rows[rows.state == "failed"]
    files: list[Path] = []
    if asked.out is not None:
        data = grid(asked.axes, done).assign_attrs(scene=asked.scene)
        files = write_tables(asked.out, "sweep", rows, data)
    facts = {"rows": json.loads(rows.to_json(orient="records"))}
    shown, legend = done, "SI units; all numbers are in sweep.csv."
    numbers = list(OF_PAIRS if "one" in done else OF_RUNS)
    if MEMBER in keys:
        shown = ensemble.statistics(done, keys, numbers)
        facts["statistics"] = json.loads(shown.to_json(orient="records"))
        files += ensemble.write(asked.out, shown, _members(asked, found)) if asked.out else []
        shown = shown[shown.number == numbers[0]]
        legend = f"{numbers[0]}: mean and percentiles over the members; all are in ensemble.csv."
        keys, numbers = [key for key in keys if key != MEMBER], [*ensemble.STATISTICS, "members"]
    elif "one" in done:  # the worst waveform of each pair
        loud = done[done.faint == "false"].sort_values("misfit")
        shown = loud.drop_duplicates([*keys, "variant", "one", "other"], keep="last").sort_index()
        legend = f"The worst waveform of each pair. {legend}"
    return Summary(
        "sweep",
        asked.scene,
        _display(shown, keys, numbers),
        [],
        [f"{point_of(row[keys])} {row.variant}: {row.message}" for _, row in failed.iterrows()],
        files,
        facts | {"files": list(map(str, files))},
        legend=legend,
    )


def _members(asked: Sweep, found: list[SweepOutcome]) -> Iterator[tuple[Path, Path]]:
    """Yield every written result of the members, after the folder for its statistics."""
    for case, one in zip(asked.cases, found, strict=True):
        if case.scene is None or asked.out is None:
            continue
        rest = ",".join(f"{k}={v}" for k, v in case.settings.items() if k != MEMBER)
        names = {row[key] for row in one.rows for key in ("one", "other") if key in row}
        compared = {str(case.folder / case.scene.name / f"{name}.nc") for name in names}
        for file in sorted({row.get("file", "") for row in one.rows} | compared):
            if Path(file).is_file():
                yield asked.out / rest / case.scene.name, Path(file)


def _display(rows: pd.DataFrame, keys: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return rows as the table of a summary: solvers, then points and receivers."""
    solvers = rows["one"] + " ~ " + rows["other"] if "one" in rows else rows["engine"]
    records = rows.to_dict("records")
    labels = {
        "": [": ".join(filter(None, pair)) for pair in zip(rows.variant, solvers, strict=True)],
        ", ".join(keys): [", ".join(str(row[key]) for key in keys) for row in records],
        "of": [_place(row) for row in records],
    }
    return rows[numbers].set_index(pd.MultiIndex.from_arrays([*labels.values()], names=labels))


def grid(axes: dict[str, list[Any]], done: pd.DataFrame) -> xr.Dataset:
    """Return rows on the grid of swept keys, variants, solvers and receivers; nan if missing."""
    solvers, numbers = ["engine"], OF_RUNS
    if "one" in done:
        solvers, numbers = ["pair"], OF_PAIRS
        done = done.assign(pair=done["one"] + " ~ " + done["other"])
    at = [name for name in ("x", "y") if name in done]
    rows = done.set_index([*axes, "variant", *solvers, "quantity", *at])
    found = rows[list(numbers)].astype(float).to_xarray()
    found = found.reindex({key: list(map(cell, values)) for key, values in axes.items()})
    for name in UNITS.keys() & found.variables.keys():
        found[name].attrs["units"] = UNITS[name]
    return found


def _place(row: dict[str, Any]) -> str:
    at = tuple(row[name] for name in ("x", "y") if name in row)
    return Place(row["quantity"], "", at).heading if row["quantity"] else ""
