"""The table of a sweep, one row for each receiver of each run or pair.

Of an ensemble also the statistics over its members.
"""

import json
from pathlib import Path
from typing import Any

import pandas as pd

from jointwave.cases.errors import SceneError
from jointwave.compare.misfit.metrics import Distance
from jointwave.compare.misfit.places import Place
from jointwave.compare.runs.output import write_csv
from jointwave.compare.studies import ensemble
from jointwave.compare.studies.ensemble import MEMBER
from jointwave.compare.studies.summary import Summary, cell
from jointwave.compare.studies.sweep import Rows, Sweep

#: Numbers at a receiver of a run, and of a pair of solutions, by the column that names them.
NUMBERS = {
    "engine": ("peak", "time_of_peak", "steps", "freedoms", "seconds", "energy_residual"),
    "pair": Distance._fields,
}


def table(asked: Sweep, found: list[Rows]) -> pd.DataFrame:
    """Return one row for each receiver of each run or pair, or for each case that failed; SI."""
    rows = pd.DataFrame(
        {key: cell(value) for key, value in case.settings.items()}
        | {"variant": case.scene.name if case.scene else ""}
        | row
        for case, some in zip(asked.cases, found, strict=True)
        for row in some
    )
    return rows.assign(pair=rows["one"] + " ~ " + rows["other"]) if "one" in rows else rows


def summarise(asked: Sweep, found: list[Rows]) -> Summary:
    """Return the summary of a sweep; write sweep.csv, and of an ensemble its statistics.

    Raises SceneError if all cases have failed.
    """
    rows, keys = table(asked, found), list(asked.axes)
    done, failed = rows[rows.state == "done"], rows[rows.state == "failed"]
    if done.empty:
        allowed = f"all {len(found)} points fail: {failed.message.iloc[0]}"
        raise SceneError(asked.scene, "", None, allowed)
    files: list[Path] = []
    if asked.out is not None:
        files.append(write_csv(asked.out / "sweep.csv", rows))
    facts = {"rows": json.loads(rows.to_json(orient="records"))}
    by = "pair" if "pair" in done else "engine"
    shown, numbers, legend = done, list(NUMBERS[by]), "SI units; all numbers are in sweep.csv."
    if MEMBER in keys:
        shown = ensemble.statistics(done, keys, numbers)
        facts["statistics"] = json.loads(shown.to_json(orient="records"))
        if asked.out is not None:
            files += ensemble.write(asked.out, shown, _members(asked, found))
        shown = shown[shown.number == numbers[0]]
        legend = f"{numbers[0]}: mean and percentiles over the members; all are in ensemble.csv."
        keys, numbers = [key for key in keys if key != MEMBER], [*ensemble.STATISTICS, "members"]
    elif by == "pair":  # the worst waveform of each
        loud = done[done.faint == "false"].sort_values("misfit")
        shown = loud.drop_duplicates([*keys, "variant", by], keep="last").sort_index()
        legend = f"The worst waveform of each pair. {legend}"
    return Summary(
        "sweep",
        asked.scene,
        _display(shown, by, keys, numbers),
        [],
        [
            f"{case.point} {case.scene.name if case.scene else ''}: {some[0]['message']}"
            for case, some in zip(asked.cases, found, strict=True)
            if some[0]["state"] == "failed"
        ],
        files,
        facts | {"files": list(map(str, files))},
        legend=legend,
    )


def _members(asked: Sweep, found: list[Rows]) -> dict[Path, list[Path]]:
    """Return the folders with results of the members that are done, by the folder for the
    statistics of all members at the same point."""
    folders: dict[Path, list[Path]] = {}
    for case, some in zip(asked.cases, found, strict=True):
        if case.scene and case.folder and asked.out and some[0]["state"] == "done":
            rest = ",".join(f"{k}={v}" for k, v in case.settings.items() if k != MEMBER)
            place = asked.out / rest / case.scene.name
            folders.setdefault(place, []).append(case.folder / case.scene.name)
    return folders


def _display(rows: pd.DataFrame, by: str, keys: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return rows as the table of a summary: solvers, then points and receivers."""
    records = rows.to_dict("records")
    labels = {
        "": [": ".join(filter(None, [row["variant"], row[by]])) for row in records],
        ", ".join(keys): [", ".join(str(row[key]) for key in keys) for row in records],
        "of": [_place(row) for row in records],
    }
    return rows[numbers].set_index(pd.MultiIndex.from_arrays([*labels.values()], names=labels))


def _place(row: dict[str, Any]) -> str:
    at = tuple(row[name] for name in ("x", "y") if name in row)
    return Place(row["quantity"], "", at).heading if row["quantity"] else ""
