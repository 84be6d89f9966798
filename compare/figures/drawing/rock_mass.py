"""The drawing of a rock mass: joints, boundaries, waves and loads, receivers."""

import numpy as np
from matplotlib.artist import Artist

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad, Wave
from jointwave.compare.figures.drawing.sketch import (
    EDGE,
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

#: Colours of joint sets, in order; safe for all kinds of colour blindness (Tol 2021, bright).
SETS = ("#4477aa", "#ee6677", "#228833", "#aa3377", "#ccbb44", "#66ccee")
OVER = 0.16  # margin for arrows, of the domain's size
LENGTH, SHORT = 0.12, 0.05  # of the domain's size: arrows of waves, and other arrows
MOST = 12  # arrows of a pressure on one edge
FEW = 4  # receivers that are listed with their coordinates
DENSE = 3000  # contacts above which their lines are thin
SLENDER = 0.6  # of the length of a slender rock mass, that sizes its arrows instead of its width


def sketch_of(scene: RockMass) -> Sketch:
    """Return the sketch of a rock mass, cut into blocks."""
    blocks, record = blocks_of_scene(scene), scene.record
    low, high = (at(blocks.outlines.corners, axis=0) for at in (np.min, np.max))
    size = float(max((high - low).min(), SLENDER * (high - low).max()))
    shapes = [
        *_blocks(scene, blocks),
        *_joints(scene, blocks.contacts),
        *_sides(scene, blocks.boundary),
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


def _blocks(scene: RockMass, blocks: Blocks) -> list[Artist]:
    """Return the blocks of every region of rock."""
    return [
        rock(name, [blocks.outlines.of(i) for i in np.flatnonzero(blocks.body.region == k - 1)], k)
        for k, name in enumerate(["_rock", *(one.name for one in scene.regions)])
    ]


def _joints(scene: RockMass, contacts: Facets) -> list[Artist]:
    """Return the contacts of every joint set, and cuts through intact rock."""
    ends, of, width = contacts.ends, contacts.joint_set, 0.4 if len(contacts) > DENSE else 0.9
    shapes = lines("no joint", ends[of == -1], EDGE, width, (0, (1.0, 2.0)))
    for k, one in enumerate(scene.joint_sets):
        shapes += lines(one.name, ends[of == k], SETS[k % len(SETS)], width)
    return shapes


def _sides(scene: RockMass, edges: Facets) -> list[Artist]:
    """Return the boundary by its condition; openings are free."""
    shapes, sides = list[Artist](), shape_of(scene.domain).sides
    held = np.array([getattr(scene.boundaries, name, "free") for name in sides])
    for condition in dict.fromkeys(held.tolist()):
        shapes += side("side", edges.ends[(held == condition)[edges.side]], condition)
    return shapes


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
