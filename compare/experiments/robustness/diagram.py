"""The stability maps with the line that theory draws, and the energy of a million steps."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from compare.experiments.robustness.criteria.energies import Drift
from compare.experiments.robustness.map import StabilityMap, boundary
from compare.figures.blank import blank
from compare.figures.style import style

LIGHT = "#eceff2"  # of unstable cells


def draw(maps: list[StabilityMap], drifts: dict[str, Drift]) -> Figure:
    """Return one panel a map, and below them the energies of undamped runs.

    drifts : by "engine scheme". The cells of map k are the SVG group stability-map-k, the line over
    them stability-line-k, the energy k stability-energy-k.
    """
    heights = [3.4, 2.6] if drifts else [3.4]
    with blank(3.6 + 2.6 * bool(drifts)) as figure:
        parts = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)
        above, *below = parts[:, 0]
        axes = above.subplots(1, len(maps), squeeze=False, sharey=True)[0]
        for k, (ax, one) in enumerate(zip(axes, maps, strict=True)):
            _draw_map(ax, one, k)
        axes[0].set_ylabel("step over undamped critical step")
        if below:
            _draw_drifts(below[0].subplots(), drifts)
    return figure


def stretches(stable: np.ndarray, x: np.ndarray, y: np.ndarray) -> list[np.ndarray]:
    """Return the corners [4, 2] of the longest stretches of stable cells in each row."""
    found = []
    for i, row in enumerate(stable):
        turns = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]])))
        for j, k in turns.reshape(-1, 2):
            found.append(np.array([[x[j], y[i]], [x[k], y[i]], [x[k], y[i + 1]], [x[j], y[i + 1]]]))
    return found


def _draw_map(ax: Axes, one: StabilityMap, k: int) -> None:
    across, up = _edges(one.ratio), _edges(one.step)
    ax.set(xlim=across[[0, -1]], ylim=up[[0, -1]], facecolor=LIGHT)
    stable = PolyCollection(stretches(one.stable, across, up), color=style(one.engine).colour)
    stable.set(gid=f"stability-map-{k}", linewidth=0.3)  # no seams between rows
    ax.add_collection(stable)
    ratio = np.geomspace(one.ratio[0], one.ratio[-1], 200)
    (line,) = ax.plot(ratio, boundary(ratio), color="#000000", linewidth=1.4)
    line.set_gid(f"stability-line-{k}")
    i, j = np.nonzero(one.wrong)
    ax.plot(one.ratio[j], one.step[i], "x", color="#d00000", markersize=5)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("damping ratio of the highest mode")
    ax.set_title(f"({chr(97 + k)})  {one.engine}: {len(i)} cells on the wrong side")
    ax.text(0.06, 0.12, "stable", transform=ax.transAxes)
    ax.text(0.94, 0.9, "unstable", transform=ax.transAxes, ha="right")


def _edges(centres: np.ndarray) -> np.ndarray:
    """Return the edges of cells in equal ratios around their centres."""
    half = np.sqrt(centres[1] / centres[0])
    return np.append(centres / half, centres[-1] * half)


def _draw_drifts(ax: Axes, drifts: dict[str, Drift]) -> None:
    for k, (name, one) in enumerate(drifts.items()):
        (line,) = ax.plot(
            one.steps / 1e6,
            one.energy / 1e-13,
            color=style(name.split()[0]).colour,
            label=name,
            linewidth=1.2,
        )
        line.set_gid(f"stability-energy-{k}")
    ax.set_xlabel("million steps at 0.9 of the critical one")
    ax.set_ylabel("energy over its mean, less one, 1e-13")
    ax.legend(frameon=False, ncols=len(drifts), loc="upper left")
    ax.grid(color="#e4e7ea", linewidth=0.6)
