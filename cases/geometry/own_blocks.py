"""Blocks of the user's own as a cell complex.

Vertices within a tolerance are one. Each face of a block is a convex polygon, in the plane an edge.
Faces in space of two blocks that lie in one plane and overlap in part are cut into what they share
and convex pieces of the rest. Then edges are split at the vertices on them: pieces that two blocks
share have the same vertices, and the surface of each block is closed.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from jointwave.cases.geometry.cell_complex import NO_SET, OUTSIDE, PARALLEL, Complex
from jointwave.cases.geometry.convex import (
    ConvexBlocks,
    Face,
    is_convex,
    near,
    near_boxes,
    off_plane,
    overlap,
    vector_areas,
)
from jointwave.cases.geometry.measure import without_straight
from jointwave.cases.geometry.read_blocks import Given, Loop, Loops, read_blocks
from jointwave.cases.gmsh_file import MeshError

SAME = 1e-6  # of the extent: the default of the tolerance
ALIKE = 1.0  # degrees: sets that are as near to a contact's plane but for this are not told apart
GENERIC = np.array([0.5488, 0.7152, 0.4332])  # what normals of one direction are turned towards


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
    faces = _faces(
        x, [[number[loop] for loop in one] for one in given.blocks], group, given.names, tolerance
    )
    blocks = ConvexBlocks(faces, given.names, tolerance)
    blocks.check_convex()
    blocks.check_apart()
    if x.shape[1] == 3:
        faces = _overlaid(faces, blocks)
    return _with_sides(_assembled(faces, x, given.names, tolerance))


def merged(x: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points with those within the tolerance (m) of others replaced by the first of them,
    and the number of each one's first."""
    places, first, which = np.unique(x, axis=0, return_index=True, return_inverse=True)
    pairs = cKDTree(places).query_pairs(tolerance, output_type="ndarray")
    group = _joined(pairs, len(places))
    least = np.full(len(places), len(x))
    np.minimum.at(least, group, first)
    number = least[group][which.reshape(-1)]
    return x[number], number


def _joined(pairs: np.ndarray, number: int) -> np.ndarray:
    """Return the group of each of a number of things that pairs [m, 2] connect."""
    one, other = np.reshape(pairs, (-1, 2)).T.astype(np.int64)
    return connected_components(coo_array((np.ones(len(one)), (one, other)), (number, number)))[1]


def _faces(
    x: np.ndarray, blocks: list[list], group: dict, names: list[str], tolerance: float
) -> list[Face]:
    """Return the faces of blocks by their parts: the facets of one part only, joined as far as they
    lie in one plane and belong to one group."""
    around = [_around(x, loops) for loops in blocks]
    loops = [loop for own in around for loop in own]
    if lost := group.keys() - set(map(frozenset, loops)):
        at = near(x[list(lost.pop())])
        raise MeshError(f"has a facet of a joint{at}, where no block has its face")
    sizes = np.array([len(loop) for loop in loops])
    corners = x[np.concatenate(loops)]
    area = vector_areas(corners, sizes)
    ends = np.cumsum(sizes)
    faces: list[Face] = []
    last = 0
    for cell, own in enumerate(around):
        first, last = last, last + len(own)
        if len(own) <= x.shape[1]:
            raise MeshError(f"{names[cell]} is flat or open{near(x[blocks[cell][0]])}")
        start = ends[first:last] - sizes[first:last]
        planes = np.arange(len(own))
        if len(own) > x.shape[1] + 1:  # no simplex
            at = corners[start[0] : ends[last - 1]]
            planes = _coplanar(at, start - start[0], area[first:last], names[cell], tolerance)
        parts: dict[tuple[int, int], Loops] = {}
        for plane, loop in zip(planes, own, strict=True):
            joint = group.get(frozenset(loop), NO_SET) if group else NO_SET
            parts.setdefault((plane, joint), []).append(loop)
        for (plane, joint), one in parts.items():
            for united in _united(x, one, area[first + plane], tolerance):
                faces.append(Face(united, cell, joint, first + int(plane)))
    return faces


