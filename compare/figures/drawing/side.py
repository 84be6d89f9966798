"""The pillar from the side, drawn from its scene: blocks, joints, layers, ends, load, receivers.

y is to the right and x up, so that z points into the drawing. The unit of the drawing is the inch;
along the pillar it is to scale, across where there is room.
"""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from cases.material.contacts import contacts, welds
from cases.schema.scene import Scene
from cases.schema.segment import regions
from compare.figures.drawing import symbols
from compare.figures.drawing.actions import draw_forces, draw_load
from compare.figures.drawing.labels import draw_receivers, draw_scale, ticks
from compare.figures.drawing.placement import HEIGHT, WIDTH, Placement, placement
from compare.figures.drawing.symbols import CHARACTER, EDGE, INK, LAYER, ROCK

MOST = 400  # blocks that are drawn one by one
SHADES = (ROCK, "#cfc7b5", "#dcdde0")  # of segments, in turn
ROOM = 0.5  # inches of what stands beyond an end


def draw_strip(ax: Axes, scene: Scene) -> None:
    """Draw a scene into axes of WIDTH x HEIGHT inches.

    Groups of the SVG and their parts: `blocks`, `joints`, `layers`, `stress` and `velocity`, one a
    receiver.
    """
    ax.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal")
    ax.axis("off")
    place = placement(scene)
    _draw_rock(ax, scene, place)
    for i, layer in enumerate(scene.soft_layers):
        width = max(0.045, place.scale * (layer.thickness or 0.0))
        left, right = place.x(layer.y) - width / 2, place.x(layer.y) + width / 2
        low, high = place.bottom - 0.05, place.top + 0.05
        across, up = [left, right, right, left], [low, low, high, high]
        ax.fill(across, up, color=LAYER, zorder=5, gid=f"layer-{i}")
    for end, outward in ((scene.ends.start, -1), (scene.ends.end, 1)):
        _draw_end(ax, end, place, place.x(0 if outward < 0 else scene.pillar.length), outward)
        _name_end(ax, end, scene, place, outward)
    draw_load(ax, scene, place)
    draw_forces(ax, scene, place)
    draw_receivers(ax, scene, place)
    draw_scale(ax, scene, place)


def block_edges(scene: Scene) -> list[float]:
    """Return y of the edges of the blocks that are drawn, m: all, or one for a pillar of many; of
    segments without joints, and of many blocks, one a segment."""
    if not scene.is_uniform:
        every = contacts(scene)
        edges = every[np.r_[True, ~welds(scene), True]]
        starts = [one.start for one in regions(scene)]
        return np.union1d(edges if len(edges) <= MOST else every[[0, -1]], starts).tolist()
    count, length = scene.block_count, scene.pillar.length
    return np.linspace(0, length, (count if count <= MOST else 1) + 1).tolist()


def _shades(scene: Scene) -> str | list[str]:
    """Return the colour of the blocks, or of each that is drawn where segments differ."""
    if not scene.segments:
        return ROCK
    stops = [one.stop for one in regions(scene)]
    middles = [(a + b) / 2 for a, b in pairwise(block_edges(scene))]
    return [SHADES[int(np.searchsorted(stops, y)) % len(SHADES)] for y in middles]


def _draw_rock(ax: Axes, scene: Scene, place: Placement) -> None:
    edges = [place.x(y) for y in block_edges(scene)]
    corners = [
        [(a, place.bottom), (b, place.bottom), (b, place.top), (a, place.top)]
        for a, b in pairwise(edges)
    ]
    colours = _shades(scene)
    blocks = PolyCollection(corners, facecolors=colours, edgecolors="none", zorder=1, gid="blocks")
    ax.add_collection(blocks, autolim=False)
    lines = [[(x, place.bottom), (x, place.top)] for x in edges[1:-1]]
    width = min(0.8, 40 / len(edges))
    joints = LineCollection(lines, colors=EDGE, linewidths=width, zorder=2, gid="joints")
    ax.add_collection(joints, autolim=False)
    outline = [(edges[0], place.bottom), (edges[-1], place.bottom), (edges[-1], place.top)]
    outline += [(edges[0], place.top), (edges[0], place.bottom)]
    ax.plot(*zip(*outline, strict=True), color=INK, linewidth=1.0, zorder=4)


def _draw_end(ax: Axes, end: str, place: Placement, x: float, outward: int) -> None:
    far, middle = x + outward * ROOM, (x, place.middle)
    half = (x + outward * ROOM / 2, place.middle)
    if end == "fixed":
        symbols.wall(ax, x, place.middle, place.thick + 0.25, outward)
    elif end == "quiet":
        symbols.dashpot(ax, middle, (far, place.middle))
    elif end == "matched":
        symbols.spring(ax, middle, half)
        symbols.dashpot(ax, half, (far, place.middle))
    if end in ("quiet", "matched"):
        symbols.wall(ax, far, place.middle, 0.3, outward)


def _name_end(ax: Axes, end: str, scene: Scene, place: Placement, outward: int) -> None:
    """Write what holds an end below it, beside the wall and the number of the scale there."""
    y = 0.0 if outward < 0 else ticks(scene, place)[-1]
    number = place.x(y) + outward * CHARACTER * (len(f"{y:g}") + 1) / 2
    x = place.x(0.0 if outward < 0 else scene.pillar.length) + outward * 0.1
    x = min(x, number) if outward < 0 else max(x, number)
    words = f"{end} {'start' if outward < 0 else 'end'}"
    symbols.note(ax, x, place.bottom - 0.21, words, "right" if outward < 0 else "left", "top")
