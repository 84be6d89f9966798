"""Maps of the peak particle velocity, for every engine with snapshots of its whole field."""

from functools import partial

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
    "(record.fields): peaks between snapshots are missed."
)
PILLAR = (
    " A pillar is seen along z, not to scale; of cells behind one another the largest peak shows."
)
AXES = {True: ("x (m)", "y (m)"), False: ("y (m)", "x (m)")}  # of a rock mass, of a pillar


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the maps, one figure per variant; empty without fields."""
    found = []
    named = zip(variant_names(comparisons), comparisons, strict=True)
    for k, (variant, comparison) in enumerate(named):
        cells = cells_of(comparison)
        if cells:
            is_plane = isinstance(comparison.scene, RockMass)
            title, rows = f"Peak particle velocity, {variant}", table(cells, AXES[is_plane])
            drawing, stem = partial(draw, cells, is_plane), f"{name}-peak-velocity-{k}"
            caption = CAPTION if is_plane else CAPTION + PILLAR
            found.append(SceneFigure(stem, title, caption, drawing, rows, folded=True))
    return found


def cells_of(comparison: Comparison) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return the drawn corners [cells, n, 2] (m) and the peak velocity [cells] (m/s) of every
    engine with snapshots."""
    found: dict[str, tuple[np.ndarray, np.ndarray]] = {}
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


def table(cells: dict[str, tuple[np.ndarray, np.ndarray]], axes: tuple[str, str]) -> pd.DataFrame:
    """Return the middle of every cell with its peak velocity, SI."""
    parts = [
        pd.DataFrame({"engine": engine, axes[0]: x, axes[1]: y, "peak velocity (m/s)": peaks})
        for engine, (corners, peaks) in cells.items()
        for x, y in [corners.mean(axis=1).T]
    ]
    return pd.concat(parts, ignore_index=True)


def draw(cells: dict[str, tuple[np.ndarray, np.ndarray]], is_plane: bool) -> Figure:
    """Return the maps, of rock masses side by side and of pillars one below the other, on one
    colour scale."""
    highest = max(float(peaks.max(initial=0.0)) for _, peaks in cells.values()) or 1.0
    colour = ScalarMappable(Normalize(0.0, highest), UNSIGNED)
    with blank(HEIGHT) as figure:
        form = (1, len(cells)) if is_plane else (len(cells), 1)
        axes = figure.subplots(*form, sharex=True, sharey=True, squeeze=False).ravel()
        for ax, (engine, (corners, peaks)) in zip(axes, cells.items(), strict=True):
            drawn = PolyCollection(list(corners), rasterized=len(corners) > MANY)
            drawn.set(facecolors=colour.to_rgba(peaks), edgecolors="face", linewidths=0.2)
            ax.add_collection(drawn)
            ax.set_aspect("equal" if is_plane else "auto")
            ax.autoscale_view()
            ax.set_title(engine)
        for ax in axes if is_plane else axes[-1:]:
            ax.set_xlabel(AXES[is_plane][0])
        axes[0].set_ylabel(AXES[is_plane][1])
        figure.colorbar(colour, ax=list(axes), label="peak particle velocity (m/s)")
    return figure
