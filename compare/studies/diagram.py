"""Work-precision diagrams: error over seconds and over counted work, both axes logarithmic."""

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from compare.studies.measure import Row
from compare.studies.pareto import front, measured
from compare.studies.study import Study
from compare.style import RC, STYLES, WIDTH, style

ERRORS = {
    "numerical": "misfit from each curve's exact solution",
    "total": "misfit from the finest physics",
}
COSTS = {"seconds": "seconds of stepping", "work": "freedoms x evaluations of the forces"}
MARKERS = "osD^vP*X<>hp"
LONG = 45  # characters of a legend's entry, of which three stand in a row
#: Colours of methods that have none elsewhere, apart from those that have (Okabe & Ito 2008).
OTHERS = ("#6b6b6b", "#cc79a7", "#8a6d00", "#7a4fbf", "#000000")


def draw(name: str, study: Study, rows: list[Row], costs: dict[str, str] | None = None) -> Figure:
    """Return a study's diagrams: a row an error, a column a cost.

    costs : attributes of the rows, with the words for each; absent: counted work, and seconds
        where they were measured. The curve k of row i, column j is the SVG group NAME-i-j-k.
    """
    errors = [e for e in ERRORS if any(measured(rows, e, "work"))]
    costs = costs or {c: text for c, text in COSTS.items() if study.timed or c != "seconds"}
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(WIDTH, 0.6 + 0.09 * len(study.curves) + 3.4 * len(errors)))
        FigureCanvasAgg(figure)
        axes = figure.subplots(len(errors), len(costs), squeeze=False, sharey="row")
        for i, error in enumerate(errors):
            for j, cost in enumerate(costs):
                _draw_panel(axes[i, j], study, rows, error, cost, f"{name}-{i}-{j}")
                axes[i, j].set_xlabel(costs[cost])
            axes[i, 0].set_ylabel(ERRORS[error])
        handles, labels = axes[0, 0].get_legend_handles_labels()
        columns, size = (3, 9.0) if max(map(len, labels)) < LONG else (2, 7.5)
        figure.legend(
            handles,
            labels,
            loc="outside upper center",
            ncols=columns,
            fontsize=size,
            frameon=False,
        )
        figure.set_layout_engine("constrained")
    return figure


def _draw_panel(ax: Axes, study: Study, rows: list[Row], error: str, cost: str, name: str) -> None:
    best = front(rows, error, cost) if len(study.curves) > 1 else []
    if best:
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
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.grid(which="major", color="#e4e7ea", linewidth=0.6)


def colour(study: Study, k: int) -> str:
    """Return the colour of a curve: its model's, as in all figures; the marker tells it apart."""
    method = study.curves[k].method
    if method in STYLES:
        return style(method).colour
    others = list(dict.fromkeys(c.method for c in study.curves if c.method not in STYLES))
    return OTHERS[others.index(method) % len(OTHERS)]
