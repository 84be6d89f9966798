"""Locate points among blocks: the blocks around a point, or the nearest contact."""

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.relations import groups, joined

SAME = 1e-9  #: tolerance over the domain's diagonal: nearer places coincide


def tolerance_of(blocks: Blocks) -> float:
    """Return the distance below which places coincide, m."""
    return SAME * float(np.linalg.norm(np.ptp(blocks.body.vertices, axis=0)))


def blocks_at(blocks: Blocks, points: np.ndarray) -> list[np.ndarray]:
    """Return the blocks in or on which each point (float array [m, d], m) lies, ascending."""
    half, beyond = blocks.body.halves(), tolerance_of(blocks)
    reach = blocks.body.places(half) + beyond
    found = []
    for point in points:
        inside = np.ones(blocks.count, bool)
        inside[half.cell[half.outward @ point > reach]] = False
        found.append(np.flatnonzero(inside))
    return found


def sides_at(blocks: Blocks, points: np.ndarray, sets: int) -> list[list[int]]:
    """Return the blocks that read each point (float array [m, d], m): one, or one on each side of
    joints; none outside the rock. sets : number of leading joint sets that are joints.

    Of blocks that meet at the point without a joint between them, the first is chosen.
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
    """Return each block's neighbours across cuts through intact rock of one region."""
    contacts, region = blocks.contacts, blocks.body.region
    through = ~contacts.of_joints(sets)
    through &= np.diff(region[contacts.blocks], axis=1)[:, 0] == 0
    pairs = contacts.blocks[through]
    i, j = np.concatenate([pairs, pairs[:, ::-1]], axis=1).reshape(-1, 2).T  # both ways
    return {int(i[own[0]]): j[own].tolist() for own in groups(i)}


def contact_at(blocks: Blocks, points: np.ndarray, sets: int) -> np.ndarray:
    """Return the contact of the leading joint sets that is nearest to each point (float array [m,
    d], m); of equally near ones, the first of the first set.

    Raises ValueError if there is no such contact.
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
    """Return the distance of a point [d] from a convex plane piece, m; corners [n, d], m."""
    edge, off = np.roll(corners, -1, axis=0) - corners, point - corners
    if corners.shape[1] == 3 and (np.cross(edge, off) @ normal >= 0).all():
        return abs(float(off[0] @ normal))  # the point projects into the piece
    along = (edge * off).sum(axis=1) / np.maximum((edge**2).sum(axis=1), np.finfo(float).tiny)
    away = np.linalg.norm(off - np.clip(along, 0.0, 1.0)[:, None] * edge, axis=1)
    return float(away.min())
