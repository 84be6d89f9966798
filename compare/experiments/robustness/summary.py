"""The summary of the robustness suite: every row with its margin, the maps, the long energies."""

from math import inf
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from compare.engines import Progress
from compare.experiments.robustness.case import EQUIVALENT, JOINTED, LEAPFROG, CaseTrial
from compare.experiments.robustness.criteria.energies import Drift, drift
from compare.experiments.robustness.linear_cases import MILLION
from compare.experiments.robustness.map import StabilityMap, boundary
from compare.experiments.robustness.run import FAILED, HELD, NONE, CaseRow, run, run_maps
from compare.figures.export import blank, save
from compare.figures.style import style
from compare.studies import store
from compare.studies.store import Pool, Store
from compare.studies.summary import Summary, frame, number, text_table, write_tables

LIGHT = "#eceff2"  # of unstable cells
LONG = {stepper.name: stepper for stepper in (LEAPFROG, JOINTED, EQUIVALENT)}
NAME = "stability"
TITLE = "Hard cases for both engines, and the margin by which they pass"
NOTE = (
    "Above: stable and unstable cells as computed, under the theoretical limit. Below: "
    "kinetic and elastic energy of undamped pillars over a million steps. The table has every hard "
    "case on every engine and scheme; its margin is the bound over the value."
)
COLUMNS = ["engine and scheme", "value", "bound", "margin", ""]


def draw(maps: list[StabilityMap], drifts: dict[str, Drift]) -> Figure:
    """Return one panel per map, and below them the energies of undamped runs.

    drifts : by "engine scheme". The cells of map k are the SVG group stability-map-k, the line over
    them stability-line-k, the energy k stability-energy-k.
    """
    heights = [3.4, 2.6] if drifts else [3.4]
    with blank(3.6 + 2.6 * bool(drifts)) as figure:
        parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)
        above, *below = parts[:, 0]
        axes = above.subplots(1, len(maps), squeeze=False, sharey=True)[0]
        for k, (ax, one) in enumerate(zip(axes, maps, strict=True)):
            _draw_map(ax, one, k)
        axes[0].set_ylabel("step over undamped critical step")
        if below:
            _draw_drifts(below[0].subplots(), drifts)
    return figure


def stretches(stable: np.ndarray, x: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
    """Return the corners [4, 2] of the longest stretches of stable cells in each row."""
    found = []
    for i, row in enumerate(stable):
        turns = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]])))
        for j, k in turns.reshape(-1, 2):
            found.append(np.array([[x[j], y[i]], [x[k], y[i]], [x[k], y[i + 1]], [x[j], y[i + 1]]]))
    return found


def _draw_map(ax: Axes, one: StabilityMap, k: int) -> None:
    across, up = _edges(one.ratio), _edges(one.step)
    ax.set(xlim=across[[0, -1]], ylim=up[[0, -1]], facecolor=LIGHT)
    stable = PolyCollection(stretches(one.stable, across, up), color=style(one.engine).colour)
    stable.set(gid=f"stability-map-{k}", linewidth=0.3)  # no seams between rows
    ax.add_collection(stable)
    ratio = np.geomspace(one.ratio[0], one.ratio[-1], 200)
    (line,) = ax.plot(ratio, boundary(ratio), color="#000000", linewidth=1.4)
    line.set_gid(f"stability-line-{k}")
    i, j = np.nonzero(one.wrong)
    ax.plot(one.ratio[j], one.step[i], "x", color="#d00000", markersize=5)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("damping ratio of the highest mode")
    ax.set_title(f"({chr(97 + k)})  {one.engine}: {len(i)} cells on the wrong side")
    ax.text(0.06, 0.12, "stable", transform=ax.transAxes)
    ax.text(0.94, 0.9, "unstable", transform=ax.transAxes, ha="right")


def _edges(centres: np.ndarray) -> np.ndarray:
    """Return the edges of cells in equal ratios around their centres."""
    half = np.sqrt(centres[1] / centres[0])
    return np.append(centres / half, centres[-1] * half)


def _draw_drifts(ax: Axes, drifts: dict[str, Drift]) -> None:
    for k, (name, one) in enumerate(drifts.items()):
        (line,) = ax.plot(
            one.steps / 1e6,
            one.energy / 1e-13,
            color=style(name.split()[0]).colour,
            label=name,
            linewidth=1.2,
        )
        line.set_gid(f"stability-energy-{k}")
    ax.set_xlabel("million steps at 0.9 of the critical one")
    ax.set_ylabel("relative deviation\nof energy from its mean, 1e-13")
    ax.legend(frameon=False, ncols=len(drifts), loc="lower right", bbox_to_anchor=(1, 0.98))
    ax.grid(color="#e4e7ea", linewidth=0.6)


def make_study(
    out: Path, pool: Pool | None = None, slow: bool = True, progress: Progress | None = None
) -> Summary:
    """Run the suite, the maps and the long runs; write their tables and figure into `out`.

    Rows and maps are saved in OUT/stability/. slow : also the rows that take long.
    """
    maps = run_maps(pool, out / NAME)  # before the rows: these are few, long points
    figure = save(draw(maps, drifts(pool)), out, NAME, TITLE)
    rows = run(pool, slow, progress, out / NAME)
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
    )


def drifts(pool: Pool | None) -> dict[str, Drift]:
    """Return the energies over a million steps of schemes that conserve energy, by engine and
    scheme."""
    found = Store[Drift](Drift, None).compute(list(LONG), store.key, _drift, pool)
    return dict(zip(LONG, found, strict=True))


def _drift(name: str) -> Drift:
    return drift(CaseTrial(MILLION, LONG[name]), 1_000_000)


def table(rows: list[CaseRow]) -> pd.DataFrame:
    """Return the rows under headings of case and criterion."""
    return text_table(COLUMNS, ((f"{row.case}: {row.criterion}", _cells(row)) for row in rows))


def _cells(row: CaseRow) -> list[str]:
    name = f"{row.engine}, {row.scheme}"
    if row.state == NONE:
        return [name, "", "", "", f"{NONE}: {row.message}"]
    margin = "all" if row.margin == inf else number(row.margin, ".3g")  # of a value of zero
    said = row.message if row.state == HELD else f"failed: {row.message}"
    return [name, number(row.value, ".3g"), number(row.bound, ".3g"), margin, said]


def sentences(rows: list[CaseRow], maps: list[StabilityMap]) -> list[str]:
    """Return the number of rows passed, the least margin, and map cells that contradict theory."""
    held, failed, none = ([r for r in rows if r.state == state] for state in (HELD, FAILED, NONE))
    found = [
        f"{len(held)} of {len(held) + len(failed)} rows pass; {len(none)} do not apply, each with "
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
    """Return a line for each row that has not passed."""
    return [
        f"{row.case}, {row.engine}, {row.scheme}: {row.criterion}: {row.value:.3g} above "
        f"{row.bound:.3g} {row.message}".rstrip()
        for row in rows
        if row.state == FAILED
    ]


def write(folder: Path, rows: list[CaseRow], maps: list[StabilityMap]) -> list[Path]:
    """Write stability.csv, one line per row, and stability-map.csv, one line per cell."""
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
