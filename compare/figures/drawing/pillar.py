"""The drawing of a pillar from the side, y to the right and x up."""

from itertools import pairwise

import numpy as np
from matplotlib.artist import Artist
from matplotlib.text import Text

from jointwave.cases.partition.pillar import block_ends, welds
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.drawing.sketch import (
    EDGE,
    INK,
    Sketch,
    gravity,
    lines,
    note,
    pushing,
    receivers,
    rock,
    shaking,
    side,
)
from jointwave.compare.figures.units import unit_for

LAYER = "#8a3b12"
MOST = 400  # blocks that are drawn individually
THIN, THICK = 0.07, 0.12  # limits of the pillar's thickness over the width of the drawing
ROOM = 0.11  # beside the pillar, of the width of the drawing
UNIT = 0.06  # length of arrows, of the width of the drawing


def sketch_of(scene: Scene) -> Sketch:
    """Return the sketch of a pillar, its thickness stretched if it were too thin."""
    pillar, half = scene.pillar, scene.pillar.side / 2
    stretch = max(1.0, THIN * pillar.length / (1 - 2 * ROOM) / pillar.side)
    width = max(pillar.length / (1 - 2 * ROOM), stretch * pillar.side / THICK)
    unit, beside = UNIT * width * np.array([1.0, 1 / stretch]), (width - pillar.length) / 2
    above = half + 0.15 * unit[1]
    sides = [[(0, level), (pillar.length, level)] for level in (-half, half)]
    shapes = [
        *_blocks(scene, half),
        *_layers(scene, half),
        *lines("_sides", sides, INK, 1.0),
        *side("start", _across([0.0], half), scene.ends.start),
        *side("end", _across([pillar.length], half), scene.ends.end),
        *receivers("section: stress", [(y, above) for y in scene.record.stress], "v"),
        *receivers("point: velocity", [(y, 0.0) for y in scene.record.velocity], "o"),
        *_load(scene, half, unit),
    ]
    corner = np.array([pillar.length, half + 0.7 * unit[1]])
    if scene.gravity is not None:
        down = np.array(scene.gravity.direction)[[1, 0]]
        shapes += gravity(corner + 0.3 * unit * down, down, 0.6 * unit, scene.gravity.acceleration)
    if scene.prestress is not None and scene.prestress.normal:
        words = f"prestress {_number(scene.prestress.normal, 'Pa')}"
        shapes.append(note(corner * [0.5, 1.0], words, "center"))
    blocks = f"in {len(scene.parts)} segments" if scene.segments else f"of {pillar.block:g} m"
    average = " on average" if scene.scatter else ""
    size = (
        f": {scene.block_count:,} blocks {blocks}{average}, {pillar.side:g} m × {pillar.side:g} m"
    )
    over = 1.1 if any(isinstance(one, Text) and one.get_text() for one in shapes) else 0.4
    return Sketch(
        shapes,
        np.array([-beside, -half - 0.5 * unit[1]]),
        np.array([pillar.length + beside, half + over * unit[1]]),
        ("y", "x"),
        stretch,
        size + (f"; thickness × {stretch:.2g}" if stretch > 1.01 else ""),
    )


def block_edges(scene: Scene) -> list[float]:
    """Return y of the edges of drawn blocks, m: of all, or a single one for a pillar with many; one
    per segment for segments without joints or with many blocks."""
    every, starts = block_ends(scene), [one.start for one in scene.parts]
    edges = every[np.r_[True, ~welds(scene), True]]
    return np.union1d(edges if len(edges) <= MOST + 1 else every[[0, -1]], starts).tolist()


def _across(places: list[float], half: float) -> np.ndarray:
    """Return lines across the pillar at some y [n, 2, 2], m."""
    return np.array([[(y, -half), (y, half)] for y in places])


def _blocks(scene: Scene, half: float) -> list[Artist]:
    """Return the blocks, by the segment that holds them, and the joints between them."""
    edges = block_edges(scene)
    stops = [one.stop for one in scene.parts] if scene.segments else [np.inf]
    segment = np.searchsorted(stops, (np.array(edges[1:]) + edges[:-1]) / 2)
    ends = np.array(list(pairwise(edges)))
    corners = np.stack([ends[:, [0, 1, 1, 0]], np.full((len(ends), 4), half) * [-1, -1, 1, 1]], 2)
    rocks = [rock(f"_segment {k}", list(corners[segment == k]), k) for k in range(len(stops))]
    joints = _across(edges[1:-1], half)
    return [*rocks, *lines("_joints", joints, EDGE, min(0.8, 40 / len(edges)))]


def _layers(scene: Scene, half: float) -> list[Artist]:
    """Return the soft layers, named by their place and stiffness."""
    shapes: list[Artist] = []
    for k, layer in enumerate(scene.soft_layers):
        stiffness = layer.own_stiffness(scene.pillar.block)
        words = f", {_number(stiffness, 'Pa/m')}" if stiffness is not None else ""
        name, dashes = f"layer at y = {layer.y:g} m{words}", "-" if k == 0 else (0, (2, 1))
        shapes += lines(name, _across([layer.y], half), LAYER, 2.2, dashes)
    return shapes


def _load(scene: Scene, half: float, unit: np.ndarray) -> list[Artist]:
    """Return the arrow of the load at the start; in words what acts across the drawing or turns."""
    load = scene.load
    across, along, depth = load.direction
    direction, in_plane = np.array([along, across]), np.hypot(along, across) > 0.05
    words = []
    if load.arm is not None:
        words.append(f"couple about ({', '.join(f'{part:.3g}' for part in load.direction)})")
    elif abs(depth) > 0.05:
        words.append("load also along z" if in_plane else "load along z")
    if load.is_eccentric and load.at[1]:
        words.append(f"at z = {load.at[1]:g} m")
    if not load.amplitude:
        return []
    shapes = [note(unit * [-0.3, 0.7] + [0.0, half], ", ".join(words), "left")] if words else []
    if in_plane and load.arm is None and scene.shakes_base:
        shapes.append(shaking(unit * [-0.7, 0.0], direction, unit))
    elif in_plane and load.arm is None:
        tip = np.array([0.0, load.at[0] if load.is_eccentric else 0.0])
        shapes.append(pushing(tip, direction, unit))
    return shapes


def _number(value: float, si: str) -> str:
    unit = unit_for(si, abs(value))
    return f"{value / unit.size:.3g} {unit.name}"
