"""The summary of reflection and transmission at joints: diagram, table, findings, files."""

from itertools import groupby
from math import isfinite
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from compare.engines import Progress, solver
from compare.exact.plane.waves import KINDS
from compare.experiments.scattering.points import AT, COUNTS, JointsRow, closed_form, run, scene_of
from compare.figures.export import blank, save
from compare.figures.style import style
from compare.runs.timings import machine
from compare.studies.store import Pool
from compare.studies.summary import Summary, frame, number, text_table, write_tables
from compare.text import percent

WAVES = {"R_p": ("o", "-"), "R_s": ("s", "--"), "T_p": ("^", "-."), "T_s": ("v", ":")}
LINE = "#30363b"  # of the closed form
AXES = {
    "oblique-joint": "angle from the joint's normal, degrees",
    "parallel-joints": "number of joints",
}
WORDS = {"P": "P wave", "SV": "SV wave"}
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
    "Error: the largest difference from the closed form. Residual: motion that plane waves "
    "of the rock cannot represent. CPU: time of a run, with set-up, without compiling."
)
COLUMNS = ["R_p", "R_s", "T_p", "T_s", "error", "residual, %", "DOFs", "CPU, s"]


def draw(name: str, rows: list[JointsRow]) -> Figure:
    """Return the diagram of a study, one row per kind of wave with the cost of the runs beside it.

    The closed form is a line, of wave w of row k the SVG group NAME-exact-k-w; solver j is its
    points, NAME-k-j-w.
    """
    done = [row for row in rows if row.state == "done"]
    solvers = list(dict.fromkeys(row.solver for row in done))
    with blank(3.3 * len(KINDS) + 0.5) as figure:
        axes = figure.subplots(len(KINDS), 2, width_ratios=(3, 1.3), squeeze=False, sharex="col")
        for k, kind in enumerate(KINDS):
            of_kind = [row for row in done if row.incidence == kind]
            _draw_moduli(axes[k, 0], of_kind, solvers, kind, f"{name}-{k}")
            _draw_cost(axes[k, 1], of_kind, solvers)
        found = zip(*axes[0, 0].get_legend_handles_labels()[::-1], strict=True)
        entries = dict(sorted(found, key=lambda entry: not entry[0].startswith("|")))
        figure.legend(entries.values(), entries, loc="outside upper center", ncols=4, frameon=False)
        axes[-1, 0].set_xlabel(AXES[name])
        axes[-1, 1].set_xlabel("CPU seconds of a run")
    return figure


def _draw_moduli(ax: Axes, rows: list[JointsRow], solvers: list[str], kind: str, gid: str) -> None:
    name, _, k = gid.rpartition("-")
    by_angle = name == "oblique-joint"
    if by_angle:
        x: np.ndarray = np.arange(0, 88, 0.5)
        exact = np.array(closed_form(scene_of(kind, 0.0), np.radians(x)))
    else:
        x = np.arange(1, COUNTS[-1] + 1)
        exact = np.array([closed_form(scene_of(kind, AT, int(n))) for n in x]).T
    for w, (wave, (marker, dashes)) in enumerate(WAVES.items()):
        (line,) = ax.plot(x, exact[w], color=LINE, linewidth=1.0, linestyle=dashes)
        line.set_gid(f"{name}-exact-{k}-{w}")
        ax.plot([], [], color=LINE, linestyle=dashes, marker=marker, label=f"|{wave}|")
        for j, one in enumerate(solvers):
            own = [row for row in rows if row.solver == one]
            (points,) = ax.plot(
                [row.angle if by_angle else row.joints for row in own],
                [getattr(row, wave) for row in own],
                marker,
                color=style(one).colour,
                markersize=8 - 2 * j,
                markerfacecolor="none" if j else None,
                label=f"{one}: points" if w == 0 else None,
            )
            points.set_gid(f"{gid}-{j}-{w}")
    ax.set(ylim=(-0.03, 1.1), ylabel="amplitude over the incident one")
    ax.set_title(WORDS[kind])
    if not by_angle:
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.grid(color="#e4e7ea", linewidth=0.6)


def _draw_cost(ax: Axes, rows: list[JointsRow], solvers: list[str]) -> None:
    for j, one in enumerate(solvers):
        own = [row for row in rows if row.solver == one and row.error > 0]
        ax.loglog(
            [max(row.cpu, 1e-3) for row in own],
            [row.error for row in own],
            "o",
            color=style(one).colour,
            markersize=8 - 2 * j,
            markerfacecolor="none" if j else None,
        )
    ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylabel("error from the closed form")
    ax.grid(color="#e4e7ea", linewidth=0.6)


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
        text_table([first, *COLUMNS], cells),
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
    """Return the heading of a row of the table."""
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
    """Return the findings: the largest error of each solver and kind of wave, and the cost of all
    its runs."""
    found = []
    done = [row for row in rows if _is_done(row)]
    for _, group in groupby(done, key=lambda row: (row.solver, row.incidence)):
        some = list(group)
        worst = max(some, key=lambda row: row.error)
        cpu = sum(row.cpu for row in some if isfinite(row.cpu))
        found.append(
            f"{heading(worst)}: error of at most {percent(worst.error)} % of the incident wave, "
            f"{_where(worst)}; {len(some)} runs take {cpu:.2g} s of CPU time."
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
