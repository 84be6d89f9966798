"""Surroundings of the blocks of a rock mass in a drawing: receivers, waves, loads, gravity and
prestress."""

from collections.abc import Iterator

import numpy as np
from matplotlib.artist import Artist

from jointwave.cases.partition.shape import Shape
from jointwave.cases.schema.pulse import PlaneLoad
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.figures.drawing.sketch import gravity, note, pushing, receivers, shaking
from jointwave.results.stress import stress_components

LENGTH, SHORT = 0.12, 0.05  # of the domain's size: arrows of waves, and other arrows
MOST = 12  # arrows of a pressure on one edge


def surroundings(
    scene: RockMass, domain: Shape, onto: np.ndarray, size: float, wide: float = 1.0
) -> list[Artist]:
    """Return the shapes of all that is not rock.

    onto : [2, d], from places to the drawing. size : m, that arrows are a part of. wide : by how
    much blocks are farther apart in the drawing.
    """
    middle, record = (domain.low + domain.high) / 2, scene.record

    def seen(place: np.ndarray) -> np.ndarray:
        return onto @ (middle + wide * (place - middle))

    shapes = [
        *receivers("point", [onto @ one for one in record.points], "o"),
        *receivers("point of a joint", [onto @ one for one in record.joints], "^"),
    ]
    half = wide * (domain.high - domain.low) / 2
    for wave in scene.waves:
        n, along = np.array(wave.direction), onto @ wave.direction
        left = np.array([-along[1], along[0]])
        with np.errstate(divide="ignore"):  # to where a line through the middle enters
            tip = middle - (float(np.min(half / np.abs(n))) + 0.01 * size) * n
        at = onto @ (tip - LENGTH / 2 * size * n)
        if wave.kind == "S":
            moved = left if wave.polarisation is None else onto @ wave.polarisation
            shapes.append(shaking(at - 0.06 * size * left, moved, 0.1 * size))
        shapes.append(pushing(onto @ tip, along, LENGTH * size))
        shapes.append(note(at + 0.045 * size * left, wave.kind, "center"))
    for load in scene.loads:
        length, direction = 1.5 * SHORT * size, onto @ (load.direction or 0 * middle)
        if load.kind == "force":
            shapes.append(pushing(seen(np.array(load.at)), direction, length))
        elif load.kind == "base":
            corners = np.concatenate([one for one, _ in domain.faces_of(load.side)])
            at = seen((corners.min(axis=0) + corners.max(axis=0)) / 2)
            shapes.append(shaking(at, direction, 2 * SHORT * size))
        elif load.side or len(onto.T) == 2:  # openings in space are hidden
            for tip, normal, long in _pressure(load, domain, size):
                shapes.append(pushing(seen(tip), onto @ normal, long))
    places = np.concatenate([corners for corners, _ in domain.faces]) @ onto.T
    low, high = places.min(axis=0), places.max(axis=0)
    above = high[1] + 0.4 * LENGTH * size
    if scene.gravity is not None:
        at, down = np.array([low[0] + 0.2 * size, above]), onto @ scene.gravity.direction
        shapes += gravity(at, down, SHORT * size, scene.gravity.acceleration)
    if scene.prestress is not None:
        parts = [scene.prestress.tensor[ij] for ij in stress_components(len(middle)).values()]
        words = f"prestress {', '.join(f'{part / 1e6:g}' for part in parts)} MPa"
        shapes.append(note(np.array([high[0], above]), words, "right"))
    return shapes


def _pressure(
    load: PlaneLoad, domain: Shape, size: float
) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    """Yield tip, direction and length of the arrows of a pressure, in the plane as many as an edge
    has room for, in space one a face."""
    for corners, normal in domain.faces_of(load.side, load.opening):
        inwards = -normal if load.opening is None else normal
        if len(normal) == 3:
            yield corners.mean(axis=0), inwards, LENGTH * size
            continue
        length = float(np.linalg.norm(corners[1] - corners[0]))
        count = int(np.clip(round(length / (SHORT * size)), 1, MOST))
        for part in (np.arange(count) + 0.5) / count:
            yield corners[0] + part * (corners[1] - corners[0]), inwards, 0.7 * SHORT * size