def _around(x: np.ndarray, parts: list) -> Loops:
    """Return the facets of a block by its parts: those that no other part has."""
    loops = [[v for v, after in _pairs(one) if v != after] for one in (p.tolist() for p in parts)]
    if x.shape[1] == 2:
        loops = [one if _turns(x[one]) > 0 else one[::-1] for one in loops]
        loops = [list(edge) for one in loops for edge in _pairs(one)]
    if len(parts) == 1:
        return loops
    times = Counter(map(frozenset, loops))
    return [one for one in loops if times[frozenset(one)] == 1 and len(one) >= x.shape[1]]


def _coplanar(
    x: np.ndarray, first: np.ndarray, area: np.ndarray, name: str, tolerance: float
) -> np.ndarray:
    """Return for each facet of a block, by its corners x from `first` on and its vector area, the
    largest facet in whose plane it lies."""
    size = np.linalg.norm(area, axis=1)
    plane = np.full(len(size), -1)
    while (plane < 0).any():
        k = int(np.argmax(np.where(plane < 0, size, -1.0)))
        own = x[first[k] :][: np.diff(first, append=len(x))[k]]
        away = np.abs((x - own.mean(axis=0)) @ area[k]) / (size[k] or 1.0)
        on = np.maximum.reduceat(away, first) <= tolerance
        if not on[k] or not size[k]:
            raise MeshError(f"{name} has a face that is not plane{near(own)}")
        plane[on & (plane < 0)] = k
    return plane


def _united(x: np.ndarray, loops: Loops, area: np.ndarray, tolerance: float) -> list[np.ndarray]:
    """Return the corners of convex faces that pieces of one plane make up: one where that is
    convex, else the pieces. area : along their normal."""
    if len(loops) > 1 and x.shape[1] == 2:
        start, end = ({one[k] for one in loops} for k in (0, 1))
        if len(start - end) == 1:
            return [x[[*(start - end), *(end - start)]]]
    elif len(loops) > 1:
        edges = {edge for one in loops for edge in _pairs(one)}
        after = dict(edge for edge in edges if edge[::-1] not in edges)
        loop = [next(iter(after), -1)]
        while (v := after.get(loop[-1], loop[0])) != loop[0] and len(loop) <= len(after):
            loop.append(v)
        if len(loop) == len(after):
            whole = without_straight(x[loop], np.array([0, len(loop)]), tolerance).corners
            if is_convex(whole, area / np.linalg.norm(area), tolerance):
                return [whole]
    return [x[one] for one in loops]


def _pairs(loop: Loop) -> Iterable[tuple[int, int]]:
    """Return each vertex of an outline with the next."""
    return zip(loop, loop[1:] + loop[:1], strict=True)


def _turns(x: np.ndarray) -> float:
    """Return twice the area of a polygon in the plane, m2; negative if clockwise."""
    return float(x[:, 0] @ np.roll(x[:, 1], -1) - x[:, 1] @ np.roll(x[:, 0], -1))


def _overlaid(faces: list[Face], blocks: ConvexBlocks) -> list[Face]:
    """Return faces in space cut into what two of them share and the rest."""
    tolerance, normal = blocks.tolerance, blocks.normal
    keys = [frozenset(map(tuple, face.corners.tolist())) for face in faces]
    times = Counter(keys)
    alone = np.array([k for k, key in enumerate(keys) if times[key] == 1], dtype=np.int64)
    ends = [(x.min(axis=0), x.max(axis=0)) for x in (faces[k].corners for k in alone)]
    low, high = np.reshape(ends, (-1, 2, 3)).transpose(1, 0, 2)
    shared: dict[int, list[np.ndarray]] = {k: [] for k in alone}
    found = [face for k, face in enumerate(faces) if k not in shared]
    for i, j in alone[near_boxes(low, high, tolerance)] if len(alone) else ():
        (x, *_), (y, *_) = one, other = faces[i], faces[j]
        if normal[i] @ normal[j] > 0 or one.cell == other.cell:
            continue
        if max(off_plane(y, normal[i], x[0]), off_plane(x, normal[j], y[0])) > tolerance:
            continue
        common, _ = overlap(x, y[::-1], normal[i], tolerance)
        if common is not None:
            joint = max(one.joint, other.joint)
            found.append(Face(common, one.cell, joint, one.plane))
            found.append(Face(common[::-1], other.cell, joint, other.plane))
            shared[i].append(common)
            shared[j].append(common[::-1])
    for k, commons in shared.items():
        rest = [faces[k].corners]
        for common in commons:
            rest = [x for one in rest for x in overlap(one, common, normal[k], tolerance)[1]]
        found += [faces[k]._replace(corners=one) for one in rest]
    return found


