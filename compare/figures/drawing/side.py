"""The pillar from the side, drawn from its scene: blocks, joints, layers, ends, load, receivers.

y is to the right and x up, so that z points into the drawing. The unit of the drawing is the inch;
it is to scale along the pillar, and across it if there is room.
"""

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.ticker import MaxNLocator

from cases.material.contacts import contacts, welds
from cases.schema.joint import SoftLayer
from cases.schema.scene import Scene
from cases.schema.segment import regions
from compare.figures.drawing import symbols
from compare.figures.drawing.actions import (
    ASIDE,
    BASE,
    HEIGHT,
    WIDTH,
    Placement,
    draw_forces,
    draw_load,
    gravity_at,
    gravity_words,
    placement,
)
from compare.figures.drawing.symbols import CHARACTER, EDGE, INK, LAYER, RECEIVER, ROCK, SOFT, note
from compare.figures.units import unit_for

MOST = 400  # blocks that are drawn individually
SHADES = (ROCK, "#cfc7b5", "#dcdde0")  # of segments, cyclic
ROOM = 0.5  # inches beyond an end
ABOVE = 0.33  # inches of the labels above the pillar


def draw_strip(ax: Axes, scene: Scene) -> None:
    """Draw a scene into axes of WIDTH x HEIGHT inches.

    Groups of the SVG and their parts: `blocks`, `joints`, `layers`, `stress` and `velocity`, one
    per receiver.
    """
    ax.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal")
    ax.axis("off")
    place = placement(scene)
    _draw_rock(ax, scene, place)
    for i, layer in enumerate(scene.soft_layers):
        width = max(0.045, place.scale * (layer.thickness or 0.0))
        left, right = place.x(layer.y) - width / 2, place.x(layer.y) + width / 2
        low, high = BASE - 0.05, place.top + 0.05
        across, up = [left, right, right, left], [low, low, high, high]
        ax.fill(across, up, color=LAYER, zorder=5, gid=f"layer-{i}")
    for end, outward in ((scene.ends.start, -1), (scene.ends.end, 1)):
        _draw_end(ax, end, place, place.x(0 if outward < 0 else scene.pillar.length), outward)
        y = 0.0 if outward < 0 else ticks(scene, place)[-1]
        number = place.x(y) + outward * CHARACTER * (len(f"{y:g}") + 1) / 2
        x = place.x(0.0 if outward < 0 else scene.pillar.length) + outward * 0.1
        x = min(x, number) if outward < 0 else max(x, number)
        words = f"{end} {'start' if outward < 0 else 'end'}"
        symbols.note(ax, x, BASE - 0.21, words, "right" if outward < 0 else "left", "top")
    draw_load(ax, scene, place)
    draw_forces(ax, scene, place)
    draw_receivers(ax, scene, place)
    draw_scale(ax, scene, place)


def block_edges(scene: Scene) -> list[float]:
    """Return y of the edges of drawn blocks, m: of all, or a single one for a pillar with many; one
    per segment for segments without joints or with many blocks."""
    if not scene.is_uniform:
        every = contacts(scene)
        edges = every[np.r_[True, ~welds(scene), True]]
        starts = [one.start for one in regions(scene)]
        return np.union1d(edges if len(edges) <= MOST else every[[0, -1]], starts).tolist()
    count, length = scene.block_count, scene.pillar.length
    return np.linspace(0, length, (count if count <= MOST else 1) + 1).tolist()


def _shades(scene: Scene) -> str | list[str]:
    """Return the colour of the blocks, or of each drawn block if segments differ."""
    if not scene.segments:
        return ROCK
    stops = [one.stop for one in regions(scene)]
    middles = [(a + b) / 2 for a, b in pairwise(block_edges(scene))]
    return [SHADES[int(np.searchsorted(stops, y)) % len(SHADES)] for y in middles]


def _draw_rock(ax: Axes, scene: Scene, place: Placement) -> None:
    edges = [place.x(y) for y in block_edges(scene)]
    corners = [[(a, BASE), (b, BASE), (b, place.top), (a, place.top)] for a, b in pairwise(edges)]
    colours = _shades(scene)
    blocks = PolyCollection(corners, facecolors=colours, edgecolors="none", zorder=1, gid="blocks")
    ax.add_collection(blocks, autolim=False)
    lines = [[(x, BASE), (x, place.top)] for x in edges[1:-1]]
    width = min(0.8, 40 / len(edges))
    joints = LineCollection(lines, colors=EDGE, linewidths=width, zorder=2, gid="joints")
    ax.add_collection(joints, autolim=False)
    outline = [(edges[0], BASE), (edges[-1], BASE), (edges[-1], place.top)]
    outline += [(edges[0], place.top), (edges[0], BASE)]
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


