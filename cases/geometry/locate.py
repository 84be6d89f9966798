"""Where points lie among blocks, in any dimension: in which of them, and at which contact."""

from collections.abc import Iterator

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.measure import Outlines

SAME = 1e-9  #: of the size of all blocks: the distance below which places are one


def tolerance_of(blocks: Blocks) -> float:
    """Return the length below which places are one, m."""
    return SAME * float(np.linalg.norm(np.ptp(blocks.body.vertices, axis=0)))


def blocks_at(blocks: Blocks, points: np.ndarray) -> list[np.ndarray]:
    """Return the blocks that each point (float array [m, d], m) lies in or on, ascending."""
    half, beyond = blocks.body.halves(), tolerance_of(blocks)
    reach = (blocks.body.origins(half) * half.outward).sum(axis=1) + beyond
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
    found = [set(here.tolist()) for here in blocks_at(blocks, points)]
    near = rock_neighbours(blocks, sets) if any(len(here) > 1 for here in found) else {}
    return [[min(side) for side in _joined(here, near)] for here in found]


def _joined(blocks: set[int], near: dict[int, list[int]]) -> Iterator[set[int]]:
    """Yield blocks in groups that are joined by intact rock, that of the first block first."""
    left = set(blocks)
    while left:
        side, reached = set(), [min(left)]
        while reached:
            side.add(block := reached.pop())
            reached += (left - side).intersection(near.get(block, []))
        left -= side
        yield side


def rock_neighbours(blocks: Blocks, sets: int) -> dict[int, list[int]]:
    """Return the blocks beside each across cuts through intact rock of one region."""
    contacts, region = blocks.contacts, blocks.body.region
    through = ~contacts.of_joints(sets)
    through &= np.diff(region[contacts.blocks], axis=1)[:, 0] == 0
    found: dict[int, list[int]] = {}
    for i, j in contacts.blocks[through].tolist():
        found.setdefault(i, []).append(j)
        found.setdefault(j, []).append(i)
    return found


def contact_at(blocks: Blocks, points: np.ndarray, sets: int) -> np.ndarray:
    """Return the contact of the first joint sets that is nearest to each point (float array [m, d],
    m); of those as near, the first.

    Raises ValueError where there is no such contact.
    """
    chosen = np.flatnonzero(blocks.contacts.of_joints(sets))
    if not len(chosen):
        raise ValueError("there is no contact")
    outlines, normal = blocks.contacts.outlines, blocks.contacts.normal
    beyond, found = tolerance_of(blocks), []
    for point in points:
        off = distances(outlines, normal, point)[chosen]
        found.append(chosen[np.argmax(off <= off.min() + beyond)])
    return np.array(found, dtype=np.int64)


def distances(pieces: Outlines, normal: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Return the distance of a point [d] from convex pieces of planes with normals [n, d], m."""
    x, first = pieces
    after = np.arange(1, len(x) + 1)
    after[first[1:] - 1] = first[:-1]
    owner = np.repeat(np.arange(len(normal)), np.diff(first))
    edge, off = x[after] - x, point - x
    along = (edge * off).sum(axis=1) / np.maximum((edge**2).sum(axis=1), np.finfo(float).tiny)
    away = np.linalg.norm(off - np.clip(along, 0.0, 1.0)[:, None] * edge, axis=1)
    found = np.minimum.reduceat(away, first[:-1])
    if x.shape[1] == 3:  # before the piece itself, not beyond one of its edges
        turn = (np.cross(edge, off) * normal[owner]).sum(axis=1)
        before = np.minimum.reduceat(turn, first[:-1]) >= 0
        height = np.abs((off[first[:-1]] * normal).sum(axis=1))
        found[before] = height[before]
    return found
