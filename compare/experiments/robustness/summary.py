"""The summary of the robustness suite: every row with its margin, the maps, the long energies."""

from math import inf
from pathlib import Path

import pandas as pd

from compare.engines import Progress
from compare.experiments import store
from compare.experiments.pool import Pool
from compare.experiments.robustness.case import EQUIVALENT, JOINTED, LEAPFROG, CaseTrial
from compare.experiments.robustness.criteria.energies import Drift, drift
from compare.experiments.robustness.diagram import draw
from compare.experiments.robustness.linear_cases import MILLION
from compare.experiments.robustness.map import StabilityMap
from compare.experiments.robustness.run import FAILED, HELD, NONE, CaseRow, run, run_maps
from compare.experiments.store import Store
from compare.experiments.summary import Summary
from compare.experiments.tables import frame, grouped, number, write_tables
from compare.figures.export import save
from compare.report.tables import Table

LONG = {stepper.name: stepper for stepper in (LEAPFROG, JOINTED, EQUIVALENT)}
NAME = "stability"
TITLE = "Hard cases: what both engines are put to, and by what margin they hold"
NOTE = (
    "Above: stable and unstable cells as computed, under the line that theory draws. Below: "
    "kinetic and elastic energy of undamped pillars over a million steps. The table has every hard "
    "case on every engine and scheme; its margin is the bound over the value."
)
COLUMNS = ["engine and scheme", "value", "bound", "margin", ""]


def make_study(
    out: Path, pool: Pool | None = None, slow: bool = True, progress: Progress | None = None
) -> Summary:
    """Run the suite, the maps and the long runs; write their tables and figure into `out`.

    Rows and maps are saved in OUT/stability/. slow : also the rows that take long.
    """
    rows = run(pool, slow, progress, out / NAME)
    maps = run_maps(pool, out / NAME)
    figure = save(draw(maps, drifts(pool)), out, NAME, TITLE)
    files = [*write(out, rows, maps), figure.file("svg")]
    said = sentences(rows, maps)
    return Summary(
        NAME,
        TITLE,
        table(rows),
        said,
        failures(rows),
        files,
        {"rows": rows, "sentences": said, "files": list(map(str, files))},
        figure,
        about=NOTE,
        has_text=True,
    )


def drifts(pool: Pool | None) -> dict[str, Drift]:
    """Return the energies over a million steps where leapfrog's energy holds, by engine and
    scheme."""
    found = Store[Drift](Drift, None).compute(list(LONG), store.key, _drift, pool)
    return dict(zip(LONG, found, strict=True))


def _drift(name: str) -> Drift:
    return drift(CaseTrial(MILLION, LONG[name]), 1_000_000)


def table(rows: list[CaseRow]) -> Table:
    """Return the rows under headings of case and criterion."""
    return Table(COLUMNS, grouped((f"{row.case}: {row.criterion}", _cells(row)) for row in rows))


def _cells(row: CaseRow) -> list[str]:
    name = f"{row.engine}, {row.scheme}"
    if row.state == NONE:
        return [name, "", "", "", f"{NONE}: {row.message}"]
    margin = "all" if row.margin == inf else number(row.margin, ".3g")  # of a value of zero
    said = row.message if row.state == HELD else f"failed: {row.message}"
    return [name, number(row.value, ".3g"), number(row.bound, ".3g"), margin, said]


def sentences(rows: list[CaseRow], maps: list[StabilityMap]) -> list[str]:
    """Return how many rows hold, the least margin, and the cells of maps that theory denies."""
    held, failed, none = ([r for r in rows if r.state == state] for state in (HELD, FAILED, NONE))
    found = [
        f"{len(held)} of {len(held) + len(failed)} rows hold; {len(none)} do not apply, each with "
        "its reason."
    ]
    least = min(held, key=lambda row: row.margin, default=None)
    if least is not None and least.margin < inf:
        found.append(
            f"The least margin is {least.margin:.3g}: {least.case}, {least.engine}, {least.scheme}."
        )
    return found + [
        f"{m.engine}: {m.stable.size:,} cells, {int(m.wrong.sum())} on the wrong side of the line, "
        f"{int(m.far.sum())} of them beyond one cell of it."
        for m in maps
    ]


def failures(rows: list[CaseRow]) -> list[str]:
    """Return a line for each row that does not hold."""
    return [
        f"{row.case}, {row.engine}, {row.scheme}: {row.criterion}: {row.value:.3g} above "
        f"{row.bound:.3g} {row.message}".rstrip()
        for row in rows
        if row.state == FAILED
    ]


def write(folder: Path, rows: list[CaseRow], maps: list[StabilityMap]) -> list[Path]:
    """Write stability.csv, a line a row, and stability-map.csv, a line a cell."""
    names = ["damping ratio", "step over undamped critical step", "stable", "wrong side", "engine"]
    cells = [
        (ratio, step, m.stable[i, j], m.wrong[i, j], m.engine)
        for m in maps
        for j, ratio in enumerate(m.ratio)
        for i, step in enumerate(m.step)
    ]
    return [
        *write_tables(folder, NAME, frame(rows, CaseRow)),
        *write_tables(folder, f"{NAME}-map", pd.DataFrame(cells, columns=names)),
    ]
