"""The drawing of a scene in the plane: bodies, receivers, waves and loads. A pillar is seen from
the side, y to the right and x up.
"""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.text import Text

from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.sources import PlaneLoad, Wave
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
UNIT = 0.06  # length of arrows at a pillar, of the width of the drawing
OVER = 0.16  # margin for arrows, of the domain's size
LENGTH, SHORT = 0.12, 0.05  # of the domain's size: arrows of waves, and other arrows
MOST = 12  # arrows of a pressure on one edge
FEW = 4  # receivers that are listed with their coordinates
SLENDER = 0.6  # of the length of a slender rock mass, that sizes its arrows instead of its width


def sketch_of(scene: AnyScene) -> Sketch:
    """Return the sketch of a pillar or of a rock mass in the plane."""
    return _of_pillar(scene) if scene.is_column else _of_rock_mass(scene)


def _of_pillar(scene: Scene) -> Sketch:
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
        *_end_load(scene, half, unit),
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


def _end_load(scene: Scene, half: float, unit: np.ndarray) -> list[Artist]:
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


def _of_rock_mass(scene: RockMass) -> Sketch:
    """Return the sketch of a rock mass, cut into blocks."""
    (shapes, low, high), record = bodies(scene), scene.record
    size = float(max((high - low).min(), SLENDER * (high - low).max()))
    shapes += [
        *receivers("point", record.points, "o"),
        *receivers("point of a joint", record.joints, "^"),
        *(shape for wave in scene.waves for shape in _wave(wave, low, high, size)),
        *(shape for load in scene.loads for shape in _load(scene, load, size)),
    ]
    above = high[1] + 0.4 * LENGTH * size
    if scene.gravity is not None:
        at, down = np.array([low[0] + 0.2 * size, above]), np.array(scene.gravity.direction)
        shapes += gravity(at, down, SHORT * size, scene.gravity.acceleration)
    if scene.prestress is not None:
        stress = [scene.prestress.xx / 1e6, scene.prestress.yy / 1e6, scene.prestress.xy / 1e6]
        words = f"prestress {', '.join(f'{part:g}' for part in stress)} MPa"
        shapes.append(note(np.array([high[0], above]), words, "right"))
    margin = OVER * np.maximum(high - low, size)
    places = _listed("points", record.points) + _listed("points of joints", record.joints)
    return Sketch(shapes, low - margin, high + margin, ("x", "y"), size=places)


def _listed(name: str, places: list[list[float]]) -> str:
    """Return the coordinates of a few receivers, or the number of many, as a line."""
    few = ", ".join(f"[{x:g}, {y:g}]" for x, y in places[:FEW])
    words = f"{name} {few} m" if len(places) <= FEW else f"{len(places)} {name}"
    return f"\n{words}" if places else ""


def _wave(wave: Wave, low: np.ndarray, high: np.ndarray, size: float) -> list[Artist]:
    """Return an arrow to the entry point of a line through the middle along the direction of
    travel; beside it the kind of the wave, and of an S wave the particle motion."""
    n = np.array(wave.direction)
    left = np.array([-n[1], n[0]])
    with np.errstate(divide="ignore"):
        reach = float(np.min((high - low) / 2 / np.abs(n)))
    tip = (low + high) / 2 - (reach + 0.01 * size) * n
    middle = tip - LENGTH / 2 * size * n
    kind = note(middle + 0.045 * size * left, wave.kind, "center")
    motion = [shaking(middle - 0.06 * size * left, left, 0.1 * size)] if wave.kind == "S" else []
    return [*motion, pushing(tip, n, LENGTH * size), kind]


def _load(scene: RockMass, load: PlaneLoad, size: float) -> list[Artist]:
    """Return the arrow of a force or a shaken side, or those of a pressure, onto the rock."""
    if load.kind == "force":
        return [pushing(np.array(load.at), np.array(load.direction), 1.5 * SHORT * size)]
    edges = shape_of(scene.domain).edges(load.side, load.opening)
    start, end = edges[:, 0], edges[:, 1]
    if load.kind == "base":
        return [shaking((start[0] + end[-1]) / 2, np.array(load.direction), 2 * SHORT * size)]
    along = end - start
    length = np.hypot(*along.T)
    inwards = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
    if load.opening is not None:
        inwards = -inwards  # its edges go around the opening, with the rock outside
    counts = np.clip(np.round(length / (SHORT * size)), 1, MOST).astype(int)
    return [
        pushing(a + (k + 0.5) / count * step, normal, 0.7 * SHORT * size)
        for a, step, normal, count in zip(start, along, inwards, counts, strict=True)
        for k in range(count)
    ]
