"""The energy ledger over time: the load's work, its stored and dissipated parts, the residual."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jointwave.compare.engines import ENGINES, in_order, label_of
from jointwave.compare.figures.charts.axes import chart, set_heading, share
from jointwave.compare.figures.export import SceneFigure
from jointwave.compare.figures.style import TERMS, Style, style
from jointwave.compare.figures.units import Unit, unit_for
from jointwave.compare.figures.variants import named
from jointwave.compare.misfit.pairs import Comparison

MOST = 480  # samples of a curve, and of the table
LEAST = 1e-17  # lower limit of a drawn residual: below round-off
DASHES = "-", (0, (5, 2)), (0, (1.2, 1.6))  # of engines
COLUMNS = {term: f"{term} (J)" for term in TERMS}
RESIDUAL = "residual (of the largest work)"


def energy(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all ledgers; empty if no engine recorded one."""
    ledgers = ledgers_of(comparisons)
    largest = ledgers.filter(COLUMNS.values()).abs().max().max()
    if ledgers.empty or not largest:
        return []
    unit = unit_for("J/m" if comparisons[0].scene.in_plane else "J", largest)
    worst = ledgers[RESIDUAL].abs().groupby(ledgers["engine"], sort=False).max()
    caption = (
        "Work of the load, and the energies that balance it. Below, on an axis of its own, the "
        "residual over the largest work, at most: "
        f"{', '.join(f'{label_of(str(name))} {size:.1g}' for name, size in worst.items())}."
    )
    figure = _draw(ledgers, unit)
    title = f"Energy over time: imbalance at most {worst.max():.1g} of the largest work"
    return [SceneFigure(f"{name}-energy", title, caption, figure, ledgers, folded=True)]


def ledgers_of(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return the ledgers of all engines and variants: a row per sample; terms missing in a run are
    empty.

    All terms count from the first sample. residual : the sum of all others minus the work, over
    the largest work or, without work, the largest term.
    """
    parts = [
        _ledger(variant, engine, comparison.results[engine])
        for variant, comparison in named(comparisons)
        for engine in in_order(comparison.results)
        if "energy" in comparison.results[engine]
    ]
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()


def _ledger(variant: str, engine: str, result: xr.Dataset) -> pd.DataFrame:
    since = result.energy - result.energy.isel(time=0)
    work = since.sel(term="work")
    scale = float(abs(work if work.any() else since).max()) or 1.0
    about = {"variant": variant, "engine": engine, "time (s)": result.time.values}
    terms = {f"{term} (J)": since.sel(term=term).values for term in since.term.values}
    residual = (since.sum("term") - 2 * work) / scale
    found = pd.DataFrame({**about, **terms, RESIDUAL: residual.values})
    return found[:: max(1, -(-(len(found) - 1) // MOST))]


def _draw(ledgers: pd.DataFrame, unit: Unit) -> Figure:
    variants = ledgers.groupby("variant", sort=False)
    with chart(1, len(variants), [2.2, 0.8], "time (ms)") as (figure, axes):
        for row in axes[0]:
            share(row)
        axes[0, 0, 0].set_ylabel(f"energy ({unit.name})")
        for (variant, rows), (upper, lower) in zip(variants, axes[0].T, strict=True):
            set_heading(upper, str(variant))
            set_heading(lower, "residual over the largest work", small=True)
            for engine, of_engine in rows.groupby("engine", sort=False):
                _draw_ledger(upper, lower, str(engine), of_engine, unit)
    return figure


def _draw_ledger(upper: Axes, lower: Axes, engine: str, rows: pd.DataFrame, unit: Unit) -> None:
    """Draw an engine's ledger, but for terms that are zero throughout: colours distinguish terms,
    dashes engines."""
    time, size = 1e3 * rows["time (s)"].to_numpy(), rows[RESIDUAL].abs().to_numpy()
    line = style(engine)._replace(width=1.6, dashes=DASHES[[*ENGINES].index(engine)])
    for term, column in COLUMNS.items():
        if column in rows and rows[column].any():
            drawn = Style(TERMS[term], 2.0 if term == "work" else 1.4, line.dashes, 1)
            upper.plot(time, rows[column] / unit.size, label=term, **drawn.of_line())
    positive = np.where(size > LEAST, size, np.nan)  # the axis is logarithmic
    lower.semilogy(time, positive, label=label_of(engine), **line.of_line())
