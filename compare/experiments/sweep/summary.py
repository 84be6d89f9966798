"""`--sweep` of a command, and its summary: a tidy table, and a grid with the swept keys as
dimensions.
"""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from cases.errors import SceneError
from compare.cli.options import warn
from compare.cli.study_view import run_and_show
from compare.engines import Progress
from compare.experiments.cost import dry_run
from compare.experiments.sweep import runner
from compare.experiments.sweep.axis import MEMBER
from compare.experiments.sweep.case import SweepOutcome, Work
from compare.experiments.sweep.ensemble import (
    ENSEMBLE,
    STATISTICS,
    members_of,
    statistics,
    waveforms,
)
from compare.experiments.sweep.runner import Sweep
from compare.misfit.metrics import Distance
from compare.misfit.places import Place
from compare.studies.store import Pool
from compare.studies.summary import Summary, cell, number, text_table, write_tables

NAME = "sweep"
#: The numbers of a run, of a receiver of it, and of a pair of solutions at a receiver.
OF_RUNS = ("steps", "freedoms", "seconds", "energy_residual")
OF_PAIR, MOST = ("variant", "one", "other"), 12  # keys of pairs; most waveforms shown
OF_RECEIVERS, OF_PAIRS = ("peak", "time_of_peak"), Distance._fields
UNITS = {"x": "m", "y": "m", "time_of_peak": "s", "seconds": "s", "delay": "s"}
#: Columns shown of runs and of comparisons: name, heading, and format of a number.
SHOWN_OF_RUNS = (
    ("peak", "peak, SI", ".4g"),
    ("time_of_peak", "at, s", ".4g"),
    ("steps", "steps", ",.0f"),
    ("seconds", "stepping, s", ".2g"),
    ("energy_residual", "energy residual", ".1e"),
)
SHOWN_OF_PAIRS = (
    ("misfit", "misfit", ".3%"),
    ("peak_ratio", "peak", ".4f"),
    ("delay", "delay, s", "+.2e"),
    ("envelope", "envelope", ".2%"),
    ("phase", "phase", ".2%"),
)


def sweep(
    asked: Sweep, work: Work, workers: int, dry: bool, as_json: bool, strict: bool = False
) -> None:
    """Run every case, write the table, and show it; dry : only print estimates.

    strict : treat warnings as errors. Raises SceneError if all cases fail.
    """
    warn(asked.scenes, strict)
    if dry:
        _foresee(asked, work, as_json)
        return

    def done(pool: Pool | None, advance: Progress) -> Summary:
        return summarise(asked, runner.run(asked, work, pool, advance))

    run_and_show(f"{len(asked.cases)} points", asked.out, workers, done, as_json)


def _foresee(asked: Sweep, work: Work, as_json: bool) -> None:
    """Show the estimated cost of every case, and cases that would fail at once."""
    wanted: list[dry_run.Run] = []
    failing: list[tuple[str, str]] = []
    for case in asked.cases:
        point = ", ".join(f"{k}={v}" for k, v in case.settings.items())
        if case.scene is None:
            failing.append((point, case.message))
        else:
            wanted += [(point, case.scene, name) for name in work.solvers(case.scene)]
    dry_run.show_runs(wanted, as_json, failing)


def table(asked: Sweep, found: list[SweepOutcome]) -> pd.DataFrame:
    """Return one row for each receiver of each run or pair, or for each case that failed; SI."""
    rows: list[dict[str, Any]] = []
    for case, one in zip(asked.cases, found, strict=True):
        point = {key: cell(value) for key, value in case.settings.items()}
        about = point | {"variant": case.variant, "state": one.state, "message": one.message}
        rows += [about | row for row in one.rows or [{}]]
    return pd.DataFrame(rows)


def summarise(asked: Sweep, found: list[SweepOutcome]) -> Summary:
    """Return the summary of a sweep; write sweep.csv and sweep.nc.

    Raises SceneError if all cases have failed.
    """
    if all(one.state == "failed" for one in found):
        allowed = f"all {len(found)} points fail: {found[0].message}"
        raise SceneError(asked.scene, "", None, allowed)
    rows, axes = table(asked, found), asked.axes
    done, failed = rows[rows.state == "done"], rows[rows.state == "failed"]
    files: list[Path] = []
    if asked.out is not None:
        data = grid(axes, done).assign_attrs(scene=asked.scene)
        files = write_tables(asked.out, NAME, rows, data)
    columns = SHOWN_OF_PAIRS if "one" in rows else SHOWN_OF_RUNS
    shown, legend, where = _shown(done, list(axes))

    def cells(row: dict[str, Any]) -> list[str]:
        numbers = (number(float(row[name]), form, "-") for name, _, form in columns)
        return [_point(row, axes), *([_place(row)] * len(where)), *numbers]

    found_rows = [(_heading(row, not where), cells(row)) for row in shown.to_dict("records")]
    summary = Summary(
        NAME,
        asked.scene,
        text_table([", ".join(axes), *where, *(head for _, head, _ in columns)], found_rows),
        [],
        [f"{_point(r, axes)} {r['variant']}: {r['message']}" for r in failed.to_dict("records")],
        files,
        {"rows": json.loads(rows.to_json(orient="records")), "files": list(map(str, files))},
        legend=legend,
    )
    return with_statistics(summary, asked, found, done) if MEMBER in axes else summary


