"""Maps of the peak particle velocity of a rock mass, for every engine with snapshots of its whole
field."""

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.engines import in_order
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.style import UNSIGNED
from jointwave.compare.figures.variants import variant_names
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.readings import peak_velocity_map
from jointwave.results.snapshots import snapshots_of

MANY = 3000  # cells above which they are an image in the drawing
HEIGHT = 3.6  # inches
CAPTION = (
    "The largest particle velocity of each cell, the mean of its nodes', over all snapshots "
    "(record.fields): peaks between snapshots are missed."
)

#: Corners [cells, n, 2] (m) and peak velocity [cells] (m/s) by engine.
Cells = dict[str, tuple[np.ndarray, np.ndarray]]


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the maps, one figure per variant; empty for a pillar, or without fields."""
    found = []
    for k, (variant, one) in enumerate(zip(variant_names(comparisons), comparisons, strict=True)):
        if isinstance(one.scene, RockMass) and (cells := cells_of(one)):
            title, stem = f"Peak particle velocity, {variant}", f"{name}-peak-velocity-{k}"
            found.append(SceneFigure(stem, title, CAPTION, _draw(cells), _table(cells), True))
    return found


def cells_of(comparison: Comparison) -> Cells:
    """Return the cells of every engine with snapshots."""
    found: Cells = {}
    for engine in in_order(comparison.results):
        result = comparison.results[engine]
        shots = snapshots_of(result)
        if shots is not None:
            peaks = peak_velocity_map(result).values[shots.cells].mean(axis=1)
            found[engine] = shots.points[shots.cells, :2], peaks
    return found


def _table(cells: Cells) -> pd.DataFrame:
    """Return the middle of every cell with its peak velocity, SI."""
    parts = [
        pd.DataFrame({"engine": engine, "x (m)": x, "y (m)": y, "peak velocity (m/s)": peaks})
        for engine, (corners, peaks) in cells.items()
        for x, y in [corners.mean(axis=1).T]
    ]
    return pd.concat(parts, ignore_index=True)


def _draw(cells: Cells) -> Figure:
    """Return the maps side by side, on one colour scale."""
    highest = max(float(peaks.max(initial=0.0)) for _, peaks in cells.values()) or 1.0
    with blank(HEIGHT) as figure:
        axes = figure.subplots(1, len(cells), sharex=True, sharey=True, squeeze=False)[0]
        for ax, (engine, (corners, peaks)) in zip(axes, cells.items(), strict=True):
            drawn = PolyCollection(list(corners), rasterized=len(corners) > MANY)
            drawn.set(array=peaks, cmap=UNSIGNED, norm=Normalize(0.0, highest))
            drawn.set(edgecolors="face", linewidths=0.2)
            ax.add_collection(drawn)
            ax.autoscale_view()
            ax.set(aspect="equal", title=engine, xlabel="x (m)", ylabel="y (m)")
            ax.label_outer()
        figure.colorbar(drawn, ax=axes, label="peak particle velocity (m/s)")
    return figure
