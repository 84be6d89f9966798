"""The energy ledger over time: the load's work, its stored and dissipated parts, the residual."""

from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from compare.engines import ENGINES, in_order
from compare.figures.charts.axes import Legend, chart, entry, set_heading, share
from compare.figures.figure import SceneFigure
from compare.figures.panels import variant_names
from compare.figures.style import TERMS, Style, style
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

MOST = 480  # samples of a curve, and of the table
LEAST = 1e-17  # lower limit of a drawn residual: below round-off
RESIDUAL = "residual (of the largest work)"


class Ledger(NamedTuple):
    """The ledger of one engine's run of one variant, since its first sample.

    time : [n], s. terms : [n] by name, J (J/m of a rock mass), including work. residual : [n], the
    sum of all others minus the work, over the largest work or, without work, the largest term.
    """

    variant: str
    engine: str
    time: np.ndarray
    terms: dict[str, np.ndarray]
    residual: np.ndarray

    @property
    def drawn(self) -> dict[str, np.ndarray]:
        """The terms that are not zero throughout, in the order of the legend."""
        return {t: self.terms[t] for t in TERMS if t in self.terms and self.terms[t].any()}


def ledgers_of(comparisons: list[Comparison]) -> list[Ledger]:
    """Return the ledger of every engine and variant that recorded one."""
    return [
        _ledger(variant, engine, comparison.results[engine])
        for comparison, variant in zip(comparisons, variant_names(comparisons), strict=True)
        for engine in in_order(comparison.results)
        if "energy" in comparison.results[engine]
    ]


def _ledger(variant: str, engine: str, result: xr.Dataset) -> Ledger:
    since = result["energy"].values - result["energy"].values[:, :1]
    names = [str(term) for term in result["term"].values]
    work = since[names.index("work")]
    scale = float(np.abs(work if work.any() else since).max()) or 1.0
    kept = slice(None, None, max(1, -(-(len(work) - 1) // MOST)))  # and the first
    residual = (since.sum(axis=0) - 2 * work) / scale
    terms = {term: since[i, kept] for i, term in enumerate(names)}
    return Ledger(variant, engine, result.time.values[kept], terms, residual[kept])


def energy(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all ledgers; empty if no engine recorded one."""
    ledgers = ledgers_of(comparisons)
    largest = max((np.abs(x).max() for one in ledgers for x in one.terms.values()), default=0.0)
    if not largest:
        return []
    unit = unit_for("J/m" if comparisons[0].scene.kind == "rock mass" else "J", largest)
    title, draw = "Energy over time", partial(_draw, ledgers, unit)
    return [SceneFigure(f"{name}-energy", title, _caption(ledgers), draw, _table(ledgers))]


def _caption(ledgers: list[Ledger]) -> str:
    worst: dict[str, float] = {}
    for one in ledgers:
        worst[one.engine] = max(worst.get(one.engine, 0.0), float(np.abs(one.residual).max()))
    sizes = ", ".join(f"{engine} {worst[engine]:.1g}" for engine in ENGINES if engine in worst)
    return (
        "Work of the load, and the energies that balance it. Below, on "
        f"an axis of its own, the residual over the largest work, at most: {sizes}."
    )


def _table(ledgers: list[Ledger]) -> pd.DataFrame:
    """Return a row per variant, engine and sample; terms missing in a run are empty."""
    parts = []
    for one in ledgers:
        about = {"variant": one.variant, "engine": one.engine, "time (s)": one.time}
        terms = {f"{term} (J)": values for term, values in one.terms.items()}
        parts.append(pd.DataFrame({**about, **terms, RESIDUAL: one.residual}))
    return pd.concat(parts, ignore_index=True)


def _draw(ledgers: list[Ledger], unit: Unit) -> Figure:
    variants = list(dict.fromkeys(one.variant for one in ledgers))
    terms = [t for t in TERMS if any(t in one.drawn for one in ledgers)]
    entries = [entry(term, _of_term("dem", term)) for term in terms]
    entries += [entry(name, _of_engine(name)) for name in in_order(x.engine for x in ledgers)]
    legend = Legend(entries, min(6, len(entries)))
    with chart(legend, 1, len(variants), [2.2, 0.8], "time (ms)") as (figure, axes):
        for row in axes[0]:
            share(row)
        axes[0, 0, 0].set_ylabel(f"energy ({unit.name})")
        for variant, (upper, lower) in zip(variants, axes[0].T, strict=True):
            set_heading(upper, variant)
            set_heading(lower, "residual over the largest work", small=True)
            for one in (x for x in ledgers if x.variant == variant):
                _draw_ledger(upper, lower, one, unit)
    return figure


def _draw_ledger(upper: Axes, lower: Axes, one: Ledger, unit: Unit) -> None:
    for term, values in one.drawn.items():
        upper.plot(1e3 * one.time, values / unit.size, **_of_term(one.engine, term).of_line())
    size = np.abs(one.residual)
    drawn = np.where(size > LEAST, size, np.nan)  # the axis is logarithmic
    lower.semilogy(1e3 * one.time, drawn, **_of_engine(one.engine).of_line())


def _of_term(engine: str, term: str) -> Style:
    """Return the style of a term: colours distinguish terms, dashes engines."""
    return Style(TERMS[term], 2.0 if term == "work" else 1.4, _of_engine(engine).dashes, 1)


def _of_engine(engine: str) -> Style:
    dashes = ENGINES[engine].line.ledger
    return style(engine)._replace(width=1.6, dashes=(0, dashes) if dashes else "-")
