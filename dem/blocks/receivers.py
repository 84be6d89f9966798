"""Receivers of a rock mass of rigid blocks: motion and stress at points, tractions at joints.

The motion of a block is that of the rock in its middle. Between blocks that a cut through intact
rock parts, motion and stress at a point are interpolated: those of the point's block, and their
gradient by least squares over its neighbours, which is exact to second order. Where all neighbours
are beyond joints, the block moves as it is: u + phi x r, with its mean stress.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.lattice import squared
from jointwave.cases.partition.locate import contact_at, rock_neighbours, sides_at
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.blocks.links import Links

#: Of the largest singular value of the neighbours' places: below it they lie on a line.
ON_A_LINE = 0.05
#: Of a value that triangles have, the part of the neighbours: those that point up and those that
#: point down are displaced against each other by the strain times their size.
SHARED = 0.5


class BlockReceivers(NamedTuple):
    """Receivers as linear combinations of blocks and contacts.

    places : blocks that are read [r]. weights : of each place at each point [points, r]. turns :
    what a place's rotation adds to the motion at each point [points, r, 2], m. touching : contacts
    of the places [k], with the place and the sign of the force on it, in the rows of `watched`.
    watched : contacts that are read [w]. joints : weights of them at each joint point [joints, w].
    """

    places: np.ndarray
    weights: np.ndarray
    turns: np.ndarray
    touching: np.ndarray
    watched: np.ndarray
    joints: np.ndarray


def receivers_of(scene: RockMass, partition: Partition, links: Links) -> BlockReceivers:
    """Return the receivers of a scene."""
    points = np.array(scene.record.points, dtype=float).reshape(-1, 2)
    near, sides = rock_neighbours(partition), sides_at(partition, points)
    if [] in sides:
        k = sides.index([])
        raise SceneError(scene.where, f"record.points[{k}]", points[k].tolist(), "must lie in rock")
    shared = 0.0 if squared(scene) else SHARED
    stencils = [
        (k, 1 / len(blocks), _stencil(partition, near, block, points[k], shared))
        for k, blocks in enumerate(sides)
        for block in blocks
    ]
    places = np.unique([b for *_, (own, *_) in stencils for b in own]).astype(np.int64)
    weights, turns = np.zeros((len(points), len(places))), np.zeros((len(points), len(places), 2))
    for k, share, (own, weight, rest) in stencils:
        weights[k, np.searchsorted(places, own)] += share * weight
        turns[k, np.searchsorted(places, own[0])] += share * np.array([-rest[1], rest[0]])
    joints = _joint_weights(scene, partition)
    contact, side = np.nonzero(np.isin(links.blocks, places))
    watched = np.unique([*contact, *(c for own in joints for c in own)]).astype(np.int64)
    touching = np.stack(
        [
            np.searchsorted(watched, contact),
            np.searchsorted(places, links.blocks[contact, side]),
            side,
        ],
        axis=1,
    )
    table = np.zeros((len(joints), len(watched)))
    for k, mixed in enumerate(joints):
        for c, share in mixed.items():
            table[k, np.searchsorted(watched, c)] = share
    return BlockReceivers(places, weights, turns, touching, watched, table)


def _stencil(
    partition: Partition, near: dict[int, list[int]], block: int, at: np.ndarray, shared: float
) -> tuple[list[int], np.ndarray, np.ndarray]:
    """Return the blocks that the motion at a point is read from, the first its own, their weights,
    and the arm [2], m, that is left to the block's rotation where they give no gradient.

    shared : how much of the value itself is the neighbours'.
    """
    beside, off = near.get(block, []), at - partition.centroid[block]
    if not beside:
        return [block], np.ones(1), off
    apart = partition.centroid[beside] - partition.centroid[block]
    mean = np.full(len(beside), shared / len(beside))
    own = np.linalg.pinv(apart.T, rcond=ON_A_LINE) @ (off - mean @ apart) + mean
    return [block, *beside], np.append(1 - own.sum(), own), off - own @ apart


def _joint_weights(scene: RockMass, partition: Partition) -> list[dict[int, float]]:
    """Return the contacts that each joint receiver reads, with weights: the nearest, and between
    cuts through intact rock the next one along the joint, linearly from centre to centre."""
    points = np.array(scene.record.joints, dtype=float).reshape(-1, 2)
    if not len(points):
        return []
    contacts, found = partition.contacts, []
    centres = (contacts.start + contacts.end) / 2
    for at, c in zip(points, contact_at(partition, points).tolist(), strict=True):
        normal = contacts.normal[c]
        along = np.array([-normal[1], normal[0]])
        own = {c: 1.0}
        if scene.numerics.dem.block is not None:
            s = float((at - centres[c]) @ along)
            end = centres[c] + np.copysign(contacts.length[c] / 2, s) * along
            ends = np.minimum(
                np.hypot(*(contacts.start - end).T), np.hypot(*(contacts.end - end).T)
            )
            same = (contacts.joint_set == contacts.joint_set[c]) & (
                np.abs((centres - centres[c]) @ normal) < 1e-6 * contacts.length[c]
            )
            same[c] = False
            beside = np.flatnonzero(same & (ends < 1e-6 * contacts.length[c]))
            if len(beside):
                step = float((centres[beside[0]] - centres[c]) @ along)
                own = {c: 1 - s / step, int(beside[0]): s / step}
        found.append(own)
    return found
