"""The summary of a sweep; of an ensemble also the statistics over its members."""

import json
from pathlib import Path
from typing import Any

import pandas as pd

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import in_words
from jointwave.compare.figures.style import UNITS
from jointwave.compare.misfit.metrics import Distance
from jointwave.compare.misfit.places import Place
from jointwave.compare.runs.output import write_csv
from jointwave.compare.studies import ensemble
from jointwave.compare.studies.ensemble import MEMBER
from jointwave.compare.studies.experiment import Summary

#: Numbers at a receiver of a run, and of a pair of solutions, by the column that names them.
NUMBERS = {
    "engine": ("peak", "time_of_peak", "steps", "freedoms", "seconds", "energy_residual"),
    "pair": Distance._fields,
}

#: Their headings in a table, where the name alone does not say it.
HEADINGS = {"time_of_peak": "time of peak (s)", "seconds": "stepping (s)", "delay": "delay (s)"}


def summarise(scene: str, keys: list[str], out: Path | None, rows: pd.DataFrame) -> Summary:
    """Return the summary of a sweep's table; write sweep.csv, and of an ensemble its statistics.

    scene : its name. keys : that are swept. out : None writes nothing. Raises SceneError if all
    cases have failed.
    """
    done, failed = rows[rows.state == "done"], rows[rows.state == "failed"]
    if done.empty:
        allowed = f"all {len(failed)} points fail: {failed.message.iloc[0]}"
        raise SceneError(scene, "", None, allowed)
    files = [] if out is None else [write_csv(out / "sweep.csv", rows)]
    facts = {"rows": _records(rows)}
    by = "pair" if "pair" in done else "engine"
    shown, numbers, legend = done, list(NUMBERS[by]), "All numbers are in sweep.csv."
    if MEMBER in keys:
        shown = ensemble.statistics(done, keys, numbers)
        facts["statistics"] = _records(shown)
        if out is not None:
            files += ensemble.write(out, shown, done, keys)
        shown = shown[shown.number == numbers[0]]
        legend = f"{numbers[0]}: mean and percentiles over the members; all are in ensemble.csv."
        numbers = [*ensemble.STATISTICS, "members"]
    elif by == "pair":  # the worst waveform of each
        loud = done[done.faint == "false"].sort_values("misfit")
        shown = loud.drop_duplicates([*keys, "variant", by], keep="last").sort_index()
        legend = f"The worst waveform of each pair. {legend}"
    points = failed.agg(lambda row: ", ".join(f"{key}={row[key]}" for key in keys), axis=1)
    return Summary(
        "sweep",
        scene,
        _display(shown, by, [key for key in keys if key != MEMBER], numbers),
        [],
        [*(points + " " + failed.variant + ": " + failed.message)] if len(failed) else [],
        files,
        facts,
        legend=legend,
    )


def _records(rows: pd.DataFrame) -> Any:
    return json.loads(rows.to_json(orient="records"))


def _display(rows: pd.DataFrame, by: str, keys: list[str], numbers: list[str]) -> pd.DataFrame:
    """Return rows as the table of a summary: solvers, then points and receivers."""
    records = rows.to_dict("records")
    labels = {"": [": ".join(filter(None, [row["variant"], in_words(row[by])])) for row in records]}
    if keys:
        labels[", ".join(keys)] = [", ".join(str(row[key]) for key in keys) for row in records]
    labels["of"] = [_receiver(row) for row in records]
    table = rows[numbers].rename(columns=HEADINGS)
    return table.set_index(pd.MultiIndex.from_arrays([*labels.values()], names=labels))


def _receiver(row: dict[str, Any]) -> str:
    at = tuple(row[name] for name in ("x", "y", "z") if name in row)
    name = row["quantity"]
    unit = f" ({UNITS[name]})" if "peak" in row and name else ""
    return Place(name, "", at).heading + unit if name else ""
