"""The drawing of a rock mass: joints, boundaries, waves and loads, receivers."""

import numpy as np
from matplotlib.artist import Artist

from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.rock_mass import RockMass
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

OVER = 0.16  # margin for arrows, of the domain's size
LENGTH, SHORT = 0.12, 0.05  # of the domain's size: arrows of waves, and other arrows
MOST = 12  # arrows of a pressure on one edge
FEW = 4  # receivers that are listed with their coordinates
SLENDER = 0.6  # of the length of a slender rock mass, that sizes its arrows instead of its width


def sketch_of(scene: RockMass) -> Sketch:
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