def _assembled(faces: list[Face], x: np.ndarray, names: list[str], tolerance: float) -> Complex:
    """Return the complex of faces; x : the blocks' corners, which those of faces that are within
    the tolerance become; names : of the blocks."""
    dim = x.shape[1]
    x, number = merged(np.concatenate([x, *(face.corners for face in faces)]), tolerance)
    ends = np.cumsum([len(face.corners) for face in faces])
    loops = [one.tolist() for one in np.split(number[-ends[-1] :], ends[:-1])]
    held: dict[frozenset, list[tuple[Loop, int]]] = defaultdict(list)
    for k, whole in enumerate(_with_vertices(x, loops, tolerance)):
        for loop in [whole] if dim == 3 else map(list, pairwise(whole)):
            if len(loop) >= dim:
                held[frozenset(loop)].append((loop, k))
    halves = [(f, k, loop) for f, own in enumerate(held.values()) for loop, k in own]
    facet, face = (np.array([one[k] for one in halves]) for k in (0, 1))
    first = np.diff(facet, prepend=-1) > 0
    last = np.append(first[1:], True)
    cell, joint, plane = (np.array([one[k] for one in faces])[face] for k in (1, 2, 3))
    if not (first | last).all():
        at = x[halves[np.argmin(first | last)][2]]
        raise MeshError(f"more than two of its blocks share a face{near(at)}")
    half = np.repeat(np.arange(len(halves)), [len(loop) for *_, loop in halves])
    start, end = np.array([edge for *_, loop in halves for edge in _pairs(loop)]).T
    edges, edge = np.unique(np.sort([start, end], axis=0).T, axis=0, return_inverse=True)
    ridge = start if dim == 2 else edge.reshape(-1)
    forth = np.diff(half, prepend=-1) > 0 if dim == 2 else start < end
    _check_closed(cell[half] * len(x) ** 2 + ridge, forth, x[start], [names[k] for k in cell[half]])
    mine = first[half]
    bounds = [np.stack([facet[half], ridge], axis=1)[mine]]
    if dim == 3:
        bounds.insert(0, np.stack([np.repeat(np.arange(len(edges)), 2), edges.ravel()], axis=1))
    used, vertex = np.unique(bounds[0][:, 1], return_inverse=True)
    bounds[0][:, 1] = vertex.reshape(-1)
    links = np.stack([plane[first], plane[last]], axis=1)
    area = vector_areas(x[start], np.bincount(half))
    normals, plane, into = _planes(area, plane, links)
    sides = np.stack([cell[first], np.where(first & last, OUTSIDE, cell)[last]], axis=1)
    return Complex(
        vertices=x[used],
        bounds=tuple(bounds),
        sides=np.where(into[first, None], sides[:, ::-1], sides),
        plane=plane[first],
        joint_set=np.maximum(joint[first], joint[last]),
        side=np.zeros(len(sides), np.int64),
        normals=normals,
        region=np.full(len(names), -1),
        count=len(names),
    )


