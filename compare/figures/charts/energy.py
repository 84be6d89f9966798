"""The energy ledger over time: the load's work, its stored and dissipated parts, the residual."""

import numpy as np
import pandas as pd

from jointwave.compare.engines import ENGINES, in_order, label_of
from jointwave.compare.figures.export import SceneFigure, chart, set_heading
from jointwave.compare.figures.receivers import named
from jointwave.compare.figures.style import TERMS, style, unit_for
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.solvers.record import Line

MOST = 480  # samples of a curve, and of the table
LEAST = 1e-17  # least residual drawn, below round-off
DASHES = "-", (0, (5, 2)), (0, (1.2, 1.6))  # of engines
COLUMNS = {term: f"{term} (J)" for term in TERMS}
RESIDUAL = "residual (of the largest work)"


def energy(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all ledgers; empty if no engine recorded one. Colours show terms, dashes
    engines; terms that stay zero are not drawn."""
    ledgers = ledgers_of(comparisons)
    largest = ledgers.filter(COLUMNS.values()).abs().max().max()
    if ledgers.empty or not largest:
        return []
    joule = "J/m" if comparisons[0].scene.in_plane else "J"
    unit = unit_for(joule, largest)
    variants = ledgers.groupby("variant", sort=False)
    with chart(1, len(variants), [2.2, 0.8], "time (ms)") as (figure, axes):
        for row in axes[0]:
            for ax in row[1:]:
                ax.sharey(row[0])
        axes[0, 0, 0].set_ylabel(f"energy ({unit.name})")
        for (variant, of_variant), (upper, lower) in zip(variants, axes[0].T, strict=True):
            set_heading(upper, str(variant))
            set_heading(lower, "residual over the largest work", small=True)
            for engine, rows in of_variant.groupby("engine", sort=False):
                dashes, time = DASHES[[*ENGINES].index(str(engine))], 1e3 * rows["time (s)"]
                for term, column in COLUMNS.items():
                    if column in rows and rows[column].any():
                        line = Line(TERMS[term], 2.0 if term == "work" else 1.4, 1, dashes)
                        values = rows[column] / unit.size
                        upper.plot(time, values, label=term, **line.of_line())
                line = style(str(engine))._replace(width=1.6, dashes=dashes)
                size = rows[RESIDUAL].abs()
                positive = np.where(size > LEAST, size, np.nan)  # the axis is logarithmic
                lower.semilogy(time, positive, label=label_of(str(engine)), **line.of_line())
    worst = ledgers[RESIDUAL].abs().groupby(ledgers["engine"], sort=False).max()
    caption = (
        "Work of the load, and the energies that balance it. Below, on an axis of its own, the "
        "residual over the largest work, at most: "
        f"{', '.join(f'{label_of(str(name))} {size:.1g}' for name, size in worst.items())}."
    )
    title = f"Energy over time: imbalance at most {worst.max():.1g} of the largest work"
    table = ledgers.rename(columns=lambda head: head.replace("(J)", f"({joule})"))
    return [SceneFigure(f"{name}-energy", title, caption, figure, table, folded=True)]


def ledgers_of(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return the ledgers of all engines and variants, a row per sample; missing terms are empty.

    All terms are relative to the first sample. The residual is the sum of all other terms minus the
    work, over the largest work or, without work, the largest term.
    """
    parts = [pd.DataFrame()]
    for variant, comparison in named(comparisons):
        for engine in in_order(comparison.results):
            result = comparison.results[engine]
            if "energy" not in result:
                continue
            since = result.energy - result.energy.isel(time=0)
            work = since.sel(term="work")
            scale = float(abs(work if work.any() else since).max()) or 1.0
            about = {"variant": variant, "engine": engine, "time (s)": result.time.values}
            terms = {f"{term} (J)": since.sel(term=term).values for term in since.term.values}
            residual = {RESIDUAL: ((since.sum("term") - 2 * work) / scale).values}
            found = pd.DataFrame(about | terms | residual)
            parts.append(found[:: max(1, -(-(len(found) - 1) // MOST))])
    return pd.concat(parts[1:] or parts, ignore_index=True)
