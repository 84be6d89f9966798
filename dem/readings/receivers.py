"""Receivers of rigid blocks in any dimension: motion and stress at points, tractions at joints.

A block's motion is that of the rock at its centroid. Within intact rock that is cut into blocks,
motion and stress at a point are the block's own plus a gradient by least squares over neighbouring
blocks: exact to second order. A triangle or tetrahedron at a boundary or a joint has too few
neighbours; then neighbours of neighbours are added. A block between joints on all sides moves as a
rigid body, u + phi x r, with its mean stress.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, kron

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.locate import contact_at, rock_neighbours, sides_at
from jointwave.cases.partition.lattice import squared
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.contacts.faces import Contacts

#: Ratio of singular values below which neighbours lie on a line or a plane.
FLAT = 0.05
#: Weight of the neighbours in a value of triangles: triangles of opposite orientation are displaced
#: against each other by the strain times their size.
SHARED = 0.5
#: Distance, over the size of a contact, below which corners coincide or faces are coplanar.
SAME = 1e-6


class Stencil(NamedTuple):
    """Interpolation at one side of a receiver: blocks or contacts, the nearest first, their
    weights, and the arm at which the rotation of the first acts [d], m."""

    receiver: int
    at: list[int]
    weight: np.ndarray
    arm: np.ndarray


class Receivers(NamedTuple):
    """Receivers as linear combinations of blocks and contacts.

    places : recorded blocks [r]. volume : m^d [r]. second : second moments [r, d, d], m^(d + 2).
    touching : contacts of these blocks [k, 3]: row of `watched`, row of `places`, and whether the
    block is j. watched : recorded contacts [w]. faces : these contacts. motion : matrix from the
    blocks' freedoms to motion at points [points d, r F]. weights : of blocks at points [points, r].
    joints : weights of contacts at joints [joints, w].
    """

    places: np.ndarray
    volume: np.ndarray
    second: np.ndarray
    touching: np.ndarray
    watched: np.ndarray
    faces: Contacts
    motion: csr_matrix
    weights: csr_matrix
    joints: csr_matrix


def receivers_of(scene: RockMass, blocks: Blocks, faces: Contacts, onto: np.ndarray) -> Receivers:
    """Return the receivers of a scene; raises SceneError for a point outside the rock.

    faces : all contacts, those between blocks first. onto : matrix of `boundaries.freedoms`.
    """
    sets, (points, joints) = len(scene.joint_sets), scene.places.values()
    at_points = stencils_at(scene, blocks, points)
    read = {one.receiver for one in at_points}
    if lost := [k for k in range(len(points)) if k not in read]:
        place = points[lost[0]].tolist()
        raise SceneError(scene.where, f"record.points[{lost[0]}]", place, "must lie in rock")
    along = scene.numerics.dem.block is not None
    at_joints = stencils_on_joints(blocks, joints, sets, along) if len(joints) else []
    return read_by(blocks, faces, onto, at_points, at_joints)


def stencils_at(scene: RockMass, blocks: Blocks, points: np.ndarray) -> list[Stencil]:
    """Return the stencils of points [m, d] in the blocks of a scene; none for points outside."""
    sets = len(scene.joint_sets)
    sides = sides_at(blocks, points, sets)
    return stencils_in_rock(blocks, points, sides, sets, not squared(scene))


def stencils_in_rock(
    blocks: Blocks, points: np.ndarray, sides: list[list[int]], sets: int, shared: bool = False
) -> list[Stencil]:
    """Return the stencils of points [m, d], whose value is the mean over the blocks on their sides.

    sides : of `sides_at`. sets : number of joint sets. shared : whether neighbours weigh SHARED.
    """
    near, found = rock_neighbours(blocks, sets), []
    spread = np.ptp(blocks.centroid, axis=0)  # 0 along an axis that no plane crosses
    least = 1 + (spread > SAME * spread.max()).sum() if shared else 0
    for k, (at, own) in enumerate(zip(points, sides, strict=True)):
        for block in own:
            beside = near.get(block, [])
            like = {j for i in beside for j in near[i]} if len(beside) < least else set()
            others = [*beside, *sorted(like - {block, *beside})]
            part = np.isin(others, beside) if shared else None
            found.append(_stencil(k, [block, *others], blocks.centroid, at, part, 1 / len(own)))
    return found


def stencils_on_joints(blocks: Blocks, points: np.ndarray, sets: int, along: bool) -> list[Stencil]:
    """Return the stencils of joints at points [m, d]: the nearest contact.

    along : whether cuts through intact rock divide joints; then values are interpolated linearly
    with the adjacent contacts of the joint on the point's side.
    """
    contacts, found = blocks.contacts, []
    for k, c in enumerate(contact_at(blocks, points, sets).tolist()):
        own = [c, *(_ahead(contacts, c, points[k]) if along else [])]
        found.append(_stencil(k, own, contacts.centroid, points[k]))
    return found


def _ahead(contacts: Facets, c: int, at: np.ndarray) -> list[int]:
    """Return coplanar contacts that share a corner with contact c, on the side of a point [d]."""
    away, corners = contacts.centroid - contacts.centroid[c], contacts.outlines.of(c)
    beyond = SAME * float(np.linalg.norm(np.ptp(corners, axis=0)))
    here = contacts.joint_set == contacts.joint_set[c]
    here &= np.abs(away @ contacts.normal[c]) < beyond
    here &= away @ (at - contacts.centroid[c]) > 0
    return [
        k
        for k in np.flatnonzero(here).tolist()
        if np.linalg.norm(contacts.outlines.of(k)[:, None] - corners, axis=2).min() < beyond
    ]


def _stencil(
    receiver: int,
    own: list[int],
    centres: np.ndarray,
    at: np.ndarray,
    beside: np.ndarray | None = None,
    share: float = 1.0,
) -> Stencil:
    """Return the stencil of a receiver at a point [d], with total weight `share`.

    own : blocks or contacts, the nearest first, with their centres. beside : which of the others
    have the weight SHARED in the value, bool array.
    """
    off, apart = at - centres[own[0]], centres[own[1:]] - centres[own[0]]
    if not len(apart):
        return Stencil(receiver, own, np.array([share]), share * off)
    mean, terms, aim = np.zeros(len(apart)), apart, off
    if beside is not None:
        mean = SHARED * beside / beside.sum()
    if beside is not None and not beside.all():
        length = np.linalg.norm(apart, axis=1).mean()
        terms, aim = np.column_stack([apart, length * beside]), np.append(off, length * SHARED)
    weight = np.linalg.pinv(terms.T, rcond=FLAT) @ (aim - mean @ terms) + mean
    rest = off - weight @ apart
    return Stencil(receiver, own, share * np.append(1 - weight.sum(), weight), share * rest)


def read_by(
    blocks: Blocks, faces: Contacts, onto: np.ndarray, points: list[Stencil], joints: list[Stencil]
) -> Receivers:
    """Return receivers from the stencils of blocks at points and of contacts at joints.

    onto : matrix of `boundaries.freedoms` [F, d + d^2].
    """
    places = np.unique([b for one in points for b in one.at]).astype(np.int64)
    contact, side = np.nonzero(np.isin(faces.blocks, places))
    watched = np.unique([*contact, *(c for one in joints for c in one.at)]).astype(np.int64)
    place = np.searchsorted(places, faces.blocks[contact, side])
    weights, dim = _matrix(points, places), faces.frame.shape[1]
    moves, *turns = onto.T.reshape(-1, dim, len(onto))
    motion = kron(weights, moves)
    for axis, turn in enumerate(turns):
        arms = [one._replace(at=one.at[:1], weight=one.arm[[axis]]) for one in points]
        motion += kron(_matrix(arms, places), turn)
    return Receivers(
        places=places,
        volume=blocks.volume[places],
        second=blocks.second_moment[places],
        touching=np.stack([np.searchsorted(watched, contact), place, side], axis=1),
        watched=watched,
        faces=faces.some(watched),
        motion=csr_matrix(motion),
        weights=weights,
        joints=_matrix(joints, watched),
    )


def everywhere(blocks: Blocks, faces: Contacts) -> Receivers:
    """Return receivers of all blocks and contacts, without points."""
    contact, side = np.nonzero(faces.blocks < blocks.count)  # others are walls
    touching = np.stack([contact, faces.blocks[contact, side], side], axis=1)
    all_faces, none = np.arange(len(faces.area)), csr_matrix((0, 0))
    sizes = np.arange(blocks.count), blocks.volume, blocks.second_moment
    return Receivers(*sizes, touching, all_faces, faces, none, none, none)


def _matrix(stencils: list[Stencil], columns: np.ndarray) -> csr_matrix:
    """Return the weights of stencils as a matrix [receivers, columns]; columns : ascending."""
    row = np.repeat([one.receiver for one in stencils], [len(one.at) for one in stencils])
    at = np.searchsorted(columns, [k for one in stencils for k in one.at])
    weight = [w for one in stencils for w in one.weight]
    shape = max((one.receiver + 1 for one in stencils), default=0), len(columns)
    return csr_matrix((weight, (row.astype(int), at.astype(int))), shape)
