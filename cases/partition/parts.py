"""The part of the boundary that a pressure acts on."""

import numpy as np

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
    near = [_off(lines, point) <= BESIDE * outline.size for point in between]
    if (near[0] & near[1]).any():
        return [(between[0], between[1])]
    gaps = np.flatnonzero((lines[:, 0] != np.roll(lines[:, 1], 1, axis=0)).any(axis=1))
    if gaps.size:
        lines = np.roll(lines, -gaps[0], axis=0)
    (i, s), (j, t) = (_place(lines, point) for point in between)
    if gaps.size and (j, t) < (i, s):
        (i, s), (j, t), between = (j, t), (i, s), between[::-1]
    found = [(between[0], lines[i, 1])]
    k = (i + 1) % len(lines)
    while k != j:
        found.append((lines[k, 0], lines[k, 1]))
        k = (k + 1) % len(lines)
    return [*found, (lines[j, 0], between[1])]


def _place(lines: np.ndarray, point: np.ndarray) -> tuple[int, float]:
    """Return the line that is nearest to a point, and where on it, of its length."""
    k = int(_off(lines, point).argmin())
    start, along = lines[k, 0], lines[k, 1] - lines[k, 0]
    return k, float(np.clip((point - start) @ along / (along @ along), 0.0, 1.0))


def _off(lines: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Return the distance of a point from each line [n], m."""
    start, along = lines[:, 0], np.diff(lines, axis=1)[:, 0]
    t = np.clip(((point - start) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return np.hypot(*(start + t[:, None] * along - point).T)
