"""The summary of what joints reflect and pass: table, findings, files."""

from __future__ import annotations

from itertools import groupby
from math import isfinite
from pathlib import Path

from compare.engines import Progress, solver
from compare.experiments.cost.timings import machine
from compare.experiments.pool import Pool
from compare.experiments.scattering.diagram import draw
from compare.experiments.scattering.points import JointsRow, run
from compare.experiments.summary import Summary
from compare.experiments.tables import frame, grouped, number, write_tables
from compare.figures.export import save
from compare.report.tables import Table, percent

TITLES = {
    "oblique-joint": "Reflection and transmission at one joint against the angle",
    "parallel-joints": "Reflection and transmission of parallel joints at 30 degrees",
}
NOTE = (
    "Moduli of particle velocity over the incident one, at the peak frequency of the pulse, where "
    "K_n = Z_p omega and K_s = Z_s omega; P and S waves are 9.6 m and 5.5 m long, and several "
    "joints a tenth of the former apart. The exact field of the joints enters through all sides."
)
LEGEND = (
    "Off: the largest difference from the closed form. Residual: of the motion, what no plane "
    "waves of the rock make up. CPU: of a run, its set-up included, without compiling."
)
COLUMNS = ["R_p", "R_s", "T_p", "T_s", "off", "residual, %", "freedoms", "CPU, s"]


def make_study(
    name: str,
    out: Path,
    progress: Progress | None = None,
    brief: bool = False,
    pool: Pool | None = None,
) -> Summary:
    """Run a study of TITLES; write its table and figure into `out`, its points into OUT/NAME/.

    brief : only every other point, see `points`.
    """
    rows, title = run(name, out / name, progress, brief, pool), TITLES[name]
    table = frame(rows, JointsRow)
    data = table.rename_axis("row").to_xarray().assign_attrs(title=title, **machine())
    figure = save(draw(name, rows), out, name, title)
    files = [*write_tables(out, name, table, data), *figure.drawings]
    said = sentences(rows)
    first = "angle" if name == "oblique-joint" else "joints"
    cells = ((heading(row), cells_of(row, first)) for row in rows if _is_done(row))
    return Summary(
        name,
        title,
        Table([first, *COLUMNS], grouped(cells)),
        said,
        failures(rows),
        files,
        {"rows": rows, "sentences": said, "files": list(map(str, files))},
        figure,
        NOTE,
        LEGEND,
        timed=True,
    )


def heading(row: JointsRow) -> str:
    """Return what the row of a table stands under."""
    return f"{solver(row.solver).words.english}: {row.incidence} wave"


def cells_of(row: JointsRow, first: str) -> list[str]:
    """Return a row as text, under `COLUMNS`; first : the column before them."""
    moduli = (row.R_p, row.R_s, row.T_p, row.T_s)
    return [
        f"{getattr(row, first):g}",
        *(number(x, ".4f") for x in moduli),
        number(row.error, ".1e"),
        number(100 * row.residual, ".2g"),
        number(row.freedoms, ",.0f"),
        number(row.cpu, ".2g"),
    ]


def sentences(rows: list[JointsRow]) -> list[str]:
    """Return the findings: of each solver and kind of wave where it is furthest off, and what all
    its runs cost."""
    found = []
    done = [row for row in rows if _is_done(row)]
    for _, group in groupby(done, key=lambda row: (row.solver, row.incidence)):
        some = list(group)
        worst = max(some, key=lambda row: row.error)
        cpu = sum(row.cpu for row in some if isfinite(row.cpu))
        found.append(
            f"{heading(worst)}: off by {percent(worst.error)} % of the incident wave at most, "
            f"{_where(worst)}; {len(some)} runs take {cpu:.2g} s of processors."
        )
    return found


def failures(rows: list[JointsRow]) -> list[str]:
    """Return a line for each solver and reason for which it could not be run."""
    failed: dict[tuple[str, str], list[JointsRow]] = {}
    for row in rows:
        if not _is_done(row):
            failed.setdefault((row.solver, row.message), []).append(row)
    return [
        f"{name}, {len(some)} runs from {some[0].incidence} {_where(some[0])} on: {why}"
        for (name, why), some in failed.items()
    ]


def _where(row: JointsRow) -> str:
    joints = "one joint" if row.joints == 1 else f"{row.joints} joints"
    return f"at {row.angle:g} degrees and {joints}"


def _is_done(row: JointsRow) -> bool:
    return row.state == "done"
