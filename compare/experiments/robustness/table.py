"""The battery as a table, for the terminal and the page, and as CSV."""

from __future__ import annotations

import json
from math import isinf, isnan
from pathlib import Path

import pandas as pd

from compare.experiments.robustness.map import StabilityMap
from compare.experiments.robustness.row import FAILED, HELD, NONE, Row
from compare.report.tables import Table
from compare.runs.output import write_csv

HEADER = ["engine and scheme", "value", "bound", "margin", ""]


def table(rows: list[Row]) -> Table:
    """Return the rows under headings of case and criterion."""
    groups: dict[str, list[list[str]]] = {}
    for row in rows:
        groups.setdefault(f"{row.case}: {row.criterion}", []).append(_cells(row))
    return Table(HEADER, groups)


def _cells(row: Row) -> list[str]:
    name = f"{row.engine}, {row.scheme}"
    if row.state == NONE:
        return [name, "", "", "", f"{NONE}: {row.message}"]
    said = row.message if row.state == HELD else f"failed: {row.message}"
    return [name, _number(row.value), _number(row.bound), _margin(row.margin), said]


def _number(x: float) -> str:
    return "" if isnan(x) else f"{x:.3g}"


def _margin(x: float) -> str:
    if isinf(x):
        return "all"  # the value is zero
    return "" if isnan(x) else f"{x:.3g}"


def summary(rows: list[Row]) -> list[str]:
    """Return what the battery has found, in sentences."""
    held, failed, none = (
        [row for row in rows if row.state == state] for state in (HELD, FAILED, NONE)
    )
    found = [
        f"{len(held)} of {len(held) + len(failed)} rows hold; {len(none)} do not apply, each with "
        "its reason."
    ]
    tight = [row for row in held if row.margin < float("inf")]
    if tight:
        least = min(tight, key=lambda row: row.margin)
        found.append(
            f"The least margin is {least.margin:.3g}: {least.case}, {least.engine}, {least.scheme}."
        )
    return found


def failures(rows: list[Row]) -> list[str]:
    """Return a line for each row that does not hold."""
    return [
        f"{row.case}, {row.engine}, {row.scheme}: {row.criterion}: {row.value:.3g} above "
        f"{row.bound:.3g} {row.message}".rstrip()
        for row in rows
        if row.state == FAILED
    ]


def map_sentences(maps: list[StabilityMap]) -> list[str]:
    """Return how many cells of each map are not what theory says of them."""
    return [
        f"{m.engine}: {m.stable.size:,} cells, {int(m.wrong.sum())} on the wrong side of the line, "
        f"{int(m.far.sum())} of them beyond one cell of it."
        for m in maps
    ]


def write_rows(path: Path, rows: list[Row]) -> Path:
    """Write the rows as CSV; changes of the scene as JSON."""
    frame = pd.DataFrame(rows, columns=list(Row._fields))
    frame = frame.assign(changes=[json.dumps(row.changes) for row in rows])
    return write_csv(path, frame)


def write_maps(path: Path, maps: list[StabilityMap]) -> Path:
    """Write one line a cell as CSV."""
    parts = []
    for m in maps:
        cells = [
            (z, x, m.stable[i, j], m.wrong[i, j])
            for j, z in enumerate(m.ratio)
            for i, x in enumerate(m.step)
        ]
        names = ["damping ratio", "step over undamped critical step", "stable", "wrong side"]
        parts.append(pd.DataFrame(cells, columns=names).assign(engine=m.engine))
    frame = pd.concat(parts)
    return write_csv(path, frame)
