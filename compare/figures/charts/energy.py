"""The energy ledger over time: the work of the load, what became of it, and what is missing."""

from __future__ import annotations

from typing import Any

import numpy as np

from compare.engines import ENGINES
from compare.figures.charts.chart import Chart, ChartLine, Entry, Subplot
from compare.figures.charts.ledgers import Ledger, drawn_terms, ledgers_of, table
from compare.figures.figure import SceneFigure, chart_figure
from compare.figures.style import TERMS, Style, in_order, style
from compare.figures.units import Unit, unit_for
from compare.misfit.pairs import Comparison


def energy(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the picture of all ledgers, none where no engine has kept one."""
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
        "What the load has put in (work) and what became of it; all others add up to it. Below, on "
        f"an axis of its own, what is missing over the largest work, at most: {sizes}."
    )


def _of_term(engine: str, term: str) -> Style:
    return Style(TERMS[term], 2.0 if term == "work" else 1.4, _dashes(engine), 1)


def _dashes(engine: str) -> Any:
    """Return the dashes of an engine, by which engines differ: colours are those of terms."""
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
            f"%{{y:.2g}} missing {at}{one.engine}</extra>",
        )
        for one in ledgers
    ]
    label, heading = f"energy ({unit.name})", "missing, over the largest work"
    return [
        Subplot(variant, label, terms, 2.2, share="terms"),
        Subplot(heading, "", missing, 0.8, share="missing", is_log=True, is_minor=True),
    ]
