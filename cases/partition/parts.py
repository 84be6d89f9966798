"""The part of the boundary that a pressure acts on."""

import numpy as np
import shapely

from jointwave.cases.partition.shape import Shape, shape_of
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.sources import PlaneLoad

#: Of the domain's size: tolerated distance of an edge from its line.
BESIDE = 1e-6


def covered(domain: Domain, load: PlaneLoad, ends: np.ndarray) -> np.ndarray:
    """Return from where to where, of its length, a load between two points acts on each edge of its
    side or its opening, [n, 2]; both 0 where it does not. ends : float array [n, 2, 2], m."""
    outline = shape_of(domain)
    part, tolerance = np.zeros((len(ends), 2)), BESIDE * outline.size
    for start, end in loaded_lines(outline, load):
        length = float(np.hypot(*(end - start)))
        if length <= tolerance:
            continue
        along = (end - start) / length
        s, off = (ends - start) @ along, np.abs((ends - start) @ [-along[1], along[0]])
        low, high = np.maximum(s.min(axis=1), 0.0), np.minimum(s.max(axis=1), length)
        meets = (off.max(axis=1) <= tolerance) & (high - low > tolerance)
        place = (np.stack([low, high], axis=1) - s[:, :1])[meets] / np.diff(s, axis=1)[meets]
        part[meets] = np.sort(place, axis=1)
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
    found = lines[np.arange(i, j + 1 + (len(lines) if j < i else 0)) % len(lines)]
    found[0, 0], found[-1, 1] = between
    return [(start, end) for start, end in found]


def _off(lines: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the distances of points [m, 2] from lines, [m, n], m."""
    found = shapely.distance(shapely.linestrings(lines), shapely.points(points)[:, None])
    return np.asarray(found)