def _with_vertices(x: np.ndarray, loops: Loops, tolerance: float) -> Loops:
    """Return outlines (in the plane edges) by their vertices, with those of others on the way."""
    edges = {tuple(sorted(edge)) for one in loops for edge in _pairs(one) if edge[0] != edge[1]}
    one, other = np.array(list(edges)).T
    used = np.unique([one, other])
    along = x[other] - x[one]
    length = np.linalg.norm(along, axis=1)
    found = cKDTree(x[used]).query_ball_point((x[one] + x[other]) / 2, length / 2)
    edge = np.repeat(np.arange(len(one)), [len(near) for near in found])
    vertex = used[np.concatenate(found).astype(np.int64)]
    away = x[vertex] - x[one[edge]]
    t = (away * along[edge]).sum(axis=1) / length[edge] ** 2
    close = np.linalg.norm(away - t[:, None] * along[edge], axis=1) <= tolerance
    close &= (vertex != one[edge]) & (vertex != other[edge])
    between: dict[tuple[int, int], list[int]] = defaultdict(list)
    for k in np.flatnonzero(close)[np.argsort(t[close], kind="stable")]:
        between[one[edge[k]], other[edge[k]]].append(int(vertex[k]))
    return [
        [v for a, b in _pairs(loop) if a != b for v in (a, *_way(between, a, b))]
        if x.shape[1] == 3
        else [loop[0], *_way(between, *loop), loop[1]]
        for loop in loops
    ]


def _way(between: dict[tuple[int, int], list[int]], a: int, b: int) -> list[int]:
    """Return the vertices on the way from one vertex to another."""
    return between.get((a, b), []) if a < b else between.get((b, a), [])[::-1]


def _planes(
    area: np.ndarray, plane: np.ndarray, links: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return normals [l, d], no two of them parallel, the one of each facet, and whether it points
    into the facet's block. area : vector areas [n, d]; plane : number of each facet's; links :
    pairs of planes that are one, which the largest facet gives the normal."""
    which = _joined(links, plane.max() + 1)[plane]
    size = np.linalg.norm(area, axis=1)
    largest = np.zeros(which.max() + 1, np.int64)
    largest[which[np.argsort(size)]] = np.argsort(size)
    normals = area[largest] / size[largest, None]
    normals *= np.where(normals @ GENERIC[: area.shape[1]] < 0, -1.0, 1.0)[:, None]
    normals, number = merged(normals, PARALLEL)
    used, found = np.unique(number[which], return_inverse=True)
    return normals[used], found.reshape(-1), (area * normals[number[which]]).sum(axis=1) < 0


def _check_closed(key: np.ndarray, forth: np.ndarray, x: np.ndarray, names: list[str]) -> None:
    """Raise MeshError unless each block has each of its edges once forth and once back. key : of
    block and edge; x : a point of it; names : of the block."""
    _, which, times = np.unique(key, return_inverse=True, return_counts=True)
    wrong = (times != 2) | (np.bincount(which.reshape(-1), weights=forth) != 1)
    if wrong.any():
        k = int(np.argmax(wrong[which.reshape(-1)]))
        raise MeshError(f"{names[k]} is open{near(x[k : k + 1])}")


def _with_sides(body: Complex) -> Complex:
    """Return a complex with sides: 0 of the outer boundary, 1 + k of opening k, from left to right.
    Raises MeshError for rock in pieces and for joints on the boundary."""
    middle = body.means(_corners(body), len(body.sides))
    wrong = (body.joint_set != NO_SET) & ~body.inner
    if wrong.any():
        at = f"the first{near(middle[wrong][:1])}"
        raise MeshError(f"{wrong.sum()} facets of its joints are on its boundary, {at}")
    piece = _joined(body.sides[body.inner], body.count)
    if piece.any():
        at = near(body.centres()[piece != piece[0]][:1])
        raise MeshError(f"its rock is in {piece.max() + 1} separate pieces, one{at}")
    rows = body.bounds[-1][~body.inner[body.bounds[-1][:, 0]]]
    rows = rows[np.argsort(rows[:, 1], kind="stable")]
    beside = np.flatnonzero(np.diff(rows[:, 1]) == 0)
    surface = _joined(np.stack([rows[beside, 0], rows[beside + 1, 0]], axis=1), len(body.sides))
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
    """Return the corners of rock in the plane and of each of its openings, float arrays [n, 2]."""
    ends, _, loops = around_rock(body)
    return [body.vertices[ends[loop, 0]] for loop in loops]


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
