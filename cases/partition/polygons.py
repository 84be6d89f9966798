"""Area, centroid, second moments, width and angles of many polygons together.

Polygons are given by their corners, one after the other, counter-clockwise, and by the index of
each one's first corner: float array [k, 2] and int array [n + 1].
"""

from typing import NamedTuple

import numpy as np


class Moments(NamedTuple):
    """Area [n], m2; centroid [n, 2], m; second moments of area about the centroid [n, 3], m4: the
    integrals of x x, y y and x y."""

    area: np.ndarray
    centroid: np.ndarray
    second: np.ndarray


def following(first: np.ndarray) -> np.ndarray:
    """Return the index of the corner that comes after each [k]."""
    after = np.arange(1, first[-1] + 1)
    after[first[1:] - 1] = first[:-1]
    return after


def owner(first: np.ndarray) -> np.ndarray:
    """Return the polygon of each corner [k]."""
    return np.repeat(np.arange(len(first) - 1), np.diff(first))


def moments(corners: np.ndarray, first: np.ndarray) -> Moments:
    """Return the moments of polygons, by Green's theorem about a corner of each."""
    whose, after = owner(first), following(first)
    (x, y), (u, v) = (corners - corners[first[:-1]][whose]).T, (0.0, 0.0)
    u, v = x[after], y[after]
    cross = x * v - u * y

    def total(values: np.ndarray, factor: float) -> np.ndarray:
        return np.add.reduceat(values * cross, first[:-1]) / factor

    area = total(np.ones_like(x), 2.0)
    cx, cy = total(x + u, 6.0) / area, total(y + v, 6.0) / area
    xx = total(x * x + x * u + u * u, 12.0) - area * cx * cx
    yy = total(y * y + y * v + v * v, 12.0) - area * cy * cy
    xy = total(x * v + 2 * (x * y + u * v) + u * y, 24.0) - area * cx * cy
    centroid = corners[first[:-1]] + np.stack([cx, cy], axis=1)
    return Moments(area, centroid, np.stack([xx, yy, xy], axis=1))


def widths(corners: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Return the least width of each convex polygon [n], m: over its sides, the distance of the
    corner that is farthest from it."""
    whose, after, number = owner(first), following(first), np.diff(first)
    along = corners[after] - corners
    along /= np.hypot(*along.T)[:, None]
    farthest = np.zeros(len(corners))
    for step in range(1, int(number.max())):
        other = first[whose] + (np.arange(len(corners)) - first[whose] + step) % number[whose]
        away = corners[other] - corners
        np.maximum(farthest, along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0], out=farthest)
    return np.minimum.reduceat(farthest, first[:-1])


def least_angles(corners: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Return the least interior angle of each convex polygon [n], degrees."""
    after = following(first)
    out = corners[after] - corners
    back = np.empty_like(out)
    back[after] = -out
    angle = np.arctan2(out[:, 0] * back[:, 1] - out[:, 1] * back[:, 0], (out * back).sum(axis=1))
    return np.degrees(np.minimum.reduceat(angle, first[:-1]))
