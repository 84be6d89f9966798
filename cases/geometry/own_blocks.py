"""Build a cell complex from the user's blocks or from the cells of a mesh.

Vertices within a tolerance are merged. Coplanar faces of two blocks are cut into their overlap and
convex pieces of the rest. Edges are then split at the vertices on them, so that neighbouring pieces
share edges.
"""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import shapely
from scipy.spatial import cKDTree

from jointwave.cases.geometry.cell_complex import NO_SET, OUTSIDE, Complex, from_facets
from jointwave.cases.geometry.measure import facet_moments
from jointwave.cases.geometry.read_blocks import Given, Loop, read_blocks, read_cells
from jointwave.cases.geometry.relations import joined, merged
from jointwave.cases.geometry.solid_blocks import near, pieces_between, solids_of, width_of
from jointwave.cases.geometry.solids import corners_of
from jointwave.cases.gmsh_file import MeshError

SAME = 1e-6  # tolerance over the extent within which corners of blocks are merged
ALIKE = 1.0  # degrees: least difference in angle that decides between two sets for a contact


def complex_of_file(path: Path, mesh: bool = False) -> tuple[Complex, list[str] | None]:
    """Return the blocks of a file, or the cells of a mesh, as a complex; and the names of its joint
    groups, which become joint sets, or None. Raises MeshError, in one phrase."""
    given = read_cells(path) if mesh else read_blocks(path)
    tolerance = SAME * float(np.ptp(given.x, axis=0).max())
    number = merged(given.x, tolerance)
    x, blocks = given.x, [[[number[f] for f in part] for part in one] for one in given.blocks]
    solids = solids_of(x, blocks, given.names, tolerance)
    pieces = pieces_between(solids, given.names, tolerance)
    face, beyond = (np.array([one[k] for one in pieces]) for k in (1, 2))
    cell = np.repeat(np.arange(len(solids)), [len(one.faces) for one in solids])
    normals = np.concatenate([one.normals for one in solids])
    shared = beyond != OUTSIDE  # faces that share a piece take the normal of the longest
    group = joined(np.stack([face[shared], beyond[shared]], axis=1), len(normals))
    length = [np.linalg.norm(np.ptp(x, axis=0)) for one in solids for x in one.faces]
    order = np.argsort(length)[::-1]
    of_group = normals[order[np.unique(group[order], return_index=True)[1]]][group]
    normal = of_group * np.sign((of_group * normals).sum(axis=1))[:, None]
    sides = np.stack([cell[face], np.where(shared, cell[beyond], OUTSIDE)], axis=1)
    places = np.concatenate([x, *(one[0] for one in pieces)])
    ends = np.cumsum([len(x), *(len(one[0]) for one in pieces)])
    around = np.split(merged(places, tolerance), ends[:-1])[1:]
    loops = _with_vertices(places, around, tolerance)
    held = [
        k
        for k, loop in enumerate(loops)
        if len(loop) >= x.shape[1] and width_of(places[loop]) > tolerance
    ]
    body = from_facets(places, [loops[k] for k in held], sides[held], normal[face[held]])
    if given.joints is None:
        return _with_sides(body), None
    if mesh:  # only vertices of joints may coincide
        used = np.unique([v for one in given.blocks for part in one for loop in part for v in loop])
        times = np.bincount(number[used], minlength=len(number))
        times[number[[v for one in given.joints.values() for facet in one for v in facet]]] = 0
        if (times > 1).any():
            at = f"no group 'joint ...', the first{near(given.x[times > 1][:1])}"
            raise MeshError(f"{(times > 1).sum()} vertices coincide with others and are in {at}")
    return _with_sides(_with_joints(body, blocks, given, number)), list(given.joints)


def _with_joints(body: Complex, blocks: list, given: Given, number: np.ndarray) -> Complex:
    """Return a complex with the joint sets of a file's groups. Raises MeshError for joint facets
    between no two blocks, and for blocks that share facets of several groups."""
    assert given.joints is not None
    owners, groups = defaultdict[frozenset, set](set), defaultdict[frozenset, set](set)
    for cell, parts in enumerate(blocks):
        for loop in (loop.tolist() for part in parts for loop in part):
            steps = zip(loop, [*loop[1:], loop[0]], strict=True)
            for facet in [loop] if body.dim == 3 else steps:
                owners[frozenset(facet)].add(cell)
    of = {
        frozenset(number[facet].tolist()): k
        for k, facets in enumerate(given.joints.values())
        for facet in facets
    }
    for facet, cells in owners.items():
        groups[frozenset(cells)].add(of.get(facet, NO_SET))
    index = {frozenset(pair): k for k, pair in enumerate(body.sides.tolist())}
    if lost := [facet for facet in of if frozenset(owners[facet]) not in index]:
        at = near(given.x[list(lost[0])])
        raise MeshError(
            f"{len(lost)} facets of its joints lie between no two blocks, the first{at}"
        )
    joint_set = body.joint_set.copy()
    for pair in groups.keys() & index.keys():
        joint_set[index[pair]], *others = groups[pair]
        if others:
            at = near(facet_moments(body).centroid[index[pair]][None])
            raise MeshError(f"what two of its blocks share{at} is in no one group of joints")
    return replace(body, joint_set=joint_set)