def with_statistics(
    summary: Summary, asked: Sweep, found: list[SweepOutcome], done: pd.DataFrame
) -> Summary:
    """Return the summary of an ensemble: mean and percentiles of each number over the members;
    write ensemble.csv and the waveforms' statistics."""
    numbers, shows, form = (
        (OF_PAIRS, "misfit", ".3%") if "one" in done else (OF_RECEIVERS, "peak", ".4g")
    )
    rest = [key for key in asked.axes if key != MEMBER]
    rows = statistics(done, list(asked.axes), list(numbers))
    files = list(summary.files)
    if asked.out is not None:
        files += write_tables(asked.out, ENSEMBLE, rows)
        waves = [waveforms(*one) for one in members_of(asked.cases, found, asked.out).items()]
        files += [*waves, *_drawn(waves, done, rest, asked.out)]

    def cells(row: dict[str, Any]) -> list[str]:
        every = [number(float(row[name]), form, "-") for name in STATISTICS]
        return [*([_point(row, rest)] if rest else []), *every, f"{row['members']}"]

    shown = rows[rows.number == shows].to_dict("records")
    header = [*([", ".join(rest)] if rest else []), *STATISTICS, "members"]
    return summary._replace(
        name=ENSEMBLE,
        table=text_table(header, ((_heading(row, True), cells(row)) for row in shown)),
        facts=summary.facts
        | {
            "statistics": json.loads(rows.to_json(orient="records")),
            "files": list(map(str, files)),
        },
        files=files,
        legend=f"{shows}: mean and percentiles over the members; all numbers are in ensemble.csv.",
    )


def _drawn(waves: list[Path], done: pd.DataFrame, axes: list[str], out: Path) -> list[Path]:
    """Draw an ensemble; return the files."""
    from compare.experiments.sweep.diagram import pictures
    from compare.figures.export import save

    found = [
        save(one.figure, folder, one.name, one.title, one.table)
        for folder, one in pictures(waves, done, axes, out)
    ]
    return [one.file(kind) for one in found for kind in ("csv", "svg", "pdf", "png")]


def _shown(done: pd.DataFrame, axes: list[str]) -> tuple[pd.DataFrame, str, list[str]]:
    """Return the rows shown on a terminal, their description, and the heading of their places: for
    comparisons with more than MOST waveforms the worst of each pair at each point."""
    if "one" not in done or len(done.drop_duplicates([*OF_PAIR, "quantity", *_at(done)])) <= MOST:
        return done, "", []
    of_point = [*axes, *OF_PAIR]
    loud = done[done.faint == "false"].sort_values("misfit")
    worst = loud.drop_duplicates(of_point, keep="last").sort_index()
    return worst, "The worst waveform of each pair; all of them are in sweep.csv.", ["of"]


def grid(axes: dict[str, list[Any]], done: pd.DataFrame) -> xr.Dataset:
    """Return rows on the grid of swept keys, variants, and engines or pairs; nan if missing."""
    point, at = [*axes, "variant"], _at(done)
    if "one" in done:
        pairs = done.assign(pair=done["one"] + " ~ " + done["other"])
        found = _on_grid(pairs, [*point, "pair", "quantity", *at], OF_PAIRS)
    else:
        found = _on_grid(done, [*point, "engine", "quantity", *at], OF_RECEIVERS)
        runs = done.drop_duplicates([*point, "engine"])
        found = found.merge(_on_grid(runs, [*point, "engine"], OF_RUNS))
    found = found.reindex({key: list(map(cell, values)) for key, values in axes.items()})
    for name in UNITS.keys() & found.variables.keys():
        found[name].attrs["units"] = UNITS[name]
    return found


def _at(rows: pd.DataFrame) -> list[str]:
    return [name for name in ("x", "y") if name in rows]


def _on_grid(rows: pd.DataFrame, index: list[str], numbers: Sequence[str]) -> xr.Dataset:
    return rows.set_index(index)[list(numbers)].astype(float).to_xarray()


def _heading(row: dict[str, Any], has_place: bool) -> str:
    solved = f"{row['one']} ~ {row['other']}" if "one" in row else row["engine"]
    place = f", {_place(row)}" if row["quantity"] and has_place else ""
    return f"{row['variant']}: {solved}{place}" if row["variant"] else f"{solved}{place}"


def _place(row: dict[str, Any]) -> str:
    at = tuple(row[name] for name in ("x", "y") if name in row)
    return Place(row["quantity"], "", at).heading


def _point(row: dict[str, Any], axes: Iterable[str]) -> str:
    values = (row[key] for key in axes)
    return ", ".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in values)
