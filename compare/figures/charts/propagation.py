"""Propagation along a row of receivers: transfer function, phase speed and loss over frequency.

The transfer function and 1/Q are those from the first receiver of velocity to the last, the phase
speed that of the f-k spectrum of all of them (`compare.readings`), with the theory of an infinite
pillar (`dispersion_theory`).
"""

from functools import partial

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import in_order
from jointwave.compare.figures.charts.axes import chart, entry, set_heading, solutions_legend
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import variant_names
from jointwave.compare.figures.style import Style, style
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.readings import (
    dispersion,
    dispersion_theory,
    quality_factor,
    transfer_function,
    wave_speed,
)
from jointwave.compare.readings.attenuation import waveforms

LEAST = 3  # receivers of a row
HEARD = 0.03  # of the first receiver's largest amplitude: threshold of drawn frequencies
TOLD_APART = 0.95  # of the frequency at which two receivers are half a wavelength apart
NAMES = ("transfer function", "phase speed (m/s)", "1/Q")
#: The solution with the model of each theory, which gives its line style.
THEORY = {"rigid blocks": "lattice", "jointed rock": "jointed-bar", "bar": "equivalent-bar"}
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
    named = zip(variant_names(comparisons), comparisons, strict=True)
    rows = {variant: curves for variant, one in named if (curves := curves_of(one))}
    if not rows:
        return []
    title, draw = (
        "Transfer, dispersion and loss along the receivers",
        partial(_draw, rows, comparisons),
    )
    return [SceneFigure(f"{name}-propagation", title, CAPTION, draw, table(rows), folded=True)]


def curves_of(comparison: Comparison) -> Curves:
    """Return the curves of one variant; empty if fewer than LEAST receivers have a motion."""
    found: Curves = {}
    for solution in in_order(comparison.results):
        result = comparison.results[solution]
        if "velocity" not in result or len(result["velocity"]) < LEAST:
            continue
        row = waveforms(result)
        first = np.abs(np.fft.rfft(row[0].values))
        if not (row != 0).any("time").all() or row["distance"].diff("receiver").min() <= 0:
            continue
        found[solution] = _measured(result, first > HEARD * first.max())
    scene = comparison.scene
    if found and isinstance(scene, Scene) and not scene.segments:
        frequency = next(iter(found.values()))[NAMES[0]].index.values
        theory = dispersion_theory(scene, frequency)
        for rock in theory.rock.values:
            of_rock = theory.sel(rock=rock)
            found[f"{rock}, theory"] = {
                NAMES[1]: pd.Series(of_rock.phase_speed.values, frequency),
                NAMES[2]: pd.Series(1 / of_rock.quality.values, frequency),
            }
    return found


def _measured(result: xr.Dataset, heard: np.ndarray) -> dict[str, pd.Series]:
    """Return one result's curves at the frequencies above the threshold (bool array `heard`)."""
    transfer, both = abs(transfer_function(result)), dispersion(result).phase_speed
    loss = 1 / quality_factor(result).quality
    nearest = float(waveforms(result)["distance"].diff("receiver").min())
    both = both[both.frequency.values < TOLD_APART * abs(wave_speed(result)) / (2 * nearest)]
    wanted = transfer.frequency.values[heard & (transfer.frequency.values > 0)]
    series = (
        pd.Series(one.values, one.frequency.values).reindex(wanted).dropna()
        for one in (transfer, both, loss)
    )
    return dict(zip(NAMES, series, strict=True))


def table(rows: dict[str, Curves]) -> pd.DataFrame:
    """Return all curves by variant, frequency first."""
    columns = {
        f"{name} | {what} | {variant}": curve
        for variant, row in rows.items()
        for name, curves in row.items()
        for what, curve in curves.items()
    }
    return pd.DataFrame(columns).rename_axis("frequency (Hz)").reset_index()


def _draw(rows: dict[str, Curves], comparisons: list[Comparison]) -> Figure:
    theory = dict.fromkeys(k for row in rows.values() for k in row if k.endswith("theory"))
    legend = solutions_legend(comparisons, {"Theory": [entry(k, _style(k)) for k in theory]})
    with chart(legend, len(rows), len(NAMES), [2.1], "frequency (Hz)") as (figure, axes):
        for row, (variant, found) in zip(axes[:, 0], rows.items(), strict=True):
            for ax, what in zip(row, NAMES, strict=True):
                set_heading(ax, variant)
                ax.set_ylabel(what)
                for name, curves in found.items():
                    if what in curves:
                        ax.plot(curves[what], **_style(name).of_line())
    return figure


def _style(name: str) -> Style:
    rock, _, theory = name.partition(", ")
    return style(THEORY[rock] if theory else name)
