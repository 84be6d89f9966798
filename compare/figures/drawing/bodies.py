"""The bodies of a scene in the plane: blocks by their rock, joints by their set, and sides by what
holds them. A pillar is seen from the side, y to the right and x up.
"""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.partition.pillar import blocks_of_pillar
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.drawing.sketch import EDGE, INK, lines, rock, side
from jointwave.compare.figures.units import in_unit

#: Colours of joint sets, in order; safe for all kinds of colour blindness (Tol 2021, bright).
SETS = ("#4477aa", "#ee6677", "#228833", "#aa3377", "#ccbb44", "#66ccee")
LAYER = "#8a3b12"
DENSE = 3000  # contacts above which the lines of a rock mass are thin


class Looks(NamedTuple):
    """How the bodies of a scene are drawn: the names of the rocks, by the region of a block; of the
    joints name, contacts, colour, width (points) and dashes; and the lines of the boundary [n, 2,
    2], m, by what they are and what holds them, "" if nothing can."""

    rocks: dict[int, str]
    joints: list[tuple[str, np.ndarray, str, float, Any]]
    sides: list[tuple[str, str, np.ndarray]]


def seen(scene: AnyScene) -> tuple[Blocks, slice]:
    """Return the blocks of a scene in the plane, and how to turn their places: to the right and
    up."""
    if scene.is_column:
        return blocks_of_pillar(scene, 2), slice(None, None, -1)
    return blocks_of_scene(scene), slice(None)


def bodies(scene: AnyScene) -> tuple[list[Artist], np.ndarray, np.ndarray]:
    """Return the shapes of the bodies, and the rectangle around them, low and high [2], m."""
    blocks, turn = seen(scene)
    looks = _of_pillar(scene, blocks) if scene.is_column else _of_rock_mass(scene, blocks)
    contacts, corners, shapes = blocks.contacts, blocks.outlines.corners[:, turn], list[Artist]()
    for k, (region, name) in enumerate(looks.rocks.items()):
        own = np.flatnonzero(blocks.body.region == region)
        shapes.append(rock(name, [blocks.outlines.of(i)[:, turn] for i in own], k))
    for name, own, *look in looks.joints:
        shapes += lines(name, contacts.ends[own][..., turn], *look)
    for name, held, ends in looks.sides:
        shapes += side(name, ends, held) if held else lines(name, ends, INK, 1.0)
    return shapes, corners.min(axis=0), corners.max(axis=0)


def _of_pillar(scene: Scene, blocks: Blocks) -> Looks:
    half, length, of = scene.pillar.side / 2, scene.pillar.length, blocks.contacts.joint_set
    here, there = blocks.body.region[blocks.contacts.blocks].T
    plain = (of == 0) | ((of == NO_SET) & (here != there))
    joints: list[Any] = [("_joints", plain, EDGE, min(0.8, 40 / (1 + plain.sum())), "-")]
    for k, layer in enumerate(scene.soft_layers):
        stiffness = layer.own_stiffness(scene.pillar.block)
        words = f", {in_unit(stiffness, 'Pa/m')}" if stiffness is not None else ""
        name, dashes = f"layer at y = {layer.y:g} m{words}", "-" if k == 0 else (0, (2, 1))
        joints.append((name, of == 1 + k, LAYER, 2.2, dashes))
    x = np.array([[-half, half]])
    start, end = (np.stack([np.full((1, 2), y), x], axis=-1) for y in (0.0, length))
    along = np.concatenate([start, end]).swapaxes(0, 1)
    rocks = {k: f"_segment {k}" for k in range(len(scene.parts))}
    ends = ("start", scene.ends.start, start), ("end", scene.ends.end, end)
    return Looks(rocks, joints, [("_sides", "", along), *ends])


def _of_rock_mass(scene: RockMass, blocks: Blocks) -> Looks:
    edges, of_set = blocks.boundary, blocks.contacts.joint_set
    width = 0.4 if len(of_set) > DENSE else 0.9
    joints: list[Any] = [("no joint", of_set == NO_SET, EDGE, width, (0, (1.0, 2.0)))]
    for k, one in enumerate(scene.joint_sets):
        joints.append((one.name, of_set == k, SETS[k % len(SETS)], width, "-"))
    held = [getattr(scene.boundaries, name, "free") for name in shape_of(scene.domain).sides]
    of = np.array(held)[edges.side]  # openings are free
    sides = [("side", one, edges.ends[of == one]) for one in dict.fromkeys(held)]
    rocks = {-1: "_rock"} | {k: one.name for k, one in enumerate(scene.regions)}
    return Looks(rocks, joints, sides)
