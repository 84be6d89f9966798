"""Receivers and the scale in the drawing of a pillar's side, labels clear of each other."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from cases.schema.scene import Scene, SoftLayer
from cases.schema.segment import regions
from compare.figures.drawing.actions import ASIDE, gravity_at, gravity_words
from compare.figures.drawing.placement import WIDTH, Placement
from compare.figures.drawing.symbols import CHARACTER, INK, LAYER, RECEIVER, SOFT, note
from compare.figures.units import unit_for

ABOVE = 0.33  # inches of the labels over the pillar


class Label(NamedTuple):
    """A label over x (inches), and its colour."""

    x: float
    text: str
    colour: str


def draw_receivers(ax: Axes, scene: Scene, place: Placement) -> None:
    """Draw sections (a line and a triangle), points (a dot) and layers with their labels."""
    labels = []
    for i, y in enumerate(scene.record.stress):
        x = place.x(y)
        ax.plot([x, x], [place.bottom, place.top], color=RECEIVER, linewidth=1.2, zorder=6)
        (mark,) = ax.plot([x], [place.top + 0.06], "v", color=RECEIVER, markersize=5, zorder=6)
        mark.set_gid(f"stress-{i}")
        labels.append(Label(x, f"σ {y:g} m", RECEIVER))
    for i, y in enumerate(scene.record.velocity):
        (mark,) = ax.plot([place.x(y)], [place.middle], "o", markersize=5, zorder=7)
        mark.set(markeredgecolor=RECEIVER, markeredgewidth=1.3, markerfacecolor="white")
        mark.set_gid(f"velocity-{i}")
        labels.append(Label(place.x(y), f"v {y:g} m", RECEIVER))
    labels += [
        Label(place.x(layer.y), _of_layer(layer, scene.pillar.block), LAYER)
        for layer in scene.soft_layers
    ]
    _write(ax, sorted(labels), place, _right(scene, place))


def _right(scene: Scene, place: Placement) -> float:
    """Return how far to the right labels may reach, inches."""
    if scene.gravity is None or not scene.gravity.acceleration:
        return WIDTH
    return gravity_at(scene, place) - ASIDE - CHARACTER * (len(gravity_words(scene.gravity)) + 1)


def _of_layer(layer: SoftLayer, spacing: float) -> str:
    """Return what makes a joint differ: its stiffness, else the strength that is its own."""
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
    return ", ".join(own) or "joint of its own law"


def _number(value: float, si: str) -> str:
    unit = unit_for(si, value)
    return f"{value / unit.size:.3g} {unit.name}"


def _write(ax: Axes, labels: list[Label], place: Placement, right: float) -> None:
    """Write labels in one line above the pillar, moved aside where they would meet; none at all
    where there is no room for them: the scale tells where receivers are."""
    widths = np.array([CHARACTER * (len(label.text) + 1) for label in labels])
    if not labels or widths.sum() > right:
        return
    base = place.top + ABOVE
    wanted = np.array([label.x for label in labels])
    for label, x in zip(labels, _apart(wanted, widths, right), strict=True):
        if abs(x - label.x) > 0.01:
            ax.plot(
                [label.x, x], [place.top + 0.12, base - 0.08], color=label.colour, linewidth=0.6
            )
        note(ax, x, base, label.text, color=label.colour)


def _apart(wanted: np.ndarray, widths: np.ndarray, right: float) -> np.ndarray:
    """Return sorted places moved as far apart as widths ask for, between 0 and `right`.

    They are moved as little as can be, in the sum of squares: less what stands before each, this is
    isotonic regression (Barlow & Brunk 1972), here by its min-max formula.
    """
    before = np.concatenate([[0.0], np.cumsum((widths[1:] + widths[:-1]) / 2)])
    free, n = wanted - before, len(wanted)
    moved = [
        max(min(free[j : k + 1].mean() for k in range(i, n)) for j in range(i + 1))
        for i in range(n)
    ]
    return np.clip(moved, widths[0] / 2, right - widths[-1] / 2 - before[-1]) + before


def ticks(scene: Scene, place: Placement) -> list[float]:
    """Return what the scale is marked with, m."""
    length = scene.pillar.length
    count = max(2, round(place.scale * length / 0.55))
    found = MaxNLocator(count, steps=[1, 2, 2.5, 5, 10]).tick_values(0, length)
    return [float(y) for y in found if 0 <= y <= length * (1 + 1e-9)]


def draw_scale(ax: Axes, scene: Scene, place: Placement) -> None:
    """Draw y in metres under the pillar, and what the pillar measures."""
    pillar, level = scene.pillar, place.bottom - 0.14
    end = place.x(pillar.length)
    ax.plot([place.start, end], [level, level], color=INK, linewidth=0.8)
    for y in ticks(scene, place):
        ax.plot([place.x(y)] * 2, [level, level - 0.05], color=INK, linewidth=0.8)
        note(ax, place.x(y), level - 0.07, f"{y:g}", va="top")
    times = place.thick / (place.scale * pillar.side)
    drawn = f"; drawn {times:.2g} times as thick" if times > 1.01 else ""
    blocks = f"{scene.block_count:,} blocks"
    blocks += f" in {len(regions(scene))} segments" if scene.segments else f" of {pillar.block:g} m"
    blocks += " on average" if scene.scatter else ""
    words = f"y (m): {blocks}, {pillar.side:g} m × {pillar.side:g} m across{drawn}"
    note(ax, place.start, level - 0.24, words, "left", "top", color=SOFT)