def _with_vertices(x: np.ndarray, pieces: list[np.ndarray], tolerance: float) -> list[Loop]:
    """Return pieces as loops of vertices, in space with the vertices of others on their edges."""
    loops = [one[one != np.roll(one, 1)].tolist() for one in pieces]
    if x.shape[1] == 2:
        return loops
    around = [list(pairwise([*loop, *loop[:1]])) for loop in loops]
    one, other = np.unique(np.sort([step for own in around for step in own], axis=1), axis=0).T
    used = np.unique([one, other])
    along = x[other] - x[one]
    length = np.linalg.norm(along, axis=1)
    found = cKDTree(x[used]).query_ball_point((x[one] + x[other]) / 2, length / 2)
    edge = np.repeat(np.arange(len(one)), list(map(len, found)))
    vertex = used[np.concatenate(found).astype(np.int64)]
    away = x[vertex] - x[one[edge]]
    t = (away * along[edge]).sum(axis=1) / length[edge] ** 2
    close = np.linalg.norm(away - t[:, None] * along[edge], axis=1) <= tolerance
    close &= (vertex != one[edge]) & (vertex != other[edge])
    on: dict[tuple[int, int], Loop] = defaultdict(list)
    for k in np.flatnonzero(close)[np.argsort(t[close], kind="stable")]:
        on[one[edge[k]], other[edge[k]]].append(int(vertex[k]))
    return [
        [v for a, b in own for v in (a, *on.get((a, b), ()), *on.get((b, a), ())[::-1])]
        for own in around
    ]


def with_sets(
    body: Complex, groups: Iterable[str] | None, names: Sequence[str], normals: np.ndarray
) -> Complex:
    """Return a complex with the joint set indices of a scene, from names and unit normals [sets,
    d]. Groups of a file match sets by name; without groups a contact gets the only set, or the one
    whose planes are nearest in angle. Raises MeshError."""
    plain, joint_set = [name.lower() for name in names], body.joint_set.copy()
    if groups is not None:
        groups = list(groups)
        if lost := [name for name in groups if name not in plain]:
            raise MeshError(f"has a group 'joint {lost[0]}', but no joint set has this name")
        if lost := [name for name in plain if name not in groups]:
            k = plain.index(lost[0])
            raise MeshError(f"must have a group 'joint {lost[0]}' for joint_sets[{k}]")
        number = np.array([*(plain.index(name) for name in groups), NO_SET])
        return replace(body, joint_set=number[joint_set])
    inner = np.flatnonzero(body.inner)
    if len(names) == 1:
        joint_set[inner] = 0
    elif len(names) and len(inner):
        cosine = np.abs(body.normals[body.plane[inner]] @ np.asarray(normals).T)
        angle = np.degrees(np.arccos(np.minimum(cosine, 1.0)))
        order = np.argsort(angle, axis=1, kind="stable")[:, :2]
        apart = np.diff(np.take_along_axis(angle, order, axis=1), axis=1)[:, 0]
        if (apart < ALIKE).any():
            k = int(np.argmin(apart))
            one, other = (repr(names[i]) for i in order[k])
            at = near(facet_moments(body, inner[k : k + 1]).centroid)
            raise MeshError(f"has a contact{at} whose plane is as near to set {one} as to {other}")
        joint_set[inner] = order[:, 0]
    return replace(body, joint_set=joint_set)


def _with_sides(body: Complex) -> Complex:
    """Return a complex with sides: 0 for the outer boundary, 1 + k for opening k, from left to
    right. Raises MeshError for separate pieces, an outline that touches itself, and joints on
    it."""
    middle, outer = facet_moments(body).centroid, ~body.inner
    wrong = (body.joint_set != NO_SET) & outer
    if wrong.any():
        at = f"the first{near(middle[wrong][:1])}"
        raise MeshError(f"{wrong.sum()} facets of its joints are on its boundary, {at}")
    piece = joined(body.sides[body.inner], body.count)
    if piece.any():
        at = near(body.centres()[piece != piece[0]][:1])
        raise MeshError(f"its rock is in {piece.max() + 1} separate pieces, one{at}")
    facet, ridge = body.bounds[-1][outer[body.bounds[-1][:, 0]]].T
    if body.dim == 2 and (touches := np.bincount(ridge) > 2).any():
        raise MeshError(
            f"its outline touches itself{near(body.vertices[: len(touches)][touches][:1])}"
        )
    order = np.argsort(ridge, kind="stable")
    same = np.flatnonzero(np.diff(ridge[order]) == 0)
    beside = np.stack([facet[order][same], facet[order][same + 1]], axis=1)
    surface = np.where(outer, joined(beside, len(outer)), -1)
    number, vertex = body.corners_of_facets().T
    number, vertex = number[outer[number]], vertex[outer[number]]
    order = np.lexsort(body.vertices[vertex].T[::-1])
    found, first = np.unique(surface[number][order], return_index=True)
    side = np.zeros(len(outer) + 1, np.int64)
    side[found[np.argsort(first)]] = np.arange(len(found))
    return replace(body, side=np.where(outer, side[surface], 0))


def outlines_of(body: Complex) -> list[np.ndarray]:
    """Return the corners of the rock (in space its bounding box) and of each opening [n, d], m."""
    facet, vertex = body.corners_of_facets().T
    side = np.where(body.inner, -1, body.side)
    own = [body.vertices[vertex[side[facet] == k]] for k in range(side.max() + 1)]
    if body.dim == 2:
        rings = (shapely.polygonize(shapely.linestrings(x.reshape(-1, 2, 2))) for x in own)
        return [corners_of(ring.geoms[0]) for ring in rings]
    low, high = body.vertices.min(axis=0), body.vertices.max(axis=0)
    return [np.array(list(product(*zip(low, high, strict=True)))), *own[1:]]
