"""Maps of the peak particle velocity, for every engine with snapshots of its whole field."""

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import in_order
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import variant_names
from jointwave.compare.figures.style import UNSIGNED
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.readings import peak_velocity_map
from jointwave.results.snapshots import snapshots_of

MANY = 3000  # cells above which they are an image in the drawing
HEIGHT = 3.6  # inches
CAPTION = (
    "The largest particle velocity of each cell, the mean of its nodes', over all snapshots "
    "(record.fields): peaks between snapshots are missed. A pillar is seen along z, not to scale; "
    "of cells behind one another the largest peak shows."
)
PLANE, PILLAR = ("x (m)", "y (m)"), ("y (m)", "x (m)")  # axes

#: Drawn corners [cells, n, 2] (m) and peak velocity [cells] (m/s) by engine.
Cells = dict[str, tuple[np.ndarray, np.ndarray]]


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the maps, one figure per variant; empty without fields."""
    found = []
    for k, (variant, one) in enumerate(zip(variant_names(comparisons), comparisons, strict=True)):
        if cells := cells_of(one):
            axes = PLANE if isinstance(one.scene, RockMass) else PILLAR
            title, drawn = (
                f"Peak particle velocity, {variant}",
                (draw(cells, axes), table(cells, axes)),
            )
            found.append(
                SceneFigure(f"{name}-peak-velocity-{k}", title, CAPTION, *drawn, folded=True)
            )
    return found


def cells_of(comparison: Comparison) -> Cells:
    """Return the cells of every engine with snapshots."""
    found: Cells = {}
    for engine in in_order(comparison.results):
        result = comparison.results[engine]
        shots = snapshots_of(result)
        if shots is not None:
            peaks = peak_velocity_map(result).values[shots.cells].mean(axis=1)
            corners = shots.points[shots.cells, :2]
            if isinstance(comparison.scene, Scene):
                order = np.argsort(peaks, kind="stable")
                corners, peaks = _from_aside(corners[order], comparison.scene), peaks[order]
            found[engine] = corners, peaks
    return found


def _from_aside(corners: np.ndarray, scene: Scene) -> np.ndarray:
    """Return the rectangles [cells, 4, 2] (y, x) of a pillar's cells, seen along z; one-dimensional
    cells fill the section."""
    low, high = corners[:, :, ::-1].min(axis=1), corners[:, :, ::-1].max(axis=1)
    flat = low[:, 1] == high[:, 1]
    low[flat, 1], high[flat, 1] = -scene.pillar.side / 2, scene.pillar.side / 2
    turn = [(low, low), (high, low), (high, high), (low, high)]
    return np.stack([np.stack([a[:, 0], b[:, 1]], axis=1) for a, b in turn], axis=1)


def table(cells: Cells, axes: tuple[str, str]) -> pd.DataFrame:
    """Return the middle of every cell with its peak velocity, SI."""
    parts = [
        pd.DataFrame(corners.mean(axis=1), columns=list(axes)).assign(
            **{"engine": engine, "peak velocity (m/s)": peaks}
        )
        for engine, (corners, peaks) in cells.items()
    ]
    return pd.concat(parts, ignore_index=True)


def draw(cells: Cells, labels: tuple[str, str]) -> Figure:
    """Return the maps, of rock masses side by side and of pillars one below the other, on one
    colour scale."""
    highest = max(float(peaks.max(initial=0.0)) for _, peaks in cells.values()) or 1.0
    colour = ScalarMappable(Normalize(0.0, highest), UNSIGNED)
    form = (1, len(cells)) if labels == PLANE else (len(cells), 1)
    with blank(HEIGHT) as figure:
        axes = figure.subplots(*form, sharex=True, sharey=True, squeeze=False)
        for ax, (engine, (corners, peaks)) in zip(axes.flat, cells.items(), strict=True):
            drawn = PolyCollection(list(corners), rasterized=len(corners) > MANY)
            drawn.set(facecolors=colour.to_rgba(peaks), edgecolors="face", linewidths=0.2)
            ax.add_collection(drawn)
            ax.set_aspect("equal" if labels == PLANE else "auto")
            ax.autoscale_view()
            ax.set(title=engine, xlabel=labels[0], ylabel=labels[1])
            ax.label_outer()
        figure.colorbar(colour, ax=axes, label="peak particle velocity (m/s)")
    return figure
