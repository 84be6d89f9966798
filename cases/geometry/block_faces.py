"""The faces of blocks: joined where they lie in one plane, cut where they overlap in part."""

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.measure import without_straight
from jointwave.cases.geometry.pieces import clipped
from jointwave.cases.geometry.read_blocks import Loop, Loops
from jointwave.cases.geometry.relations import ranges
from jointwave.cases.gmsh_file import MeshError

CHUNK = 1_000_000  # pairs that are compared at a time


class Face(NamedTuple):
    """A convex piece of a block's surface: corners [k, d], m, around the normal out of the block;
    the block; the group of joints, or NO_SET; and the plane, numbered over all blocks."""

    corners: np.ndarray
    cell: int
    joint: int
    plane: int


def vector_areas(corners: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Return the normals of polygons, or of edges of the plane to their right, as long as their
    areas, m2, or lengths, m. corners : of one after the other; sizes : how many each has."""
    first = np.cumsum(sizes) - sizes
    if corners.shape[1] == 2:
        x, y = (corners[first + 1] - corners[first]).T
        return np.stack([y, -x], axis=1)
    after = np.arange(1, len(corners) + 1)
    after[first + sizes - 1] = first
    away = corners - np.repeat(corners[first], sizes, axis=0)
    return np.add.reduceat(np.cross(away, away[after]), first) / 2


def near(x: np.ndarray) -> str:
    """Return the place of some points in words."""
    return " near [{}]".format(", ".join(f"{place:.6g}" for place in x.mean(axis=0)))


def steps(loop: Loop) -> Iterable[tuple[int, int]]:
    """Return each vertex of an outline with the next."""
    return zip(loop, loop[1:] + loop[:1], strict=True)


def faces_of(
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
    loops = [[v for v, after in steps(one) if v != after] for one in (p.tolist() for p in parts)]
    if x.shape[1] == 2:
        away = [x[one[1:]] - x[one[0]] for one in loops]
        turns = [(p[:-1, 0] * p[1:, 1] - p[:-1, 1] * p[1:, 0]).sum() for p in away]
        loops = [one[::-1] if turn < 0 else one for one, turn in zip(loops, turns, strict=True)]
        loops = [list(edge) for one in loops for edge in steps(one)]
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
        edges = {edge for one in loops for edge in steps(one)}
        after = dict(edge for edge in edges if edge[::-1] not in edges)
        loop = [next(iter(after), -1)]
        while (v := after.get(loop[-1], loop[0])) != loop[0] and len(loop) <= len(after):
            loop.append(v)
        if len(loop) == len(after):
            whole = without_straight(x[loop], np.array([0, len(loop)]), tolerance).corners
            if _convex(whole, area / np.linalg.norm(area), tolerance):
                return [whole]
    return [x[one] for one in loops]


def _outward(corners: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the unit vectors out of a polygon at its edges, in its plane."""
    out = np.cross(np.roll(corners, -1, axis=0) - corners, normal)
    return out / np.linalg.norm(out, axis=1)[:, None]


def _convex(corners: np.ndarray, normal: np.ndarray, tolerance: float) -> bool:
    """Return whether no corner lies beyond any edge."""
    out = _outward(corners, normal)
    return bool((out @ corners.T <= (out * corners).sum(axis=1)[:, None] + tolerance).all())


def near_boxes(low: np.ndarray, high: np.ndarray, slack: float) -> np.ndarray:
    """Return the pairs of boxes [m, 2] that are less than `slack` (m) apart along every axis."""
    axis = int(np.argmax(np.ptp(low, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    first = np.arange(1, len(order) + 1)
    after = np.searchsorted(low[order, axis], high[order, axis] + slack)
    found = []
    for some in np.array_split(first - 1, 1 + np.maximum(after - first, 0).sum() // CHUNK):
        at, which = ranges(first[some], after[some])
        i, j = order[some][which], order[at]
        close = ((low[j] < high[i] + slack) & (high[j] > low[i] - slack)).all(axis=1)
        found.append(np.stack([i[close], j[close]], axis=1))
    return np.concatenate(found)


def overlaid(faces: list[Face], normal: np.ndarray, tolerance: float) -> list[Face]:
    """Return faces in space, with unit normals [f, 3], cut into what two share and the rest."""
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
        if max(_off_plane(y, normal[i], x[0]), _off_plane(x, normal[j], y[0])) > tolerance:
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


def _off_plane(x: np.ndarray, normal: np.ndarray, point: np.ndarray) -> float:
    """Return the largest distance of points from a plane, m."""
    return float(np.abs((x - point) @ normal).max())


def overlap(
    x: np.ndarray, by: np.ndarray, normal: np.ndarray, tolerance: float
) -> tuple[np.ndarray | None, list[np.ndarray]]:
    """Return what a convex polygon [k, 3] shares with another one of its plane, and convex pieces
    of the rest; None and the polygon where they share no area."""
    inside, rest = x, []
    for point, out in zip(by, _outward(by, normal), strict=True):
        away = (inside - point) @ out
        if away.max() <= tolerance:
            continue
        if away.min() >= -tolerance:
            return None, [x]
        away[np.abs(away) <= tolerance] = 0.0  # on the line
        rest.append(clipped(inside, away))
        inside = clipped(inside, -away)
    long = float(np.linalg.norm(np.ptp(inside, axis=0)))
    (area,) = vector_areas(inside, np.array([len(inside)]))
    return (inside, rest) if np.linalg.norm(area) > long * tolerance else (None, [x])
