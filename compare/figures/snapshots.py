"""Snapshots of the pillar as a picture: seen from the side, deformed, coloured by its stress."""

from math import floor, log10

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from compare.figures.style import RC, WIDTH
from results.snapshots import Snapshots

#: Corners of the faces of a cell, anticlockwise from outside.
FACES = {
    "line": [[0, 1]],
    "triangle": [[0, 1, 2]],
    "quad": [[0, 1, 2, 3]],
    "tetra": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    "hexahedron": [
        [0, 3, 2, 1],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    ],
}
COLOURS = "RdBu_r"  # tension blue, compression red
ROOM = 0.8  # of the pillar's thickness: what the largest displacement is drawn as, at most
MARGIN = 0.05  # of a strip's height, around it
LEFT, RIGHT = 0.75, 0.1  # inches beside the pillar
TOP, BOTTOM = 0.75, 0.45  # inches above and below


def draw_snapshots(name: str, found: dict[str, Snapshots]) -> Figure:
    """Return a figure of snapshots by engine, one under the other, displacements exaggerated.

    Seen along z; y is to the right and x up. The pillar of instant i is the SVG group
    NAME-i-ENGINE. All have the same instants, and their stress.
    """
    scale, largest = exaggeration(found), max(_peak(s.stress) for s in found.values()) or 1.0
    colour = ScalarMappable(Normalize(-1e-6 * largest, 1e-6 * largest), COLOURS)
    first = next(iter(found.values()))
    rows = [(i, engine) for i in range(len(first.time)) for engine in found]
    with matplotlib.rc_context(RC):
        figure, axes = _strips(*_reach(found, scale), len(rows))
        for ax, (i, engine) in zip(axes, rows, strict=True):
            _draw_pillar(ax, found[engine], i, scale, colour).set_gid(f"{name}-{i}-{engine}")
            label = [f"{1e3 * first.time[i]:g} ms"] + [engine] * (len(found) > 1)
            ax.set_ylabel("\n".join(label), rotation=0, ha="right", va="center")
        axes[-1].spines["bottom"].set_visible(True)
        axes[-1].tick_params(bottom=True)
        axes[-1].set_xlabel("y (m)")
        _add_key(figure, colour, scale)
    return figure


def exaggeration(found: dict[str, Snapshots]) -> float:
    """Return 1, 2 or 5 times a power of ten, by which the displacements can be seen; 1 for none."""
    thickness = max(float(np.ptp(s.points[:, 0])) for s in found.values())
    largest = max(_peak(s.displacement) for s in found.values())
    if not largest:
        return 1.0
    wanted = ROOM * thickness / largest
    power = 10.0 ** floor(log10(wanted))
    return power * max(k for k in (1, 2, 5) if k * power <= wanted)


def _peak(values: np.ndarray | None) -> float:
    return 0.0 if values is None else float(np.abs(values).max())


def _reach(found: dict[str, Snapshots], scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest x, y, z of all that is drawn, m."""
    drawn = [s.points + scale * s.displacement for s in found.values()]
    low = np.min([x.min(axis=(0, 1)) for x in drawn], axis=0)
    return low, np.max([x.max(axis=(0, 1)) for x in drawn], axis=0)


def _strips(low: np.ndarray, high: np.ndarray, count: int) -> tuple[Figure, list[Axes]]:
    """Return a figure with one strip under the other, all to the same scale in both directions."""
    margin = MARGIN * (high[0] - low[0])
    limits = [(low[k] - margin, high[k] + margin) for k in (1, 0)]
    width, height = (b - a for a, b in limits)
    strip = (WIDTH - LEFT - RIGHT) * height / width
    total = TOP + BOTTOM + count * strip
    figure = Figure(figsize=(WIDTH, total))
    FigureCanvasAgg(figure)
    axes = figure.subplots(count, 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    figure.subplots_adjust(
        LEFT / WIDTH, BOTTOM / total, 1 - RIGHT / WIDTH, 1 - TOP / total, hspace=0
    )
    axes[0].set_xlim(limits[0])
    axes[0].set_ylim(limits[1])
    for ax in axes:
        ax.spines[:].set_visible(False)
        ax.tick_params(left=False, bottom=False, labelleft=False)
    return figure, list(axes)


def _draw_pillar(
    ax: Axes, s: Snapshots, i: int, scale: float, colour: ScalarMappable
) -> PolyCollection:
    """Draw the sides that face the viewer, the nearest last."""
    assert s.stress is not None
    faces, cells = visible_faces(s, s.points + scale * s.displacement[i])
    shown = PolyCollection(
        list(faces[..., [1, 0]]),
        facecolors=colour.to_rgba(1e-6 * s.stress[i, cells]),
        edgecolors="#333333",
        linewidths=0.4,
    )
    ax.add_collection(shown, autolim=False)
    return shown


def _add_key(figure: Figure, colour: ScalarMappable, scale: float) -> None:
    """Put the colours and the exaggeration above the strips."""
    inch = 1 / figure.get_figheight()
    bar = figure.add_axes((LEFT / WIDTH, 1 - 0.32 * inch, 0.3, 0.14 * inch))
    figure.colorbar(colour, cax=bar, orientation="horizontal")
    for part in bar.collections:
        part.set(rasterized=False, edgecolor="face")  # an SVG would hold an image of it
    bar.set_title("axial stress (MPa), compression positive", loc="left", pad=3)
    figure.text(1 - RIGHT / WIDTH, 1 - 0.3 * inch, f"displacements drawn × {scale:,g}", ha="right")


def visible_faces(s: Snapshots, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces of cells seen along z [faces, corners, 3], the farthest first, and the cell
    of each. Of solid cells it is those whose outside is turned to the viewer."""
    rings = np.array(FACES[s.kind])
    faces = points[s.cells[:, rings]].reshape(-1, rings.shape[1], 3)
    cells = np.repeat(np.arange(len(s.cells)), len(rings))
    if len(rings) > 1:
        x, y, _ = np.moveaxis(faces, 2, 0)
        area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
        seen = area > 1e-6 * np.abs(area).max()
        faces, cells = faces[seen], cells[seen]
    order = np.argsort(faces[..., 2].mean(axis=1), kind="stable")
    return faces[order], cells[order]
