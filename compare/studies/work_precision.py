"""The table, the diagram and the findings of a study: error over seconds and over counted work.

A cross marks a point more accurate than its errors or finer points imply: it is excluded.
"""

import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.figures.export import blank, save
from jointwave.compare.figures.style import style
from jointwave.compare.runs.output import write_csv, write_dataset
from jointwave.compare.runs.timings import machine
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.findings import done, floor, judged, orders, sentences
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.measure import is_valid, measure, references
from jointwave.compare.studies.store import Row
from jointwave.compare.studies.store import key as store_key
from jointwave.compare.studies.study import Study, StudyPoint
from jointwave.results.dataset import scene_hash

#: The studies of the report, in its order.
REPORTED = ("free-pillar", "convergence", "uniform-chain", "one-joint")
CANCELS = "×"
ERRORS = {"numerical": "numerical error (own model)", "total": "numerical + modelling error"}
COSTS = {"seconds": "seconds of stepping", "work": "degrees of freedom x force evaluations"}
MARKERS = "os^vDPX*<>hpd8H"
NEAR = 100.0  # smallest error of a panel that shows the error of its references, over that
LEGEND = (
    "Points are ranked by the sum: numerical error, modelling error, and the possible errors of "
    "the references. Measured is the misfit from the finest physics; it does not count where "
    f"errors cancel or a finer point is worse ({CANCELS})."
)
#: Columns of the table, each with its column of `measure` and a factor.
COLUMNS = {
    "numerical, %": ("numerical", 100),
    "modelling, %": ("modelling", 100),
    "sum, %": ("total", 100),
    "measured, %": ("measured", 100),
    "steps": ("steps", 1),
    "dof x evaluations": ("work", 1),
    "memory, kB": ("bytes", 1e-3),
    "set-up, s": ("setup", 1),
    "compiling, s": ("compile", 1),
    "stepping, s": ("seconds", 1),
    "±, s": ("spread", 1),
}


def key(point: StudyPoint) -> str:
    """Return the key of a point, from all that determines its row, including its scene's files."""
    study = point.study.model_dump(mode="json", exclude={"title", "curves"})
    scenes = [_hash_of(lambda: point.study.base), _hash_of(lambda: point.scene)]
    return store_key(study, point.curve.model_dump(mode="json"), point.settings, scenes)


def _hash_of(scene: Callable[[], AnyScene]) -> str:
    """Return the hash of a scene, or the error that makes it invalid."""
    try:
        return scene_hash(scene())
    except SceneError as error:
        return str(error)


def experiment(study: Study, folder: Path) -> Experiment:
    """Return a study with its points in `folder`, and NAME.csv, NAME.nc and the diagram beside it.

    Points of a timed study are run one at a time in this process.
    """
    again = study.repeats if study.timed and study.repeats > 1 else 0

    def runs(left: Sequence[StudyPoint]) -> list[Run]:
        valid = [point for point in left if is_valid(point)]
        return [
            *(Run(one.curve.label, one.scene, one.curve.method, 1, again) for one in valid),
            *(Run("references", scene, name) for name, scene in references(valid)),
        ]

    summary, shares = partial(summarise, study, folder), (study.timed, not study.timed)
    return Experiment(study.title, study.points(), folder, key, measure, summary, runs, *shares)


