"""Actions on a rock mass in its drawing: waves, loads, gravity, prestress."""

import numpy as np
from matplotlib.axes import Axes

from cases.partition.outline import outline_of
from cases.schema.rock_mass import RockMass
from cases.schema.sources import PlaneLoad, Wave
from compare.figures.drawing import symbols
from compare.figures.drawing.actions import gravity_words
from compare.figures.drawing.symbols import LOAD, SOFT

LENGTH, SHORT = 0.12, 0.05  # of the domain's size: arrows of waves, and other arrows
MOST = 24  # arrows of one pressure


def draw_actions(ax: Axes, scene: RockMass, low: np.ndarray, high: np.ndarray) -> None:
    """Draw all actions on a rock mass that extends from `low` to `high`, m."""
    size = float((high - low).min())
    for wave in scene.waves:
        _draw_wave(ax, wave, low, high, size)
    for load in scene.loads:
        _draw_load(ax, scene, load, size)
    corner = np.array([low[0], high[1] + 0.4 * LENGTH * size])
    if scene.gravity is not None and scene.gravity.acceleration:
        tip = corner + SHORT * size * np.array(scene.gravity.direction)
        symbols.arrow(ax, tuple(corner), tuple(tip), SOFT)
        symbols.note(ax, corner[0] + 0.02 * size, corner[1], gravity_words(scene.gravity), "left")
    if scene.prestress is not None:
        stress = scene.prestress
        words = f"prestress {stress.xx / 1e6:g}, {stress.yy / 1e6:g}, {stress.xy / 1e6:g} MPa"
        symbols.note(ax, high[0], corner[1], words, "right")


def _draw_wave(ax: Axes, wave: Wave, low: np.ndarray, high: np.ndarray, size: float) -> None:
    """Draw an arrow to the entry point of a line through the middle along the direction of travel;
    an S wave has its particle motion beside it."""
    middle, n = (low + high) / 2, np.array(wave.direction)
    with np.errstate(divide="ignore"):
        reach = float(np.min((high - low) / 2 / np.abs(n)))
    tip = middle - (reach + 0.01 * size) * n
    tail = tip - LENGTH * size * n
    symbols.arrow(ax, tuple(tail), tuple(tip))
    left = np.array([-n[1], n[0]])
    x, y = (tail + tip) / 2 + 0.045 * size * left
    symbols.note(ax, x, y, wave.kind, color=LOAD)
    if wave.kind == "S":
        beside = (tail + tip) / 2 - 0.06 * size * left
        half = 0.05 * size * left
        symbols.arrow(ax, tuple(beside - half), tuple(beside + half), style="<|-|>")


def _draw_load(ax: Axes, scene: RockMass, load: PlaneLoad, size: float) -> None:
    if load.kind == "force":
        assert load.at is not None
        at = np.array(load.at)
        tail = at - 1.5 * SHORT * size * np.array(load.direction)
        symbols.arrow(ax, tuple(tail), tuple(at))
        return
    edges = outline_of(scene.domain).edges(load.side, load.opening)
    start, end = edges[:, 0], edges[:, 1]
    if load.kind == "base":
        at, half = (start[0] + end[-1]) / 2, SHORT * size * np.array(load.direction)
        symbols.arrow(ax, tuple(at - half), tuple(at + half), style="<|-|>")
        return
    along = end - start
    length = np.hypot(*along.T)
    out = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]
    if load.opening is not None:
        out = -out  # its edges go around the opening, with the rock outside
    counts = np.maximum(1, np.round(MOST * length / length.sum())).astype(int)
    for a, step, normal, count in zip(start, along, out, counts, strict=True):
        for k in range(count):
            tip = a + (k + 0.5) / count * step
            tail = tip + 0.7 * SHORT * size * normal
            symbols.arrow(ax, tuple(tail), tuple(tip))
