"""Openings: cells are cut along the faces of an opening, those within it are taken out, and pieces
of one block are joined again as far as they stay convex."""

import numpy as np
import shapely

from jointwave.cases.partition.convex import ConvexPieces
from jointwave.cases.partition.lines import one_line
from jointwave.cases.partition.split import split
from jointwave.cases.partition.subdivision import (
    NO_SET,
    OUTSIDE,
    Halves,
    NonConvex,
    Subdivision,
    joined,
    removed,
)


def taken_out(
    sub: Subdivision, polygons: list[tuple[np.ndarray, int]], tolerance: float
) -> Subdivision:
    """Return a subdivision less some polygons (float array [k, 2], and the side of their edges),
    its blocks cut in convex parts along the faces of the polygons."""
    whole = np.arange(sub.count)  # the block that a cell is a part of
    for corners, side in polygons:
        sub, whole = _cut_along(sub, corners, whole, tolerance)
        near = _near(sub, corners, tolerance)
        inside = np.zeros(sub.count, bool)
        at = np.flatnonzero(near)
        inside[at] = shapely.contains_xy(shapely.Polygon(corners), sub.centres()[at])
        sub = removed(sub, inside, side)
    return _rejoined(sub, tolerance)


def check_convex(sub: Subdivision, polygons: list[tuple[np.ndarray, int]]) -> None:
    """Raise NonConvex if a block had to be cut through intact rock beside an opening."""
    cuts = np.flatnonzero(_through_rock(sub))
    if len(cuts):
        raise NonConvex(
            _nearest(sub.points[sub.ends[cuts[0]]], polygons),
            "a block is not convex at an opening, a region or a corner of the outline; "
            'set domain.non_convex = "cut" to cut it into convex parts',
        )


def _nearest(ends: np.ndarray, polygons: list[tuple[np.ndarray, int]]) -> np.ndarray:
    """Return the corner of polygons that is nearest to the ends of a cut [2, 2], or its middle."""
    if not polygons:
        return ends.mean(axis=0)
    corners = np.concatenate([corners for corners, _ in polygons])
    away = ends[:, None] - corners
    return corners[np.argmin(np.hypot(*np.moveaxis(away, 2, 0)).min(axis=0))]


def _near(sub: Subdivision, corners: np.ndarray, tolerance: float) -> np.ndarray:
    """Return which cells' bounding boxes meet that of a polygon, bool array [count]."""
    half = sub.halves()
    near = np.ones(sub.count, bool)
    for axis in (0, 1):
        x = sub.points[half.start, axis]
        low, high = np.full(sub.count, np.inf), np.full(sub.count, -np.inf)
        np.minimum.at(low, half.cell, x)
        np.maximum.at(high, half.cell, x)
        near &= low <= corners[:, axis].max() + tolerance
        near &= high >= corners[:, axis].min() - tolerance
    return near


def _cut_along(
    sub: Subdivision, corners: np.ndarray, whole: np.ndarray, tolerance: float
) -> tuple[Subdivision, np.ndarray]:
    """Return cells cut by those faces of a polygon that pass through them."""
    near = _near(sub, corners, tolerance)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        half = sub.halves(np.append(near, False)[sub.cells].any(axis=1))
        passed = near & passed_by(sub, half, start, end, tolerance)
        cut = near & np.isin(whole, whole[passed])  # all of the block, so that pieces can be chosen
        direction = (end - start) / np.hypot(*(end - start))
        found = split(sub, one_line(direction, start, cut), tolerance)
        sub, near, whole = found.subdivision, near[found.parent], whole[found.parent]
    return sub, whole


def passed_by(
    sub: Subdivision, half: Halves, start: np.ndarray, end: np.ndarray, tolerance: float
) -> np.ndarray:
    """Return which cells a segment passes through, deeper than the tolerance."""
    origin = sub.points[half.start]
    one, other = (-((at - origin) * half.outward).sum(axis=1) - tolerance for at in (start, end))
    slope = other - one
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -one / slope
    enters = np.where(slope > 0, at, np.where((slope == 0) & (one < 0), np.inf, -np.inf))
    leaves = np.where(slope < 0, at, np.inf)
    first, last = np.zeros(sub.count), np.ones(sub.count)
    np.maximum.at(first, half.cell, enters)
    np.minimum.at(last, half.cell, leaves)
    return (last - first) * np.hypot(*(end - start)) > tolerance


def _through_rock(sub: Subdivision) -> np.ndarray:
    """Return which edges are cuts through rock of one region, bool array [e]."""
    one, other = sub.region[sub.cells].T
    inner = (sub.cells != OUTSIDE).all(axis=1)
    return (sub.joint_set[sub.line] == NO_SET) & inner & (one == other)


def _rejoined(sub: Subdivision, tolerance: float) -> Subdivision:
    """Return a subdivision with pieces of a block of one rock joined as far as they stay convex."""
    cuts = np.flatnonzero(_through_rock(sub))
    if not len(cuts):
        return sub
    cells = np.unique(sub.cells[cuts])
    half = sub.halves(np.isin(sub.cells, cells).any(axis=1))
    mine = np.flatnonzero(np.isin(half.cell, cells))
    mine = mine[np.argsort(half.cell[mine], kind="stable")]
    first = np.searchsorted(half.cell[mine], cells)
    own = np.split(sub.points[half.start[mine]], first[1:])
    pieces = ConvexPieces(dict(zip(map(int, cells), own, strict=True)), tolerance)
    length = np.hypot(*np.diff(sub.points[sub.ends[cuts]], axis=1)[:, 0].T)
    for (one, other), part in zip(sub.cells[cuts], length, strict=True):
        pieces.connect(int(one), int(other), float(part))
    return joined(sub, pieces.merged(sub.count))
