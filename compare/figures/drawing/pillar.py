"""The drawing of a pillar from the side, y to the right and x up."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.text import Text

from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.drawing.bodies import bodies
from jointwave.compare.figures.drawing.sketch import (
    Sketch,
    gravity,
    note,
    pushing,
    receivers,
    shaking,
)
from jointwave.compare.figures.units import in_unit

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
    shapes = [
        *bodies(scene)[0],
        *receivers("section: stress", [(y, above) for y in scene.record.stress], "v"),
        *receivers("point: velocity", [(y, 0.0) for y in scene.record.velocity], "o"),
        *_load(scene, half, unit),
    ]
    corner = np.array([pillar.length, half + 0.7 * unit[1]])
    if scene.gravity is not None:
        down = np.array(scene.gravity.direction)[[1, 0]]
        shapes += gravity(corner + 0.3 * unit * down, down, 0.6 * unit, scene.gravity.acceleration)
    if scene.prestress is not None and scene.prestress.normal:
        words = f"prestress {in_unit(scene.prestress.normal, 'Pa')}"
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
