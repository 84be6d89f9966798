"""Work-precision diagrams: error over seconds and over counted work, both axes logarithmic."""

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from compare.studies.measure import Row
from compare.studies.pareto import front, measured
from compare.studies.study import Study
from compare.style import RC, WIDTH, style

ERRORS = {
    "numerical": "misfit from the exact solution of its own model",
    "total": "misfit from the finest physics",
}
COSTS = {"seconds": "seconds of stepping", "work": "freedoms x evaluations of the forces"}
MARKERS = "osD^vP*X<>hp"


def draw(name: str, study: Study, rows: list[Row]) -> Figure:
    """Return a study's diagrams: a row an error, a column a cost.

    The curve k of row i, column j is the SVG group NAME-i-j-k.
    """
    errors = [e for e in ERRORS if any(measured(rows, e, "work"))]
    costs = [c for c in COSTS if study.timed or c != "seconds"]
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(WIDTH, 0.9 + 3.4 * len(errors)))
        FigureCanvasAgg(figure)
        axes = figure.subplots(len(errors), len(costs), squeeze=False, sharey="row")
        for i, error in enumerate(errors):
            for j, cost in enumerate(costs):
                _draw_panel(axes[i, j], study, rows, error, cost, f"{name}-{i}-{j}")
            axes[i, 0].set_ylabel(ERRORS[error])
        handles, labels = axes[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False)
        figure.set_layout_engine("constrained")
    return figure


def _draw_panel(ax: Axes, study: Study, rows: list[Row], error: str, cost: str, name: str) -> None:
    best = front(rows, error, cost)
    ax.plot(
        [getattr(r, cost) for r in best],
        [getattr(r, error) for r in best],
        color="#bbbbbb",
        linewidth=5,
        zorder=1,
        label="none is better (Pareto's front)",
    )
    for k, curve in enumerate(study.curves):
        found = measured([r for r in rows if r.curve == curve.label], error, cost)
        found.sort(key=lambda row: getattr(row, cost))
        (line,) = ax.loglog(
            [getattr(r, cost) for r in found],
            [getattr(r, error) for r in found],
            color=colour(study, k),
            marker=MARKERS[k % len(MARKERS)],
            markersize=4.5,
            linewidth=1.2,
            label=curve.label,
            zorder=2,
        )
        line.set_gid(f"{name}-{k}")
    ax.set_xlabel(COSTS[cost])
    ax.grid(which="major", color="#e4e7ea", linewidth=0.6)


def colour(study: Study, k: int) -> str:
    """Return the colour of a curve: its model's, as in all figures; the marker tells it apart."""
    return style(study.curves[k].method).colour
