"""The summary of reflection and transmission against the angle: table, findings, files."""

from __future__ import annotations

from itertools import groupby
from math import isfinite
from pathlib import Path

from compare.engines import Progress, solver
from compare.experiments.cost.machine import machine
from compare.experiments.pool import Pool
from compare.experiments.scattering.angles import AngleRow, run
from compare.experiments.scattering.diagram import draw
from compare.experiments.summary import Summary
from compare.experiments.tables import frame, grouped, number, write_tables
from compare.figures.export import save
from compare.report.tables import Table, percent

NAME = "oblique-joint"
TITLE = "Reflection and transmission at one joint against the angle"
NOTE = (
    "Moduli of particle velocity over the incident one, at the peak frequency of the pulse, where "
    "K_n = Z_p omega and K_s = Z_s omega. A joint of 12 m in rock of 9.6 m and 5.5 m long P and S "
    "waves; the joint's exact field enters through all sides."
)
LEGEND = (
    "Off: the largest difference from the closed form. Residual: of the motion, what no plane "
    "waves of the rock make up. CPU: of a run, its set-up included, without compiling."
)
COLUMNS = ["angle", "R_p", "R_s", "T_p", "T_s", "off", "residual, %", "freedoms", "CPU, s"]


def make_study(out: Path, pool: Pool | None = None, progress: Progress | None = None) -> Summary:
    """Run the study; write its table and figure into `out`, its points into OUT/oblique-joint/."""
    rows = run(out / NAME, pool, progress)
    table = frame(rows, AngleRow)
    data = table.rename_axis("row").to_xarray().assign_attrs(title=TITLE, **machine())
    figure = save(draw(rows), out, NAME, TITLE)
    files = [*write_tables(out, NAME, table, data), *figure.drawings]
    said = sentences(rows)
    return Summary(
        NAME,
        TITLE,
        Table(COLUMNS, grouped((heading(row), cells(row)) for row in rows if _is_done(row))),
        said,
        failures(rows),
        files,
        {"rows": rows, "sentences": said, "files": list(map(str, files))},
        figure,
        NOTE,
        LEGEND,
        timed=True,
    )


def heading(row: AngleRow) -> str:
    """Return what the row of a table stands under."""
    return f"{solver(row.solver).words.english}: {row.incidence} wave"


def cells(row: AngleRow) -> list[str]:
    """Return a row as text, under `COLUMNS`."""
    moduli = (row.R_p, row.R_s, row.T_p, row.T_s)
    return [
        f"{row.angle:g}",
        *(number(x, ".4f") for x in moduli),
        number(row.error, ".1e"),
        number(100 * row.residual, ".2g"),
        number(row.freedoms, ",.0f"),
        number(row.cpu, ".2g"),
    ]


def sentences(rows: list[AngleRow]) -> list[str]:
    """Return the findings: of each solver and kind of wave the angle at which it is furthest off,
    and what all its angles cost."""
    found = []
    done = [row for row in rows if _is_done(row)]
    for _, group in groupby(done, key=lambda row: (row.solver, row.incidence)):
        some = list(group)
        worst = max(some, key=lambda row: row.error)
        cpu = sum(row.cpu for row in some if isfinite(row.cpu))
        found.append(
            f"{heading(worst)}: off by at most {percent(worst.error)} % of the incident wave, at "
            f"{worst.angle:g} degrees; {len(some)} angles take {cpu:.2g} s of processors."
        )
    return found


def failures(rows: list[AngleRow]) -> list[str]:
    """Return a line for each solver and reason for which it could not be run."""
    failed: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        if not _is_done(row):
            place = f"{row.incidence} at {row.angle:g} degrees"
            failed.setdefault((row.solver, row.message), []).append(place)
    return [
        f"{name}, {len(places)} angles from {places[0]} on: {why}"
        for (name, why), places in failed.items()
    ]


def _is_done(row: AngleRow) -> bool:
    return row.state == "done"
