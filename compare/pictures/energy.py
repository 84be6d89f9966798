"""The energy ledger over time: what the load has put in, what became of it, and what is missing."""

from typing import Any, NamedTuple

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from compare.pairs import Comparison
from compare.panels import variant_names
from compare.pictures import interactive
from compare.pictures.picture import Picture
from compare.pictures.units import Unit, unit_for
from compare.style import RC, TERMS, WIDTH, Style, in_order, style

MOST = 480  # samples of a curve
LEAST = 1e-17  # of what is drawn of a residual: a hundredth of round-off
DASHES = {
    "dem": "-",
    "continuum-jointed": (0, (5, 2)),
    "continuum-equivalent": (0, (1.2, 1.6)),
}


class Ledger(NamedTuple):
    """The ledger of one engine's run of one variant, since its first sample.

    time : [n], s. terms : [n] by name, J, work among them. residual : [n], the sum of all others
    less the work, over the largest work; of the largest term, where no work is done.
    """

    variant: str
    engine: str
    time: np.ndarray
    terms: dict[str, np.ndarray]
    residual: np.ndarray


def energy(name: str, comparisons: list[Comparison]) -> list[Picture]:
    """Return the picture of all ledgers, none where no engine has kept one."""
    ledgers = [
        _ledger(variant, engine, comparison.results[engine])
        for comparison, variant in zip(comparisons, variant_names(comparisons), strict=True)
        for engine in in_order(set(comparison.results))
        if "energy" in comparison.results[engine]
    ]
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
            _table(ledgers),
            _plot(ledgers, unit),
        )
    ]


def _ledger(variant: str, engine: str, result: xr.Dataset) -> Ledger:
    since = result["energy"].values - result["energy"].values[:, :1]
    names = [str(term) for term in result["term"].values]
    work = since[names.index("work")]
    scale = float(np.abs(work if work.any() else since).max()) or 1.0
    kept = interactive.thinned(len(work), MOST)
    residual = (since.sum(axis=0) - 2 * work) / scale
    terms = {term: since[i, kept] for i, term in enumerate(names)}
    return Ledger(variant, engine, result.time.values[kept], terms, residual[kept])


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


def _table(ledgers: list[Ledger]) -> pd.DataFrame:
    """Return a row a variant, engine and sample; a term that a run has not is empty."""
    return pd.concat(
        pd.DataFrame(
            {
                "variant": ledger.variant,
                "engine": ledger.engine,
                "time (s)": ledger.time,
                **{f"{term} (J)": values for term, values in ledger.terms.items()},
                "residual (of the largest work)": ledger.residual,
            }
        )
        for ledger in ledgers
    ).reset_index(drop=True)


def _drawn_terms(ledgers: list[Ledger]) -> list[str]:
    """Return the terms that are not zero throughout, in the order of the legend."""
    return [t for t in TERMS if any(t in x.terms and x.terms[t].any() for x in ledgers)]


def _look(engine: str, term: str) -> Style:
    return Style(TERMS[term], 2.0 if term == "work" else 1.4, DASHES[engine], 1)


def _missing(ledger: Ledger) -> np.ndarray:
    """Return the size of the residual, no number where it is zero: the axis is logarithmic."""
    size = np.abs(ledger.residual)
    return np.where(size > LEAST, size, np.nan)


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
        for term in _drawn_terms([ledger]):
            look = _look(ledger.engine, term).of_line()
            upper.plot(1e3 * ledger.time, ledger.terms[term] / unit.size, **look)
        look = style(ledger.engine)._replace(width=1.2).of_line()
        lower.plot(1e3 * ledger.time, _missing(ledger), **look)
    lower.set_yscale("log")
    lower.set_xlabel("time (ms)")
    lower.margins(x=0)


def _add_legend(figure: Figure, ledgers: list[Ledger]) -> None:
    engines = in_order({ledger.engine for ledger in ledgers})
    entries = [
        Line2D([], [], label=term, **_look("dem", term).of_line()) for term in _drawn_terms(ledgers)
    ]
    entries += [
        Line2D([], [], label=e, color=style(e).colour, linestyle=DASHES[e], linewidth=2)
        for e in engines
    ]
    figure.legend(handles=entries, ncols=len(entries), loc="outside upper center", frameon=False)


def _plot(ledgers: list[Ledger], unit: Unit) -> dict[str, Any]:
    """Return the interactive figure: of each variant its terms, and under them what is missing."""
    variants = list(dict.fromkeys(ledger.variant for ledger in ledgers))
    looks = {t: _look("dem", t) for t in _drawn_terms(ledgers)}
    looks |= {e: style(e) for e in in_order({x.engine for x in ledgers})}
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
        for term in _drawn_terms([ledger])
    ]
    return [
        *found,
        common
        | {
            "name": ledger.engine,
            "legendgroup": ledger.engine,
            "y": interactive.packed(_missing(ledger)),
            "yaxis": interactive.axis_of(panel + 1),
            "line": interactive.line(style(ledger.engine)._replace(width=1.4)),
            "hovertemplate": f"%{{y:.2g}} missing at %{{x:.2f}} ms<extra>{ledger.engine}</extra>",
        },
    ]
