"""What a sweep has found, on the terminal."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd

from compare.cli.terminal import print_json, say, show_numbers
from compare.experiments.sweep.axis import Axis

#: Columns of runs and of comparisons: name, heading, and how a number is shown.
OF_RUNS = (
    ("peak", "peak, SI", ".4g"),
    ("time_of_peak", "at, s", ".4g"),
    ("steps", "steps", ",.0f"),
    ("seconds", "stepping, s", ".2g"),
    ("energy_residual", "energy residual", ".1e"),
)
OF_PAIRS = (
    ("misfit", "misfit", ".3%"),
    ("peak_ratio", "peak", ".4f"),
    ("delay", "delay, s", "+.2e"),
    ("envelope", "envelope", ".2%"),
    ("phase", "phase", ".2%"),
)


def show_sweep(axes: list[Axis], table: pd.DataFrame, files: list[Path], as_json: bool) -> None:
    """Print a row for each value under what it is of, and what failed."""
    if as_json:
        rows = json.loads(table.to_json(orient="records"))
        print_json({"rows": rows, "files": [str(file) for file in files]})
        return
    done = table[table.state == "done"]
    columns = OF_PAIRS if "one" in table else OF_RUNS
    groups: dict[str, list[list[str]]] = {}
    for row in done.to_dict("records"):
        numbers = [_number(row[name], form) for name, _, form in columns]
        groups.setdefault(_heading(row), []).append([_point(axes, row), *numbers])
    if groups:
        show_numbers([", ".join(a.key for a in axes), *(head for _, head, _ in columns)], groups)
    for row in table[table.state == "failed"].to_dict("records"):
        say(f"failed: {_point(axes, row)} {row['variant']}: {row['message']}", "red")
    if files:
        say(f"written: {', '.join(map(str, files))}")


def _heading(row: dict[str, Any]) -> str:
    what = f"{row['one']} ~ {row['other']}" if "one" in row else row["engine"]
    place = f", {row['quantity']} at y = {row['y']:g} m" if row["quantity"] else ""
    return f"{row['variant']}: {what}{place}" if row["variant"] else f"{what}{place}"


def _point(axes: list[Axis], row: dict[str, Any]) -> str:
    values = (row[axis.key] for axis in axes)
    return ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in values)


def _number(value: Any, form: str) -> str:
    return "-" if pd.isna(value) else format(value, form)
