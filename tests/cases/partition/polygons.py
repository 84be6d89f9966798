"""Domains cut in the plane; widths and angles of polygons, independent of how these are cut.

Polygons are given by their corners [k, 2], counter-clockwise."""

import numpy as np

from jointwave.cases.geometry.cell_complex import OUTSIDE
from jointwave.cases.geometry.locate import blocks_at


def block_at(found, points):
    """The first block that each point lies in, or OUTSIDE."""
    return np.array([min(some, default=OUTSIDE) for some in blocks_at(found, points)])


def closed(found, tolerance):
    """Assert that the sum of n A vanishes around each block; return that of A [n]."""
    total, around = np.zeros_like(found.centroid), np.zeros(found.count)
    for side, of in ((0, found.contacts), (1, found.contacts), (0, found.boundary)):
        sign = (1 - 2 * side) * of.area[:, None]
        np.add.at(total, of.blocks[:, side], sign * of.normal)
        np.add.at(around, of.blocks[:, side], of.area)
    np.testing.assert_allclose(total, 0, atol=tolerance)
    return around


def width(corners: np.ndarray) -> float:
    """Return the least width of a convex polygon, m: over its sides, the distance of the corner
    that is farthest from it."""
    along = np.roll(corners, -1, axis=0) - corners
    along /= np.hypot(*along.T)[:, None]
    away = corners - corners[:, None]
    return float((along[:, :1] * away[..., 1] - along[:, 1:] * away[..., 0]).max(axis=1).min())


def angles(corners: np.ndarray) -> np.ndarray:
    """Return the interior angles of a polygon, degrees."""
    out, back = (np.roll(corners, -turn, axis=0) - corners for turn in (1, -1))
    cross = out[:, 0] * back[:, 1] - out[:, 1] * back[:, 0]
    return np.degrees(np.arctan2(cross, (out * back).sum(axis=1)))
