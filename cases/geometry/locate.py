"""Location of points among blocks, in any dimension: their block, or their contact."""

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.relations import groups, joined

SAME = 1e-9  #: of the size of all blocks: the distance below which places are one


def tolerance_of(blocks: Blocks) -> float:
    """Return the length below which places are one, m."""
    return SAME * float(np.linalg.norm(np.ptp(blocks.body.vertices, axis=0)))


def blocks_at(blocks: Blocks, points: np.ndarray) -> list[np.ndarray]:
    """Return the blocks that each point (float array [m, d], m) lies in or on, ascending."""
    half, beyond = blocks.body.halves(), tolerance_of(blocks)
    reach = blocks.body.places(half) + beyond
    found = []
    for point in points:
        inside = np.ones(blocks.count, bool)
        inside[half.cell[half.outward @ point > reach]] = False
        found.append(np.flatnonzero(inside))
    return found


def sides_at(blocks: Blocks, points: np.ndarray, sets: int) -> list[list[int]]:
    """Return the blocks that each point (float array [m, d], m) is read in: one and, on joints, one
    on each side; none outside the rock. sets : number of joint sets, the first ones of all.

    Of blocks that share a point without a joint between them it is the first.
    """
    found = blocks_at(blocks, points)
    near = rock_neighbours(blocks, sets) if any(len(here) > 1 for here in found) else {}
    for k, here in enumerate(found):
        beside = [(i, near.get(block, [])) for i, block in enumerate(here.tolist())]
        pairs = [(i, j) for i, own in beside for j in np.flatnonzero(np.isin(here, own))]
        group = joined(np.array(pairs, dtype=np.int64), len(here))
        found[k] = here[np.sort(np.unique(group, return_index=True)[1])]
    return [here.tolist() for here in found]


def rock_neighbours(blocks: Blocks, sets: int) -> dict[int, list[int]]:
    """Return the blocks beside each across cuts through intact rock of one region."""
    contacts, region = blocks.contacts, blocks.body.region
    through = ~contacts.of_joints(sets)
    through &= np.diff(region[contacts.blocks], axis=1)[:, 0] == 0
    pairs = contacts.blocks[through]
    i, j = np.concatenate([pairs, pairs[:, ::-1]], axis=1).reshape(-1, 2).T  # both ways
    return {int(i[own[0]]): j[own].tolist() for own in groups(i)}


def contact_at(blocks: Blocks, points: np.ndarray, sets: int) -> np.ndarray:
    """Return the contact of the first joint sets that is nearest to each point (float array [m, d],
    m); of those as near, the first of the first set.

    Raises ValueError where there is no such contact.
    """
    chosen = np.flatnonzero(blocks.contacts.of_joints(sets))
    chosen = chosen[np.argsort(blocks.contacts.joint_set[chosen], kind="stable")]
    if not len(chosen):
        raise ValueError("there is no contact")
    outlines, centres = blocks.contacts.outlines, blocks.contacts.centroid[chosen]
    owner = np.repeat(np.arange(len(blocks.contacts)), np.diff(outlines.first))
    reach = np.linalg.norm(outlines.corners - blocks.contacts.centroid[owner], axis=1)
    reach = np.maximum.reduceat(reach, outlines.first[:-1])[chosen]
    beyond, found = tolerance_of(blocks), []
    for point in points:
        away = np.linalg.norm(centres - point, axis=1)
        near = chosen[away - reach <= away.min() + beyond]
        off = np.array(
            [distance_from(outlines.of(k), blocks.contacts.normal[k], point) for k in near]
        )
        found.append(near[np.argmax(off <= off.min() + beyond)])
    return np.array(found, dtype=np.int64)


def distance_from(corners: np.ndarray, normal: np.ndarray, point: np.ndarray) -> float:
    """Return the distance of a point [d] from a convex piece of a plane, m; corners [n, d]."""
    edge, off = np.roll(corners, -1, axis=0) - corners, point - corners
    if corners.shape[1] == 3 and (np.cross(edge, off) @ normal >= 0).all():
        return abs(float(off[0] @ normal))  # before the piece itself, not beyond one of its edges
    along = (edge * off).sum(axis=1) / np.maximum((edge**2).sum(axis=1), np.finfo(float).tiny)
    away = np.linalg.norm(off - np.clip(along, 0.0, 1.0)[:, None] * edge, axis=1)
    return float(away.min())
