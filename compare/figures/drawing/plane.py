"""The drawing of a scene in the plane: blocks by rock, joints by set, sides by boundary condition,
and loads. A pillar is seen from the side, y to the right and x up.
"""

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.text import Text

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.partition.pillar import blocks_of_pillar
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.drawing import sketch
from jointwave.compare.figures.drawing.sketch import EDGE, INK, SETS, Sketch
from jointwave.compare.figures.style import in_unit

THIN, THICK = 0.07, 0.12  # limits of the pillar's thickness over the width of the drawing
ROOM = 0.11  # margin beside the pillar, over the width of the drawing
UNIT = 0.06  # length of arrows at a pillar, over the width of the drawing
OVER = 0.16  # margin for arrows, over the domain's size
FEW = 4  # most receivers listed with their coordinates
SLENDER = 0.6  # least size that scales arrows, over the length of a rock mass
LAYER = "#8a3b12"
DENSE = 3000  # contacts above which the lines of a rock mass are thin

#: Name, contacts, colour, width (points) and dashes of joints.
Joints = list[tuple[str, np.ndarray, str, float, Any]]


def sketch_of(scene: AnyScene) -> Sketch:
    """Return the sketch of a pillar or of a rock mass in the plane."""
    return _of_pillar(scene) if scene.is_column else _of_rock_mass(scene)


def seen(scene: AnyScene) -> tuple[Blocks, slice]:
    """Return the plane blocks of a scene, and the slice that orders coordinates (right, up)."""
    if scene.is_column:
        return blocks_of_pillar(scene, 2), slice(None, None, -1)
    return blocks_of_scene(scene), slice(None)


def _bodies(blocks: Blocks, turn: slice, rocks: dict[int, str], joints: Joints) -> list[Artist]:
    """Return the shapes of the blocks, grouped by region and named after it, and of the joints."""
    of, outlines = blocks.body.region, blocks.outlines
    shapes = [
        sketch.rock(name, [outlines.of(i)[:, turn] for i in np.flatnonzero(of == region)], k)
        for k, (region, name) in enumerate(rocks.items())
    ]
    for name, own, *look in joints:
        shapes += sketch.lines(name, blocks.contacts.ends[own][..., turn], *look)
    return shapes


def _of_pillar(scene: Scene) -> Sketch:
    """Return the sketch of a pillar; its thickness is stretched if too thin."""
    (blocks, turn), pillar, half = seen(scene), scene.pillar, scene.pillar.side / 2
    of = blocks.contacts.joint_set
    here, there = blocks.body.region[blocks.contacts.blocks].T
    plain = (of == 0) | ((of == NO_SET) & (here != there))
    joints: Joints = [("_joints", plain, EDGE, min(0.8, 40 / (1 + plain.sum())), "-")]
    for k, layer in enumerate(scene.soft_layers):
        stiffness = layer.own_stiffness(pillar.block) or scene.joints.normal_stiffness
        words = f", {in_unit(stiffness, 'Pa/m')}" if stiffness is not None else ""
        name, dashes = f"layer at y = {layer.y:g} m{words}", "-" if k == 0 else (0, (2, 1))
        joints.append((name, of == 1 + k, LAYER, 2.2, dashes))
    along = np.array([[[y, x] for y in (0.0, pillar.length)] for x in (-half, half)])
    start, end = along.swapaxes(0, 1)[:, None]
    stretch = max(1.0, THIN * pillar.length / (1 - 2 * ROOM) / pillar.side)
    width = max(pillar.length / (1 - 2 * ROOM), stretch * pillar.side / THICK)
    unit, beside = UNIT * width * np.array([1.0, 1 / stretch]), (width - pillar.length) / 2
    above = half + 0.15 * unit[1]
    shapes = [
        *_bodies(blocks, turn, {k: f"_segment {k}" for k in range(len(scene.parts))}, joints),
        *sketch.lines("_sides", along, INK, 1.0),
        *sketch.side("start", start, scene.ends.start),
        *sketch.side("end", end, scene.ends.end),
        *sketch.receivers("section: stress", [(y, above) for y in scene.record.stress], "v"),
        *sketch.receivers("point: velocity", [(y, 0.0) for y in scene.record.velocity], "o"),
        *_end_load(scene, half, unit),
    ]
    corner = np.array([pillar.length, half + 0.7 * unit[1]])
    if scene.gravity is not None:
        down = np.array(scene.gravity.direction)[[1, 0]]
        tip, long = corner + 0.3 * unit * down, 0.6 * unit
        shapes += sketch.gravity(tip, down, long, scene.gravity.acceleration)
    if scene.prestress is not None and scene.prestress.normal:
        words = f"prestress {in_unit(scene.prestress.normal, 'Pa')}"
        shapes.append(sketch.note(corner * [0.5, 1.0], words, "center"))
    cut = f"in {len(scene.parts)} segments" if scene.segments else f"of {pillar.block:g} m"
    cut += " on average" * (scene.scatter is not None)
    size = f": {scene.block_count:,} blocks {cut}, {pillar.side:g} m × {pillar.side:g} m"
    size += f"; thickness × {stretch:.2g}" if stretch > 1.01 else ""
    over = 1.1 if any(isinstance(one, Text) and one.get_text() for one in shapes) else 0.4
    low = np.array([-beside, -half - 0.5 * unit[1]])
    high = np.array([pillar.length + beside, half + over * unit[1]])
    return Sketch(shapes, low, high, ("y", "x"), stretch, size, ticks="x")


