"""The part of the boundary that a pressure acts on."""

import numpy as np
import shapely

from jointwave.cases.partition.shape import Shape, shape_of
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.sources import PlaneLoad

#: Of the domain's size: tolerated distance of an edge from its line.
BESIDE = 1e-6


def covered(domain: Domain, load: PlaneLoad, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return from where to where, of its length, a pressure acts on each edge of its side or its
    opening, [n, 2]; both 0 where it does not. starts, ends : float arrays [n, 2], m."""
    if load.between is None:
        return np.tile([0.0, 1.0], (len(starts), 1))
    outline = shape_of(domain)
    part, tolerance = np.zeros((len(starts), 2)), BESIDE * outline.size
    for start, end in loaded_lines(outline, load):
        length = float(np.hypot(*(end - start)))
        if length <= tolerance:
            continue
        along = (end - start) / length
        s, off = [], []
        for points in (starts, ends):
            s.append((points - start) @ along)
            off.append(np.abs((points - start) @ [-along[1], along[0]]))
        beside = np.maximum(*off) <= tolerance
        low, high = np.maximum(np.minimum(*s), 0.0), np.minimum(np.maximum(*s), length)
        meets = beside & (high - low > tolerance)
        span = np.where(meets, s[1] - s[0], 1.0)
        place = np.sort(np.stack([(low - s[0]) / span, (high - s[0]) / span], axis=1), axis=1)
        part[meets] = place[meets]
    return part


def loaded_lines(outline: Shape, load: PlaneLoad) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the straight parts of the boundary, from point to point, between the two points of a
    load: of one face what is between them; of a side that has ends, from one to the other; else,
    as of an opening, from the first to the second counter-clockwise around it."""
    lines, between = outline.edges(load.side, load.opening), np.array(load.between)
    if (_off(lines, between) <= BESIDE * outline.size).all(axis=0).any():
        return [(between[0], between[1])]
    gaps = np.flatnonzero((lines[:, 0] != np.roll(lines[:, 1], 1, axis=0)).any(axis=1))
    if gaps.size:
        lines = np.roll(lines, -gaps[0], axis=0)
    i, j = _off(lines, between).argmin(axis=1)
    if gaps.size and j < i:
        i, j, between = j, i, between[::-1]
    found = [(between[0], lines[i, 1])]
    k = (i + 1) % len(lines)
    while k != j:
        found.append((lines[k, 0], lines[k, 1]))
        k = (k + 1) % len(lines)
    return [*found, (lines[j, 0], between[1])]


def _off(lines: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the distances of points [m, 2] from lines, [m, n], m."""
    found = shapely.distance(shapely.linestrings(lines), shapely.points(points)[:, None])
    return np.asarray(found)
