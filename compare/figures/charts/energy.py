"""The energy ledger over time: what the load has put in, what became of it, and what is missing."""

from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from compare.figures.charts import interactive
from compare.figures.charts.ledgers import Ledger, drawn_terms, ledgers_of, table
from compare.figures.figure import Picture
from compare.figures.style import RC, TERMS, WIDTH, Style, in_order, style
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

#: Colours are those of terms; engines differ by their dashes.
DASHES = {
    "dem": "-",
    "continuum-jointed": (0, (5, 2)),
    "continuum-equivalent": (0, (1.2, 1.6)),
}


def energy(name: str, comparisons: list[Comparison]) -> list[Picture]:
    """Return the picture of all ledgers, none where no engine has kept one."""
    ledgers = ledgers_of(comparisons)
    if not any(x.any() for ledger in ledgers for x in ledger.terms.values()):
        return []
    unit = unit_for("J", max(np.abs(x).max() for ledger in ledgers for x in ledger.terms.values()))
    return [
        Picture(
            f"{name}-energy",
            "energy",
            "Energy over time",
            _caption(ledgers),
            _figure(ledgers, unit),
            table(ledgers),
            _plot(ledgers, unit),
        )
    ]


def _caption(ledgers: list[Ledger]) -> str:
    worst = {engine: 0.0 for engine in DASHES}
    for ledger in ledgers:
        worst[ledger.engine] = max(worst[ledger.engine], float(np.abs(ledger.residual).max()))
    engines = {ledger.engine for ledger in ledgers}
    sizes = ", ".join(f"{e} {worst[e]:.1g}" for e in worst if e in engines)
    return (
        "What the load has put in (work) and what became of it; all others add up to it. Below, on "
        f"an axis of its own, what is missing over the largest work, at most: {sizes}."
    )


def _look(engine: str, term: str) -> Style:
    return Style(TERMS[term], 2.0 if term == "work" else 1.4, DASHES[engine], 1)


def _of_engine(engine: str) -> Style:
    return style(engine)._replace(width=1.6, dashes=DASHES[engine])


def _figure(ledgers: list[Ledger], unit: Unit) -> Figure:
    variants = list(dict.fromkeys(ledger.variant for ledger in ledgers))
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(WIDTH, 4.4), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(
            2,
            len(variants),
            sharex="col",
            sharey="row",
            squeeze=False,
            gridspec_kw={"height_ratios": [3, 1]},
        )
        for j, variant in enumerate(variants):
            _draw(axes[:, j], [x for x in ledgers if x.variant == variant], unit)
            axes[0, j].set_title(variant, pad=4)
        axes[0, 0].set_ylabel(f"energy ({unit.name})")
        axes[1, 0].set_ylabel("missing")
        _add_legend(figure, ledgers)
    return figure


def _draw(axes: np.ndarray, ledgers: list[Ledger], unit: Unit) -> None:
    upper, lower = axes
    for ledger in ledgers:
        for term in drawn_terms([ledger]):
            look = _look(ledger.engine, term).of_line()
            upper.plot(1e3 * ledger.time, ledger.terms[term] / unit.size, **look)
        look = _of_engine(ledger.engine).of_line()
        lower.plot(1e3 * ledger.time, ledger.missing, **look)
    lower.set_yscale("log")
    lower.set_xlabel("time (ms)")
    for ax in axes:
        ax.margins(x=0)


def _add_legend(figure: Figure, ledgers: list[Ledger]) -> None:
    engines = in_order({ledger.engine for ledger in ledgers})
    entries = [
        Line2D([], [], label=term, **_look("dem", term).of_line()) for term in drawn_terms(ledgers)
    ]
    entries += [Line2D([], [], label=e, **_of_engine(e).of_line()) for e in engines]
    figure.legend(handles=entries, ncols=len(entries), loc="outside upper center", frameon=False)


def _plot(ledgers: list[Ledger], unit: Unit) -> dict[str, Any]:
    """Return the interactive figure: of each variant its terms, and under them what is missing."""
    variants = list(dict.fromkeys(ledger.variant for ledger in ledgers))
    looks = {t: _look("dem", t) for t in drawn_terms(ledgers)}
    looks |= {e: _of_engine(e) for e in in_order({x.engine for x in ledgers})}
    traces, panels = [], []
    for j, variant in enumerate(variants):
        panels += [
            interactive.Panel(variant, f"energy ({unit.name})", 200),
            interactive.Panel("missing, over the largest work", "", 80, _LOGARITHMIC),
        ]
        for ledger in ledgers:
            if ledger.variant == variant:
                traces += _traces(ledger, unit, 2 * j)
    layout = interactive.layout(panels, {"title": {"text": "time (ms)"}}, len(looks))
    return {"data": interactive.in_layers(traces, looks), "layout": layout}


_LOGARITHMIC: dict[str, Any] = {"type": "log", "exponentformat": "power", "nticks": 4}


def _traces(ledger: Ledger, unit: Unit, panel: int) -> list[dict[str, Any]]:
    time = interactive.places("x", 1e3 * ledger.time)
    common = {"type": "scatter", "mode": "lines", **time}
    found = [
        common
        | {
            "name": term,
            "legendgroup": term,
            "y": interactive.packed(ledger.terms[term] / unit.size),
            "yaxis": interactive.axis_of(panel),
            "line": interactive.line(_look(ledger.engine, term)),
            "hovertemplate": f"{term} %{{y:.4~g}} {unit.name} at %{{x:.2f}} ms"
            f"<extra>{ledger.engine}</extra>",
        }
        for term in drawn_terms([ledger])
    ]
    return [
        *found,
        common
        | {
            "name": ledger.engine,
            "legendgroup": ledger.engine,
            "y": interactive.packed(ledger.missing),
            "yaxis": interactive.axis_of(panel + 1),
            "line": interactive.line(_of_engine(ledger.engine)),
            "hovertemplate": f"%{{y:.2g}} missing at %{{x:.2f}} ms<extra>{ledger.engine}</extra>",
        },
    ]
