"""Blocks of the user's own as a cell complex.

Vertices within a tolerance are one. Each face of a block is a convex polygon, in the plane an edge.
Faces in space of two blocks that lie in one plane and overlap in part are cut into what they share
and convex pieces of the rest. Then edges are split at the vertices on them: pieces that two blocks
share have the same vertices, and the surface of each block is closed.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np

from jointwave.cases.geometry.assembly import assembled, joined, merged
from jointwave.cases.geometry.block_faces import faces_of, near, overlaid, steps
from jointwave.cases.geometry.cell_complex import NO_SET, OUTSIDE, Complex
from jointwave.cases.geometry.convex import ConvexBlocks
from jointwave.cases.geometry.read_blocks import Given, read_blocks, read_cells
from jointwave.cases.gmsh_file import MeshError

SAME = 1e-6  # of the extent: the default of the tolerance
SAME_VERTEX = 1e-9  # of a mesh: vertices that are one
ALIKE = 1.0  # degrees: sets that are as near to a contact's plane but for this are not told apart


def complex_of_file(
    path: Path, names: Sequence[str], normals: np.ndarray, tolerance: float | None = None
) -> Complex:
    """Return the blocks of a file; names and normals (float array [sets, d]) : of the joint sets.

    Contacts belong to the set of their group "joint NAME", and are intact rock in none; in a file
    without groups to the only set, or to the one whose planes are nearest to theirs. tolerance : m,
    default a millionth of the extent. Raises MeshError, in one phrase.
    """
    given = read_blocks(path)
    return with_sets(complex_of(given, tolerance), given.joints, names, normals)


def complex_of(given: Given, tolerance: float | None = None) -> Complex:
    """Return blocks as a complex, whose joint sets are the groups of the file, in their order."""
    if tolerance is None:
        tolerance = SAME * float(np.ptp(given.x, axis=0).max())
    x, number = merged(given.x, tolerance)
    joints = enumerate((given.joints or {}).values())
    group = {frozenset(number[facet].tolist()): k for k, own in joints for facet in own}
    faces = faces_of(
        x, [[number[loop] for loop in one] for one in given.blocks], group, given.names, tolerance
    )
    solids = ConvexBlocks(faces, given.names, tolerance)
    solids.check_convex()
    solids.check_apart()
    if x.shape[1] == 3:
        faces = overlaid(faces, solids.normal, tolerance)
    return _with_sides(assembled(faces, x, given.names, tolerance))


def complex_of_blocks(path: Path) -> tuple[Complex, list[str] | None]:
    """Return the blocks of a file as a complex, and the names of its groups of joints, which are
    its joint sets; None of a file without groups. Raises MeshError, in one phrase."""
    given = read_blocks(path)
    return complex_of(given), None if given.joints is None else list(given.joints)


def complex_of_cells(path: Path) -> tuple[Complex, list[str]]:
    """Return the cells of a gmsh file in the plane as a complex, and the names of its groups of
    joints, which are its joint sets. Raises MeshError, where rock is cut without a joint, too."""
    given = read_cells(path)
    tolerance = SAME_VERTEX * float(np.ptp(given.x, axis=0).max())
    body, number = complex_of(given, tolerance), merged(given.x, tolerance)[1]
    edges = np.sort([edge for (loop,) in given.blocks for edge in steps(loop)], axis=1)
    own = np.unique(np.concatenate([np.sort(number[edges], axis=1), edges], axis=1), axis=0)[:, :2]
    twice = set(map(frozenset, own[1:][(own[1:] == own[:-1]).all(axis=1)].tolist()))
    joints = chain.from_iterable((given.joints or {}).values())
    if loose := list(twice - {frozenset(number[facet].tolist()) for facet in joints}):
        no_group = f"no group 'joint ...', the first{near(given.x[list(loose[0])])}"
        raise MeshError(f"{len(loose)} edges coincide with others and are in {no_group}")
    return body, list(given.joints or {})


def with_sets(
    body: Complex,
    groups: Iterable[str] | None,
    names: Sequence[str],
    normals: np.ndarray,
) -> Complex:
    """Return a complex with the joint sets of a scene in place of the groups of a file, or of none:
    see `complex_of_file`. Raises MeshError."""
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
            at = near(body.vertices[_corners(body)[np.isin(_corners(body)[:, 0], inner[k]), 1]])
            raise MeshError(f"has a contact{at} whose plane is as near to set {one} as to {other}")
        joint_set[inner] = order[:, 0]
    return replace(body, joint_set=joint_set)


def _with_sides(body: Complex) -> Complex:
    """Return a complex with sides: 0 of the outer boundary, 1 + k of opening k, from left to right.
    Raises MeshError for rock in pieces and for joints on the boundary."""
    middle = body.means(_corners(body), len(body.sides))
    wrong = (body.joint_set != NO_SET) & ~body.inner
    if wrong.any():
        at = f"the first{near(middle[wrong][:1])}"
        raise MeshError(f"{wrong.sum()} facets of its joints are on its boundary, {at}")
    piece = joined(body.sides[body.inner], body.count)
    if piece.any():
        at = near(body.centres()[piece != piece[0]][:1])
        raise MeshError(f"its rock is in {piece.max() + 1} separate pieces, one{at}")
    rows = body.bounds[-1][~body.inner[body.bounds[-1][:, 0]]]
    rows = rows[np.argsort(rows[:, 1], kind="stable")]
    beside = np.flatnonzero(np.diff(rows[:, 1]) == 0)
    surface = joined(np.stack([rows[beside, 0], rows[beside + 1, 0]], axis=1), len(body.sides))
    rank = np.empty(len(body.vertices), np.int64)
    rank[np.lexsort(body.vertices.T[::-1])] = np.arange(len(rank))
    facet, vertex = _corners(body).T
    leftmost = np.full(surface.max() + 1, len(rank))
    outside = ~body.inner[facet]
    np.minimum.at(leftmost, surface[facet[outside]], rank[vertex[outside]])
    side = np.argsort(np.argsort(leftmost, kind="stable"))[surface]
    return replace(body, side=np.where(body.inner, 0, side))


def _corners(body: Complex) -> np.ndarray:
    """Return the pairs (facet, vertex) of a complex."""
    number = np.arange(len(body.sides))
    return body.vertices_of(np.stack([number, number], axis=1))


def around_rock(body: Complex) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Return the ends of all facets in the plane, int array [f, 2], with a cell to the left; the
    cells to the left and right of them, int array [f, 2]; and the facets around the rock in order,
    counter-clockwise, and around each opening, clockwise. Raises MeshError where they touch."""
    ends = body.bounds[0][:, 1].reshape(-1, 2)
    x, y = np.diff(body.vertices[ends], axis=1)[:, 0].T
    out = body.normals[body.plane]
    cells = np.where((out[:, 0] * y > out[:, 1] * x)[:, None], body.sides, body.sides[:, ::-1])
    turned = (cells[:, 0] == OUTSIDE)[:, None]
    ends, cells = np.where(turned, ends[:, ::-1], ends), np.where(turned, cells[:, ::-1], cells)
    outer = np.flatnonzero(~body.inner)
    start, times = np.unique(ends[outer, 0], return_counts=True)
    if times.max() > 1:
        at = body.vertices[start[times > 1][:1]]
        raise MeshError(f"its outline touches itself{near(at)}")
    after = dict(zip(ends[outer, 0].tolist(), outer.tolist(), strict=True))
    loops = []
    for side in range(body.side.max() + 1):
        loop = [int(outer[body.side[outer] == side][0])]
        while (facet := after[int(ends[loop[-1], 1])]) != loop[0]:
            loop.append(facet)
        loops.append(np.array(loop))
    return ends, cells, loops


def outlines_of(body: Complex) -> list[np.ndarray]:
    """Return the corners of rock in the plane, or of the box around it in space, and of each of its
    openings, float arrays [n, d], m."""
    if body.dim == 3:
        facet, vertex = _corners(body).T
        outer = np.where(body.inner, -1, body.side)[facet]
        ends = np.stack([body.vertices.min(axis=0), body.vertices.max(axis=0)])
        openings = (body.vertices[np.unique(vertex[outer == k])] for k in range(1, outer.max() + 1))
        return [np.stack(np.meshgrid(*ends.T), axis=-1).reshape(-1, 3), *openings]
    ends, _, loops = around_rock(body)
    return [body.vertices[ends[loop, 0]] for loop in loops]
