"""The energy ledger over time: the load's work, its stored and dissipated parts, the residual."""

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from compare.engines import ENGINES
from compare.figures.charts.chart import Chart, ChartLine, Entry, Subplot
from compare.figures.figure import SceneFigure, chart_figure
from compare.figures.style import TERMS, Style, in_order, style
from compare.figures.subplots import variant_names
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison

MOST = 480  # samples of a curve, and of the table
LEAST = 1e-17  # lower limit of a drawn residual: below round-off


class Ledger(NamedTuple):
    """The ledger of one engine's run of one variant, since its first sample.

    time : [n], s. terms : [n] by name, J, including work. residual : [n], the sum of all others
    minus the work, over the largest work or, without work, the largest term.
    """

    variant: str
    engine: str
    time: np.ndarray
    terms: dict[str, np.ndarray]
    residual: np.ndarray

    @property
    def missing(self) -> np.ndarray:
        """The size of the residual, NaN where it is zero: its axis is logarithmic."""
        size = np.abs(self.residual)
        return np.where(size > LEAST, size, np.nan)


def ledgers_of(comparisons: list[Comparison]) -> list[Ledger]:
    """Return the ledger of every engine and variant that recorded one."""
    return [
        _ledger(variant, engine, comparison.results[engine])
        for comparison, variant in zip(comparisons, variant_names(comparisons), strict=True)
        for engine in in_order(set(comparison.results))
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


def table(ledgers: list[Ledger]) -> pd.DataFrame:
    """Return a row per variant, engine and sample; terms missing in a run are empty."""
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


def drawn_terms(ledgers: list[Ledger]) -> list[str]:
    """Return the terms that are not zero throughout, in the order of the legend."""
    return [t for t in TERMS if any(t in x.terms and x.terms[t].any() for x in ledgers)]


def energy(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all ledgers; empty if no engine recorded one."""
    ledgers = ledgers_of(comparisons)
    if not any(x.any() for ledger in ledgers for x in ledger.terms.values()):
        return []
    plane = comparisons[0].scene.kind == "rock mass"
    unit = unit_for(
        "J/m" if plane else "J",
        max(np.abs(x).max() for ledger in ledgers for x in ledger.terms.values()),
    )
    variants = list(dict.fromkeys(ledger.variant for ledger in ledgers))
    entries = [Entry(term, term, _of_term("dem", term)) for term in drawn_terms(ledgers)]
    engines = in_order({ledger.engine for ledger in ledgers})
    entries += [Entry(engine, engine, _of_engine(engine)) for engine in engines]
    cells = [_cell(v, [x for x in ledgers if x.variant == v], unit) for v in variants]
    title, chart = "Energy over time", Chart([cells], "time (ms)", {"": entries})
    return [chart_figure(f"{name}-energy", title, _caption(ledgers), chart, table(ledgers))]


def _caption(ledgers: list[Ledger]) -> str:
    worst: dict[str, float] = {}
    for one in ledgers:
        worst[one.engine] = max(worst.get(one.engine, 0.0), float(np.abs(one.residual).max()))
    sizes = ", ".join(f"{engine} {worst[engine]:.1g}" for engine in ENGINES if engine in worst)
    return (
        "Work of the load, and the energies that balance it. Below, on "
        f"an axis of its own, the residual over the largest work, at most: {sizes}."
    )


def _of_term(engine: str, term: str) -> Style:
    return Style(TERMS[term], 2.0 if term == "work" else 1.4, _dashes(engine), 1)


def _dashes(engine: str) -> Any:
    """Return the dashes of an engine; dashes distinguish engines, colours terms."""
    dashes = ENGINES[engine].line.ledger
    return (0, dashes) if dashes else "-"


def _of_engine(engine: str) -> Style:
    return style(engine)._replace(width=1.6, dashes=_dashes(engine))


def _cell(variant: str, ledgers: list[Ledger], unit: Unit) -> list[Subplot]:
    at = "at %{x:.2f} ms<extra>"
    terms = [
        ChartLine(
            term,
            _of_term(one.engine, term),
            1e3 * one.time,
            one.terms[term] / unit.size,
            f"{term} %{{y:.4~g}} {unit.name} {at}{one.engine}</extra>",
        )
        for one in ledgers
        for term in drawn_terms([one])
    ]
    missing = [
        ChartLine(
            one.engine,
            _of_engine(one.engine),
            1e3 * one.time,
            one.missing,
            f"%{{y:.2g}} residual {at}{one.engine}</extra>",
        )
        for one in ledgers
    ]
    label, heading = f"energy ({unit.name})", "residual over the largest work"
    return [
        Subplot(variant, label, terms, 2.2, share="terms"),
        Subplot(heading, "", missing, 0.8, share="missing", is_log=True, is_minor=True),
    ]
