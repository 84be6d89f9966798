"""Symbols of mechanics in a drawing whose unit is the inch: walls, springs, dashpots, arrows."""

from collections.abc import Sequence
from math import hypot
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle, FancyArrowPatch, Rectangle

INK, LOAD, RECEIVER, LAYER = "#1c2126", "#b3001b", "#00549e", "#8a3b12"
ROCK, EDGE, SOFT = "#efe9dd", "#9a917f", "#5d6670"
THIN = 0.9  # points
CHARACTER = 0.066  # inches of a character of 8 points

Point = tuple[float, float]


def note(
    ax: Axes, x: float, y: float, text: str, ha: str = "center", va: str = "center", **style: Any
) -> None:
    """Write at a place, in 8 points."""
    ax.text(x, y, text, ha=ha, va=va, fontsize=8, **style)


def arrow(ax: Axes, tail: Point, tip: Point, colour: str = LOAD, style: str = "-|>") -> None:
    """Draw an arrow from tail to tip."""
    ax.add_patch(
        FancyArrowPatch(
            tail,
            tip,
            arrowstyle=style,
            mutation_scale=9,
            color=colour,
            linewidth=1.3,
            shrinkA=0,
            shrinkB=0,
            zorder=6,
        )
    )


def along_or_across(ax: Axes, at: Point, toward: Point, depth: float, length: float) -> None:
    """Draw a force at a point: an arrow that ends there and, if it also points out of the drawing
    (depth above 0, toward the reader) or into it, a circle with a dot or a cross."""
    size = hypot(*toward)
    if size > 0.05:
        tail = (at[0] - length * toward[0], at[1] - length * toward[1])
        arrow(ax, tail, at)
    if abs(depth) > 0.05:
        circle(ax, at, depth > 0)


def circle(ax: Axes, at: Point, out: bool) -> None:
    """Draw the tip (a dot) or the tail (a cross) of an arrow across the drawing."""
    radius = 0.06
    ax.add_patch(Circle(at, radius, facecolor="white", edgecolor=LOAD, linewidth=1.3, zorder=7))
    if out:
        ax.add_patch(Circle(at, 0.02, color=LOAD, zorder=8))
        return
    d = radius / 2**0.5
    for sign in (1, -1):
        ax.plot(
            [at[0] - d, at[0] + d],
            [at[1] - sign * d, at[1] + sign * d],
            color=LOAD,
            linewidth=1.3,
            zorder=8,
        )


def couple(ax: Axes, at: Point, radius: float) -> None:
    """Draw a couple about the line of sight, anticlockwise."""
    ax.add_patch(
        Arc(at, 2 * radius, 2 * radius, theta1=-60, theta2=200, color=LOAD, linewidth=1.3, zorder=6)
    )
    end = np.deg2rad(200)
    tip = (at[0] + radius * np.cos(end), at[1] + radius * np.sin(end))
    arrow(ax, (tip[0] - 0.02, tip[1] + 0.06), (tip[0] + 0.015, tip[1] - 0.05))


def wall(ax: Axes, x: float, middle: float, height: float, outward: int) -> None:
    """Draw a wall with its face at x, extending to the left (outward -1) or the right (1)."""
    depth = 0.12
    left = x if outward > 0 else x - depth
    ax.add_patch(
        Rectangle(
            (left, middle - height / 2),
            depth,
            height,
            facecolor="white",
            edgecolor=SOFT,
            hatch="//////",
            linewidth=0,
            zorder=2,
        )
    )
    ax.plot([x, x], [middle - height / 2, middle + height / 2], color=INK, linewidth=1.3, zorder=3)


def spring(ax: Axes, start: Point, end: Point) -> None:
    """Draw a spring between two points at the same height."""
    (a, y), (b, _) = start, end
    turns = np.array([0, 0, 1, -1, 1, -1, 0, 0]) * 0.06
    at = a + (b - a) * np.array([0, 0.15, 0.25, 0.42, 0.58, 0.75, 0.85, 1])
    ax.plot(at, y + turns, color=INK, linewidth=THIN, zorder=3)


def dashpot(ax: Axes, start: Point, end: Point) -> None:
    """Draw a dashpot between two points at the same height: the piston's rod at `start`."""
    (a, y), (b, _) = start, end
    cup, piston, half = a + 0.45 * (b - a), a + 0.62 * (b - a), 0.075
    _path(ax, [a, piston], [y, y])
    _path(ax, [piston, piston], [y - 0.05, y + 0.05], 1.8)
    far = a + 0.8 * (b - a)
    _path(ax, [cup, far, far, cup], [y + half, y + half, y - half, y - half])
    _path(ax, [far, b], [y, y])


def _path(ax: Axes, x: Sequence[float], y: Sequence[float], width: float = THIN) -> None:
    ax.plot(x, y, color=INK, linewidth=width, zorder=3, solid_joinstyle="miter")
