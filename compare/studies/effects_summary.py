"""Cost and influence of effects: the diagram, the table and the findings."""

from math import isfinite
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jointwave.compare.figures.export import blank, save
from jointwave.compare.runs.output import write_csv
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies.experiment import Summary
from jointwave.compare.text import percent

NAME, TITLE = "effects", "Cost and influence of each effect"
LEAST_SHARE, LEAST_MISFIT = 0.5, 0.01  # %: smaller values and zero are drawn here
MARKERS = "osD^vP*X<>hpd8H"
#: Distinguishable with any colour blindness (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9", "#000000")


def summarise(folder: Path, found: pd.DataFrame) -> Summary:
    """Return the summary of the effects; write effects.csv and the diagram into `folder`."""
    figure = save(draw(found), folder, NAME, TITLE)
    files = [write_csv(folder / f"{NAME}.csv", found), *figure.drawings]
    data, about = {"rows": found.to_dict("records")}, "; ".join(_labels(found).unique())
    shown = table(found), sentences(found), (), files, data, figure
    return Summary(NAME, TITLE, *shown, about=about, timed=True)


def _labels(found: pd.DataFrame) -> pd.Series:
    return found.scene + (", " + found.variant).where(found.variant != "", "")


def table(found: pd.DataFrame) -> pd.DataFrame:
    """Return the effects by scene and engine, most expensive first, with the cost of a step."""
    numbers = {label: i for i, label in enumerate(_labels(found).unique(), start=1)}
    rows: dict[tuple[str, str], dict[str, Any]] = {}
    for _, some in found.assign(label=_labels(found)).groupby(["label", "engine"], sort=False):
        one = next(some.itertuples())
        heading = f"{numbers[one.label]}. {one.title} ({one.label}): {one.own:.3g} ns per "
        if one.engine == DEM.name:
            heading += "block and step"
            if isfinite(one.everything):
                full = f"{percent(one.own / one.everything)} % of {one.everything:.3g} ns"
                heading += f", {full} with every effect"
        else:
            heading += "degree of freedom and step of jointed rock"
        for e in some.sort_values(["reason", "ns"], ascending=[True, False]).itertuples():
            rows[heading, e.effect] = {
                "misfit without, %": 100 * e.misfit,
                "of a step, %": _resolved(100 * e.share, 100 * e.noise / e.own),
                "ns": _resolved(e.ns, e.noise),
                "steps, ratio": e.steps,
                "remark": e.reason,
            }
    index = pd.MultiIndex.from_tuples(rows, names=["", "effect"])
    return pd.DataFrame(list(rows.values()), index)


def _resolved(value: float, noise: float) -> float | str:
    """Return a number, or "within ±NOISE" if it does not exceed the noise of the timings."""
    if abs(value) > noise or not isfinite(value):
        return value
    return f"within ±{float(f'{noise:.1g}'):g}"


def sentences(found: pd.DataFrame) -> list[str]:
    """Return as sentences the costs of the cheapest and the most expensive set of effects, and the
    most expensive effect without influence."""
    blocks = found[found.engine == DEM.name].assign(label=_labels)
    sets = (blocks.own / blocks.everything).dropna().groupby(blocks.label).first().sort_values()
    said = []
    if len(sets):
        ends = dict.fromkeys(f"{percent(sets.iloc[i])} % ({sets.index[i]})" for i in (0, -1))
        said = [
            f"With only the effects of the scene a step of a block costs {' to '.join(ends)} of a "
            "step with every effect."
        ]
    idle = blocks[(blocks.ns.abs() > blocks.noise) & (blocks.misfit == 0)]
    if len(idle):
        one = blocks.loc[idle.share.idxmax()]
        said.append(
            f"The most expensive effect that does not change the result is the {one.effect}: "
            f"{percent(one.share)} % of a step of {one.label}."
        )
    return said


def draw(found: pd.DataFrame) -> Figure:
    """Return the diagram of misfit over cost of every effect in rigid blocks.

    Points carry the number of their scene; values below the lower limits are drawn at the limits.
    The k-th effect is the SVG group effects-points-k.
    """
    labels = _labels(found).unique().tolist()
    points = found[(found.engine == DEM.name) & (found.reason == "")].assign(label=_labels)
    with blank(max(4.6, 0.6 + 0.17 * (len(labels) + points.effect.nunique()))) as figure:
        ax = figure.subplots()
        for k, (effect, some) in enumerate(points.groupby("effect", sort=False)):
            x = (100 * some.share).clip(lower=LEAST_SHARE)
            y = (100 * some.misfit).clip(lower=LEAST_MISFIT)
            look: Any = {"color": COLOURS[k % len(COLOURS)], "marker": MARKERS[k % len(MARKERS)]}
            ax.plot(x, y, ls="none", label=effect, gid=f"effects-points-{k}", **look)
            for label, at in zip(some.label, zip(x, y, strict=True), strict=True):
                number = str(labels.index(label) + 1)
                ax.annotate(number, at, (6, 3), textcoords="offset points", fontsize=8)
        ax.set(xscale="log", yscale="log", xlim=(LEAST_SHARE / 1.12, 150))
        ax.set_ylim(bottom=LEAST_MISFIT / 1.8)
        ax.set_xlabel(f"cost: share of a block's step in the scene, %; {LEAST_SHARE:g} or less")
        ax.set_ylabel(f"influence: misfit without the effect, %; {LEAST_MISFIT:g} or less")
        ax.grid(which="major", color="#e4e7ea", linewidth=0.6)
        handles, names = ax.get_legend_handles_labels()
        names += [f"{i}  {label}" for i, label in enumerate(labels, start=1)]
        handles += [Line2D([], [], linestyle="none")] * len(labels)
        figure.legend(handles, names, loc="outside right upper", fontsize=8, frameon=False)
    return figure
