"""Maps of the peak particle velocity of a rock mass, of every engine that kept its whole field."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from cases.schema.rock_mass import RockMass
from compare.figures.export import blank
from compare.figures.figure import SceneFigure
from compare.figures.style import UNSIGNED, in_order
from compare.figures.subplots import variant_names
from compare.misfit.pairs import Comparison
from compare.readings import peak_velocity_map
from results.snapshots import snapshots_of

MANY = 3000  # cells, beyond which they are an image in the drawing
HEIGHT = 3.6  # inches
CAPTION = (
    "The largest particle velocity of each cell, the mean of its nodes', over all snapshots "
    "(record.fields): a peak between two of them is not seen."
)


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the maps of every variant, a picture each; none of pillars, and without fields."""
    found = []
    named = zip(variant_names(comparisons), comparisons, strict=True)
    for k, (variant, comparison) in enumerate(named):
        cells = cells_of(comparison)
        if cells:
            title, rows = f"Peak particle velocity, {variant}", table(cells)
            drawing = partial(draw, cells)
            stem = f"{name}-peak-velocity-{k}"
            found.append(SceneFigure(stem, title, CAPTION, drawing, rows, folded=True))
    return found


def cells_of(comparison: Comparison) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return the corners [cells, n, 2] (m) and the peak velocity [cells] (m/s) of every engine that
    has snapshots of a rock mass."""
    found: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for engine in in_order(set(comparison.results)):
        result = comparison.results[engine]
        shots = snapshots_of(result) if isinstance(comparison.scene, RockMass) else None
        if shots is not None:
            peaks = peak_velocity_map(result).values
            found[engine] = shots.points[shots.cells, :2], peaks[shots.cells].mean(axis=1)
    return found


def table(cells: dict[str, tuple[np.ndarray, np.ndarray]]) -> pd.DataFrame:
    """Return the middle of every cell with its peak velocity, SI."""
    parts = [
        pd.DataFrame({"engine": engine, "x (m)": x, "y (m)": y, "peak velocity (m/s)": peaks})
        for engine, (corners, peaks) in cells.items()
        for x, y in [corners.mean(axis=1).T]
    ]
    return pd.concat(parts, ignore_index=True)


def draw(cells: dict[str, tuple[np.ndarray, np.ndarray]]) -> Figure:
    """Return the maps side by side, on one scale of colours."""
    highest = max(float(peaks.max(initial=0.0)) for _, peaks in cells.values()) or 1.0
    colour = ScalarMappable(Normalize(0.0, highest), UNSIGNED)
    with blank(HEIGHT) as figure:
        axes = figure.subplots(1, len(cells), sharex=True, sharey=True, squeeze=False)[0]
        for ax, (engine, (corners, peaks)) in zip(axes, cells.items(), strict=True):
            drawn = PolyCollection(list(corners), rasterized=len(corners) > MANY)
            drawn.set(facecolors=colour.to_rgba(peaks), edgecolors="face", linewidths=0.2)
            ax.add_collection(drawn)
            ax.set_aspect("equal")
            ax.autoscale_view()
            ax.set_title(engine)
            ax.set_xlabel("x (m)")
        axes[0].set_ylabel("y (m)")
        figure.colorbar(colour, ax=list(axes), label="peak particle velocity (m/s)")
    return figure