def summarise(study: Study, folder: Path, rows: list[Row]) -> Summary:
    """Return the summary of a study; write its files beside `folder`."""
    out, name = folder.parent, folder.name
    table = judged(rows)
    written = table.assign(settings=table["settings"].map(json.dumps))
    data = written.rename_axis("point").to_xarray()
    data = data.assign_attrs(title=study.title, study=study.model_dump_json(), **machine())
    files = [write_csv(out / f"{name}.csv", written), write_dataset(out / f"{name}.nc", data)]
    figure = None
    if any(len(done(table, error, "work")) for error in ERRORS):
        costs = {k: words for k, words in COSTS.items() if study.timed or k != "seconds"}
        figure = save(draw(name, table, costs), out, name, study.title)
        files += figure.drawings
    failed = table[table["state"] == "failed"]
    return Summary(
        name,
        study.title,
        shown(table),
        sentences(study, table),
        [f"{one.curve}, {_settings(one.settings)}: {one.message}" for one in failed.itertuples()],
        files,
        {"rows": rows, "orders": [one._asdict() for one in orders(study, table)]},
        figure,
        study.note,
        LEGEND if table["total"].notna().any() else "",
        study.quantity or "",
        study.timed,
    )


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table in display units, with points grouped by curve."""
    labels = table["settings"].map(_settings).replace("", "base scene")
    found = pd.DataFrame(
        {head: factor * table[column] for head, (column, factor) in COLUMNS.items()}
    )
    errors = [head for head in COLUMNS if "%" in head]
    found[errors] = found[errors].map("{:.3g}".format).replace("nan", "")
    found["measured, %"] += table["cancels"].map({True: f" {CANCELS}", False: ""})
    found = found.loc[:, (found.notna() & (found != "")).any()]
    return found.set_index(pd.MultiIndex.from_arrays([table["curve"], labels], names=["", "point"]))


def _settings(settings: dict[str, Any]) -> str:
    return ", ".join(f"{k.rpartition('.')[2]} {v}" for k, v in settings.items())


def draw(name: str, table: pd.DataFrame, costs: dict[str, str]) -> Figure:
    """Return the diagram of a judged table: one row of axes per error, one column per cost.

    costs : columns and their axis labels. Curve k of row i, column j is the SVG group NAME-i-j-k.
    """
    errors = [error for error in ERRORS if any(len(done(table, error, cost)) for cost in costs)]
    count = table["curve"].nunique()
    with blank(0.6 + 0.09 * count + 2.8 * len(errors)) as figure:
        axes = figure.subplots(len(errors), len(costs), squeeze=False, sharey="row")
        for i, error in enumerate(errors):
            for j, cost in enumerate(costs):
                _draw_panel(axes[i, j], table, error, cost, f"{name}-{i}-{j}")
                axes[i, j].set_xlabel(costs[cost])
            axes[i, 0].set_ylabel(ERRORS[error])
        entries: dict[str, Any] = {}
        for ax in axes.flat:
            entries |= zip(*ax.get_legend_handles_labels()[::-1], strict=True)
        about: dict[str, Any] = {"ncols": 2, "fontsize": 7.5, "frameon": False}
        figure.legend(entries.values(), entries, loc="outside upper center", **about)
    return figure


def _draw_panel(ax: Axes, table: pd.DataFrame, error: str, cost: str, name: str) -> None:
    points = done(table, error, cost)
    for k, (curve, some) in enumerate(table.groupby("curve", sort=False)):
        method, found = some["method"].iloc[0], points[points["curve"] == curve]
        (line,) = ax.loglog(found[cost], found[error], MARKERS[k % len(MARKERS)], label=curve)
        line.set(gid=f"{name}-{k}", linestyle="-", linewidth=1.2, markersize=4.5)
        line.set_color(style(method).colour)
    shown = "measured" if error == "total" else error
    crossed = done(table, shown, cost)
    crossed = crossed[crossed["cancels"] & ((error == "total") | crossed["total"].isna())]
    if len(crossed):
        words = "errors cancel, or a finer point is worse: excluded"
        ax.plot(crossed[cost], crossed[shown], "x", color="#c0392b", markersize=6, label=words)
    least = floor(table, error)
    if least and points[error].min() < NEAR * least:  # else most of the panel would be empty
        ax.axhspan(0, least, color="#f2f2f2", zorder=0, label="fine runs differ")
    ax.margins(x=0.04)  # so that no marker is cut
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.grid(which="major", color="#e4e7ea", linewidth=0.6)
