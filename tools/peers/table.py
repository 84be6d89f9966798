"""The table of points: a row each, what is missing or failed included."""

import os
import platform
from pathlib import Path

import pandas as pd

from compare.experiments.cost.timings import processor
from compare.experiments.summary import cell
from compare.runs.output import write_csv

#: The columns that all studies share, then those of the peers.
COLUMNS = (
    *("curve", "method", "settings", "state", "message", "misfit", "steps", "work", "bytes"),
    *("seconds", "spread", "setup", "compile", "whole"),
    *("solves", "reference", "total_misfit", "freedoms", "rate", "whole_spread", "beside"),
    *("stepping_over_ours", "stepping_over_ours_least", "stepping_over_ours_most"),
    *("whole_over_ours", "whole_over_ours_least", "whole_over_ours_most", "machine"),
)


def missing_row(curve: str, solves: str, reason: str) -> dict:
    """Return the row of a peer that cannot be had."""
    return {"curve": curve, "solves": solves, "state": "missing", "message": reason}


def write(path: Path, rows: list[dict]) -> Path:
    """Write the rows as CSV; a value that a row does not have stays empty."""
    cells = [{key: cell(value) for key, value in row.items()} for row in rows]
    return write_csv(path, pd.DataFrame(cells, columns=list(COLUMNS)))


def show(rows: list[dict]) -> None:
    """Print the rows, and below each what its curve solves."""
    print(
        f"{'':28s} {'misfit':>9s} {'total':>9s} {'freedom-':>10s} {'stepping':>10s} {'whole':>8s}"
    )
    print(
        f"{'':28s} {'own model':>9s} {'finest':>9s} {'steps/s':>10s} {'s':>10s} {'s':>8s}"
        "  over ours: stepping, whole process"
    )
    curve = None
    for row in rows:
        if row["curve"] != curve:
            curve = row["curve"]
            print(f"{curve}: {row['solves']}")
        print(f"  {_line(row)}", flush=True)


def machine() -> str:
    """Return what the seconds were taken on."""
    load = f", load {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    return f"{processor()}, {os.cpu_count()} cores, one used{load}, {platform.platform()}"


def _line(row: dict) -> str:
    if row["state"] == "missing":
        return f"missing: {row['message']}"
    point = ", ".join(f"{key} {value}" for key, value in row["settings"].items())
    if row["state"] == "failed":
        return f"{point}: failed: {row['message']}"
    return (
        f"{point:26s} {row['misfit']:9.2e} {row['total_misfit']:9.2e} {row['rate']:10.2e} "
        f"{row['seconds']:10.4f} {row['whole']:8.2f}  {_over(row, 'stepping')}{_over(row, 'whole')}"
    ).rstrip()


def _over(row: dict, name: str) -> str:
    key = f"{name}_over_ours"
    if key not in row:
        return ""
    return f"{row[key]:7.3g} ({row[f'{key}_least']:.3g} to {row[f'{key}_most']:.3g})"