def _end_load(scene: Scene, half: float, unit: np.ndarray) -> list[Artist]:
    """Return the arrow of the load at the start, and words for what an arrow cannot show."""
    load = scene.load
    if not load.amplitude:
        return []
    across, along, depth = load.direction
    direction, in_plane = np.array([along, across]), np.hypot(along, across) > 0.05
    words = []
    if load.arm is not None:
        words.append(f"couple about ({', '.join(f'{part:.3g}' for part in load.direction)})")
    elif abs(depth) > 0.05:
        words.append("load also along z" if in_plane else "load along z")
    if load.is_eccentric and load.at[1]:
        words.append(f"at z = {load.at[1]:g} m")
    shapes = list[Artist]()
    if words:
        shapes.append(sketch.note(unit * [-0.3, 0.7] + [0.0, half], ", ".join(words), "left"))
    if in_plane and load.arm is None and scene.shakes_base:
        shapes.append(sketch.shaking(unit * [-0.7, 0.0], direction, unit))
    elif in_plane and load.arm is None:
        shapes.append(sketch.pushing(np.array([0.0, load.at[0]]), direction, unit))
    return shapes


def _of_rock_mass(scene: RockMass) -> Sketch:
    """Return the sketch of a rock mass, cut into blocks."""
    (blocks, turn), domain = seen(scene), shape_of(scene.domain)
    edges, of_set = blocks.boundary, blocks.contacts.joint_set
    width = 0.4 if len(of_set) > DENSE else 0.9
    joints: Joints = [("no joint", of_set == NO_SET, EDGE, width, (0, (1.0, 2.0)))]
    for k, one in enumerate(scene.joint_sets):
        joints.append((one.name, of_set == k, SETS[k % len(SETS)], width, "-"))
    rocks = {-1: "_rock"} | {k: one.name for k, one in enumerate(scene.regions)}
    shapes = _bodies(blocks, turn, rocks, joints)
    held = [getattr(scene.boundaries, name, "free") for name in domain.sides]
    for kind in dict.fromkeys(held):  # openings are free
        shapes += sketch.side("side", edges.ends[np.array(held)[edges.side] == kind], kind)
    low, high = (at(blocks.outlines.corners, axis=0) for at in (np.min, np.max))
    size = float(max((high - low).min(), SLENDER * (high - low).max()))
    words = ""
    for name, places in (
        ("points", scene.record.points),
        ("points of joints", scene.record.joints),
    ):
        few = ", ".join(f"[{x:g}, {y:g}]" for x, y in places[:FEW])
        listed = f"{name} {few} m" if len(places) <= FEW else f"{len(places)} {name}"
        words += f"\n{listed}" if places else ""
    shapes += sketch.surroundings(scene, domain, np.eye(2), size)
    margin = OVER * np.maximum(high - low, size)
    return Sketch(shapes, low - margin, high + margin, ("x", "y"), size=words)
