"""The blocks of a pillar: a box cut by one set of joints across its axis."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks, blocks_of
from jointwave.cases.geometry.cell_complex import NO_SET, box
from jointwave.cases.geometry.cut import cut, planes_of
from jointwave.cases.geometry.sets import SPREAD
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import Part

#: Sides of a pillar: its two ends, and the lateral surface.
SIDES = "start", "end", "sides"
TOLERANCE = 1e-6  # tolerance over the thinnest block: nearer points coincide


def blocks_of_pillar(
    scene: Scene, dim: int = 1, layers: Mapping[int, float] | None = None
) -> Blocks:
    """Return the blocks of a pillar from the loaded end on, in 1 to 3 dimensions; in more than one,
    y runs along the pillar and its axis is x = z = 0.

    `joint_set` of a contact is 0 for [joints], 1 + k for soft layer k, and NO_SET without a joint;
    `body.region` is the index of a block's part in `scene.parts`; `side` of a boundary facet is an
    index in SIDES. layers : thickness (m) of joints that become blocks of their own, without joints
    at their faces; half of it is taken from each neighbour, and their regions follow the parts.
    """
    y, along = block_ends(scene), dim // 2
    law, blocks = np.where(welds(scene), NO_SET, 0), [one.blocks for one in scene.parts]
    for k, layer in enumerate(scene.soft_layers):
        law[np.abs(y[1:-1] - layer.y).argmin()] = 1 + k
    region = np.repeat(np.arange(len(blocks)), blocks)
    for k, (joint, thickness) in enumerate(sorted((layers or {}).items())):
        at = joint + k + 1
        y = np.insert(y, at, y[at] - thickness / 2)
        y[at + 1] += thickness / 2
        law, region = np.insert(law, at, NO_SET), np.insert(region, at, len(scene.parts) + k)
        law[at - 1] = NO_SET
    if (np.diff(y) <= 0).any():
        raise SceneError(scene.where, "soft_layers", None, "are thicker than a block is long")
    low, high = np.full((2, dim), scene.pillar.side / 2) * [[-1], [1]]
    low[along], high[along] = y[0], y[-1]
    planes = planes_of(np.eye(dim)[along], np.zeros(1, np.int64), [y[1:-1]], joint_set=0)
    tolerance = TOLERANCE * float(np.diff(y).min())
    body = cut(box(low, high), planes, tolerance).body
    inner, joint_set = body.inner, body.joint_set.copy()
    joint_set[inner] = law[body.sides[inner].min(axis=1)]
    side = np.full(len(body.sides), 2)
    ends = np.flatnonzero(~inner & (np.abs(body.normals[body.plane, along]) > 0.5))
    side[ends[np.argsort(body.sides[ends].max(axis=1))]] = 0, 1
    body = replace(body, joint_set=joint_set, region=region, side=side)
    return blocks_of(body, tolerance, in_rows=False)


def block_ends(scene: Scene) -> np.ndarray:
    """Return the starts of all blocks and the end of the last, m [N + 1]."""
    spacing, found = scene.scatter.spacing if scene.scatter else 0.0, []
    for i, one in enumerate(scene.parts):
        thickness = np.ones(one.blocks)
        if spacing and not _is_intact(scene, one):
            thickness += spacing * drawn(scene, i, 0, one.blocks)
        before = np.append(0.0, np.cumsum(thickness)[:-1])
        found.append(one.start + (one.stop - one.start) * before / thickness.sum())
    return np.append(np.concatenate(found), scene.pillar.length)


def welds(scene: Scene) -> np.ndarray:
    """Return which contacts have intact rock on both sides, bool array [N - 1]: only soft layers
    make these joints."""
    intact = [_is_intact(scene, one) for one in scene.parts]
    of_block = np.repeat(intact, [one.blocks for one in scene.parts])
    return of_block[1:] & of_block[:-1]


def drawn(scene: Scene, part: int, what: int, count: int) -> np.ndarray:
    """Return uniformly distributed random numbers [count] of mean 0 and standard deviation 1.

    what : 0 for spacings, 1 for compliances; each has its own random stream in each part.
    """
    assert scene.scatter is not None
    draws = np.random.default_rng([scene.scatter.seed, what, part]).random(count)
    return SPREAD * (2 * draws - 1)


def _is_intact(scene: Scene, part: Part) -> bool:
    """Return whether a part has no joints."""
    return part.segment is not None and not scene.segments[part.segment].joints
