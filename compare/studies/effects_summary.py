"""Cost and influence of effects: the diagram, the table and the findings."""

from math import isfinite
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jointwave.compare.figures.export import blank, save
from jointwave.compare.studies.summary import Summary, write_tables
from jointwave.compare.text import percent

NAME, TITLE = "effects", "Cost and influence of each effect"
LEAST_SHARE, LEAST_MISFIT = 0.5, 0.01  # %: smaller ones, and zero, are drawn here
MARKERS = "osD^vP*X<>hpd8H"
#: Safe for all kinds of colour blindness, by marker and colour in turn (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9", "#000000")


def summarise(folder: Path, found: pd.DataFrame) -> Summary:
    """Return the summary; write effects.csv and the diagram into `folder`."""
    files = write_tables(folder, NAME, found)
    figure = save(draw(found), folder, NAME, TITLE)
    files += figure.drawings
    said = sentences(found)
    return Summary(
        NAME,
        TITLE,
        table(found),
        said,
        [],
        files,
        {"rows": found.to_dict("records"), "sentences": said, "files": list(map(str, files))},
        figure,
        about="; ".join(_label(one) for one, _ in _scenes(found)),
        timed=True,
    )


def _scenes(found: pd.DataFrame) -> list[tuple[Any, pd.DataFrame]]:
    """Return the effects of each variant, after one of their rows."""
    groups = found.groupby(["scene", "variant"], sort=False)
    return [(next(some.itertuples()), some) for _, some in groups]


def _label(row: Any) -> str:
    return f"{row.scene}, {row.variant}" if row.variant else row.scene


def table(found: pd.DataFrame) -> pd.DataFrame:
    """Return the effects of each scene below the cost of a step, the most expensive first."""
    rows: dict[tuple[str, str], dict[str, Any]] = {}
    for i, (one, some) in enumerate(_scenes(found), start=1):
        heading = (
            f"{i}. {one.title} ({_label(one)}): {one.own:.2g} ns a block-step, "
            f"{percent(one.own / one.everything)} % of {one.everything:.2g} ns with everything on"
        )
        for e in some.sort_values(["reason", "ns"], ascending=[True, False]).itertuples():
            remark = f"{e.at_rest} is at rest with it: not resolved" if e.at_rest else e.reason
            rows[heading, e.effect] = {
                "misfit without, %": 100 * e.misfit,
                "of a step, %": _resolved(100 * e.share, 100 * e.ns_noise / e.own),
                "ns a block-step": _resolved(e.ns, e.ns_noise),
                "steps, ratio": e.steps,
                "ns a freedom-step of jointed rock": _resolved(e.ns_rock, e.ns_rock_noise),
                "remark": remark,
            }
    index = pd.MultiIndex.from_tuples(rows, names=["", "effect"])
    return pd.DataFrame(list(rows.values()), index)


def _resolved(value: float, noise: float) -> float | str:
    """Return a number; in place of one that does not exceed the noise of timings, that."""
    return value if abs(value) > noise or not isfinite(value) else f"within ±{noise:.1g}"


def sentences(found: pd.DataFrame) -> list[str]:
    """Return the costs of the cheapest and the most expensive set of effects, and the most
    expensive effect without influence."""
    sets = sorted((one.own / one.everything, _label(one)) for one, _ in _scenes(found))
    ends = dict.fromkeys(f"{percent(share)} % ({name})" for share, name in (sets[0], sets[-1]))
    said = [
        "With the effects that a scene needs, its block-step costs "
        f"{' to '.join(ends)} of one with everything on."
    ]
    idle = found[(found.ns.abs() > found.ns_noise) & (found.misfit == 0)]
    if len(idle):
        one = found.loc[idle.share.idxmax()]
        said.append(
            f"The most expensive effect that does not change the result is the {one.effect}: "
            f"{percent(one.share)} % of a step of {_label(one)}."
        )
    return said


def draw(found: pd.DataFrame) -> Figure:
    """Return the misfit over the cost of every effect; points have the number of their scene, and
    those at an edge lie there or beyond. The k-th effect is the SVG group effects-points-k."""
    points = found[found.reason == ""]
    labels = [_label(one) for one, _ in _scenes(found)]
    with blank(max(4.6, 0.6 + 0.17 * (len(labels) + points.effect.nunique()))) as figure:
        ax = figure.subplots()
        for k, (effect, some) in enumerate(points.groupby("effect", sort=False)):
            x = (100 * some.share).clip(lower=LEAST_SHARE)
            y = (100 * some.misfit).clip(lower=LEAST_MISFIT)
            look: dict[str, Any] = {
                "color": COLOURS[k % len(COLOURS)],
                "marker": MARKERS[k % len(MARKERS)],
            }
            ax.plot(x, y, ls="none", label=effect, gid=f"effects-points-{k}", **look)
            for row, *at in zip(some.itertuples(), x, y, strict=True):
                number = str(labels.index(_label(row)) + 1)
                ax.annotate(number, (at[0], at[1]), (6, 3), textcoords="offset points", fontsize=8)
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