def draw_receivers(ax: Axes, scene: Scene, place: Placement) -> None:
    """Draw sections (a line and a triangle), points (a dot) and layers with their labels."""
    labels = []  # x, inches; text; colour
    for i, y in enumerate(scene.record.stress):
        x = place.x(y)
        ax.plot([x, x], [BASE, place.top], color=RECEIVER, linewidth=1.2, zorder=6)
        (mark,) = ax.plot([x], [place.top + 0.06], "v", color=RECEIVER, markersize=5, zorder=6)
        mark.set_gid(f"stress-{i}")
        labels.append((x, f"σ {y:g} m", RECEIVER))
    for i, y in enumerate(scene.record.velocity):
        (mark,) = ax.plot([place.x(y)], [place.middle], "o", markersize=5, zorder=7)
        mark.set(markeredgecolor=RECEIVER, markeredgewidth=1.3, markerfacecolor="white")
        mark.set_gid(f"velocity-{i}")
        labels.append((place.x(y), f"v {y:g} m", RECEIVER))
    labels += [
        (place.x(layer.y), _of_layer(layer, scene.pillar.block), LAYER)
        for layer in scene.soft_layers
    ]
    _write(ax, sorted(labels), place, _right(scene, place))


def _right(scene: Scene, place: Placement) -> float:
    """Return the right limit of labels, inches."""
    if scene.gravity is None or not scene.gravity.acceleration:
        return WIDTH
    return gravity_at(scene, place) - ASIDE - CHARACTER * (len(gravity_words(scene.gravity)) + 1)


def _of_layer(layer: SoftLayer, spacing: float) -> str:
    """Return the differing property of a joint: its stiffness, else its own strength."""
    stiffness = layer.own_stiffness(spacing)
    if stiffness is not None:
        return f"layer, {_number(stiffness, 'Pa/m')}"
    own = [
        f"{words} {_number(getattr(layer, key), 'Pa')}"
        for key, words in (("cohesion", "cohesion"), ("tensile_strength", "strength"))
        if getattr(layer, key) is not None
    ]
    if layer.friction_angle is not None:
        own.append(f"friction {layer.friction_angle:g}°")
    return ", ".join(own) or "joint with its own law"


def _number(value: float, si: str) -> str:
    unit = unit_for(si, value)
    return f"{value / unit.size:.3g} {unit.name}"


def _write(ax: Axes, labels: list[tuple[float, str, str]], place: Placement, right: float) -> None:
    """Write labels in one line above the pillar, moved apart where they would overlap; none if
    there is no room: the scale then shows where receivers are."""
    widths = np.array([CHARACTER * (len(text) + 1) for _, text, _ in labels])
    if not labels or widths.sum() > right:
        return
    base = place.top + ABOVE
    wanted = np.array([at for at, _, _ in labels])
    for (at, text, colour), x in zip(labels, _apart(wanted, widths, right), strict=True):
        if abs(x - at) > 0.01:
            ax.plot([at, x], [place.top + 0.12, base - 0.08], color=colour, linewidth=0.6)
        note(ax, x, base, text, color=colour)


def _apart(wanted: np.ndarray, widths: np.ndarray, right: float) -> np.ndarray:
    """Return sorted places moved apart as required by the widths, between 0 and `right`.

    The sum of squares of the shifts is minimal: after subtracting the widths before each place,
    this is isotonic regression (Barlow & Brunk 1972), here by its min-max formula.
    """
    before = np.concatenate([[0.0], np.cumsum((widths[1:] + widths[:-1]) / 2)])
    free, n = wanted - before, len(wanted)
    moved = [
        max(min(free[j : k + 1].mean() for k in range(i, n)) for j in range(i + 1))
        for i in range(n)
    ]
    return np.clip(moved, widths[0] / 2, right - widths[-1] / 2 - before[-1]) + before


def ticks(scene: Scene, place: Placement) -> list[float]:
    """Return the tick values of the scale, m."""
    length = scene.pillar.length
    count = max(2, round(place.scale * length / 0.55))
    found = MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]).tick_values(0, length)
    return [float(y) for y in found if 0 <= y <= length * (1 + 1e-9)]


def draw_scale(ax: Axes, scene: Scene, place: Placement) -> None:
    """Draw y in metres below the pillar, and the pillar's dimensions."""
    pillar, level = scene.pillar, BASE - 0.14
    end = place.x(pillar.length)
    ax.plot([place.start, end], [level, level], color=INK, linewidth=0.8)
    for y in ticks(scene, place):
        ax.plot([place.x(y)] * 2, [level, level - 0.05], color=INK, linewidth=0.8)
        note(ax, place.x(y), level - 0.07, f"{y:g}", va="top")
    times = place.thick / (place.scale * pillar.side)
    drawn = f"; thickness × {times:.2g}" if times > 1.01 else ""
    blocks = f"{scene.block_count:,} blocks"
    blocks += f" in {len(regions(scene))} segments" if scene.segments else f" of {pillar.block:g} m"
    blocks += " on average" if scene.scatter else ""
    words = f"y (m): {blocks}, {pillar.side:g} m × {pillar.side:g} m across{drawn}"
    note(ax, place.start, level - 0.24, words, "left", "top", color=SOFT)
