"""Propagation along a row of receivers: transfer function, phase speed and loss over frequency.

The transfer function and 1/Q are between the first and last velocity receivers, the phase speed is
from the f-k spectrum of all of them, and theory is that of an infinite pillar.
"""

from contextlib import suppress

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.compare.engines import in_order, label_of
from jointwave.compare.figures.export import SceneFigure, chart, set_heading
from jointwave.compare.figures.receivers import named, table_of
from jointwave.compare.figures.style import style
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.readings import attenuation
from jointwave.compare.readings.dispersion import dispersion, dispersion_theory

LEAST = 3  # receivers of a row
HEARD = 0.03  # least amplitude of drawn frequencies, over the largest at the first receiver
NAMES = TRANSFER, SPEED, LOSS = "transfer function", "phase speed (m/s)", "1/Q"
#: The solution whose model each theory has; the theory takes its line style.
THEORY = {
    "rigid blocks, theory": "lattice",
    "jointed rock, theory": "jointed-bar",
    "bar, theory": "equivalent-bar",
}
TITLE = "Transfer, dispersion and loss along the receivers"
CAPTION = (
    "Of the velocities of a row of receivers, from whole records, with all that is reflected in "
    "them: the size of the spectrum at the last over that at the first, the phase speed of the "
    "peak of the f-k spectrum, where receivers are less than half a wave apart, and 1/Q between "
    "both."
)

#: Curves by solution or theory and by NAMES, over frequency (Hz).
Curves = dict[str, dict[str, pd.Series]]


def propagation(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the figure of all variants with a row of receivers; empty if there is none."""
    rows = {variant: curves for variant, one in named(comparisons) if (curves := curves_of(one))}
    if not rows:
        return []
    columns: dict[str, pd.Series] = {}
    with chart(len(rows), len(NAMES), [2.1], "frequency (Hz)") as (figure, axes):
        for row, (variant, found) in zip(axes[:, 0], rows.items(), strict=True):
            for solution, curves in found.items():
                look = style(THEORY.get(solution, solution)).of_line()
                for what, curve in curves.items():
                    row[NAMES.index(what)].plot(curve, label=label_of(solution), **look)
                    columns[f"{solution} | {what} | {variant}"] = curve
            for ax, what in zip(row, NAMES, strict=True):
                set_heading(ax, variant)
                ax.set_ylabel(what)
    table = table_of(columns, "frequency (Hz)")
    return [SceneFigure(f"{name}-propagation", TITLE, CAPTION, figure, table, folded=True)]


def curves_of(comparison: Comparison) -> Curves:
    """Return the curves of one variant; empty unless LEAST or more receivers on a line all move."""
    found: Curves = {}
    for solution in in_order(comparison.results):
        result = comparison.results[solution]
        if "velocity" in result and len(result["velocity"]) >= LEAST:
            row = attenuation.waveforms(result)
            if (row != 0).any("time").all() and row["distance"].diff("receiver").min() > 0:
                with suppress(SceneError):  # receivers not on a line
                    found[solution] = _measured(result, row)
    if not found:
        return found
    frequency = next(iter(found.values()))[TRANSFER].index.values
    with suppress(SceneError):  # no theory for this scene
        theory = dispersion_theory(comparison.scene, frequency)
        for rock in theory.rock.values:
            speed, quality = (theory.sel(rock=rock)[n] for n in ("phase_speed", "quality"))
            curves = {SPEED: speed.to_series(), LOSS: 1 / quality.to_series()}
            found[f"{rock}, theory"] = curves
    return found


def _measured(result: xr.Dataset, row: xr.DataArray) -> dict[str, pd.Series]:
    """Return one result's curves at frequencies present at the first receiver; row : velocities."""
    first, transfer = np.abs(np.fft.rfft(row[0].values)), abs(attenuation.transfer_function(result))
    heard = (first > HEARD * first.max()) & (transfer.frequency.values > 0)
    every = transfer, dispersion(result).phase_speed, 1 / attenuation.quality_factor(result).quality
    found = (pd.Series(one.values, one.frequency.values) for one in every)
    series = (one.reindex(transfer.frequency.values[heard]).dropna() for one in found)
    return dict(zip(NAMES, series, strict=True))
