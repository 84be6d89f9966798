"""Contact points of the faces between rigid blocks, and the share of the face that each stands for.

vertices : the corners and the centroid, by the moments of the face. They carry all of its bending
stiffness, and where it opens they bear at its edges. midpoint : the centres of n equal parts of an
edge, or n x n of a rectangle. gauss : the Gauss-Legendre points.
"""

import numpy as np

#: Rule and number of points of a cut through intact rock.
CUT = ("gauss", 2)
#: Of a face's second moments: below it what its corners leave lies in the centroid.
MERGED = 1e-10


def points_of(rule: str, count: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return places and weights of a rule on an edge from 0 to 1; weights add up to 1.

    count : of points, 2 where absent; vertices are Simpson's three.
    """
    if rule == "vertices":
        return np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6
    count = count or 2
    if rule == "gauss":
        x, w = np.polynomial.legendre.leggauss(count)
        return (1 + x) / 2, w / 2
    return (np.arange(count) + 0.5) / count, np.full(count, 1 / count)


def lever(rule: str, count: int | None = None) -> float:
    """Return how far the outermost points are from the centre of an edge, over half its length:
    1 - 1/n of n midpoints, 1 of vertices. They bear all that a face bears when it opens as far as
    it can."""
    return float(2 * points_of(rule, count)[0].max() - 1)


def bending(rule: str, count: int | None = None) -> float:
    """Return the part of a face's second moments that its points have: 1 - 1/n^2 of midpoints, all
    of vertices and, from n = 2, of Gauss points."""
    x, weight = points_of(rule, count)
    return float(12 * weight @ (x - 0.5) ** 2)


def vertex_points(corners: np.ndarray, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return places [n, p, t], m, from the centroid, and shares [n, p] of the points of convex
    faces: their corners, then the centroid or two points about it.

    corners : around each face, from its centroid [n, k, t], m; the last may be repeated. spread :
    second moments over the area [n, t, t], m2. t = 1 of edges, 2 of polygons.

    A fan about the centroid has a triangle (edge: half) at each corner; corners whose weights w are
    in proportion to the area beside them have no first moment. Of b w, b is the largest for which
    their second moments b V leave none negative of the face's S. One of what is left, S - b V, is
    then zero, and two points in the other's direction have it. On triangles b is 1/4 and on
    parallelograms and edges 1/3, and nothing is left; elsewhere b is between 1/6 and 1/2, and these
    points lie within the face.
    """
    weight = np.abs(corners).sum(axis=2)
    if corners.shape[2] == 2:
        after = np.roll(corners, -1, axis=1)
        fan = np.abs(corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0])
        weight = fan + np.roll(fan, 1, axis=1)
    weight = weight / weight.sum(axis=1, keepdims=True)
    second = corners.swapaxes(1, 2) @ (weight[..., None] * corners)
    back = np.linalg.inv(np.linalg.cholesky(spread))
    part = 1 / np.linalg.eigvalsh(back @ second @ back.swapaxes(1, 2))[:, -1, None]
    left, axes = np.linalg.eigh(spread - part[..., None] * second)
    if (left[:, -1] <= MERGED * np.trace(spread, axis1=1, axis2=2)).all():
        inner = np.zeros_like(corners[:, :1])
    else:
        away = axes[..., -1] * np.sqrt(np.maximum(left[:, -1:], 0.0) / (1 - part))
        inner = np.stack([away, -away], axis=1)
    rest = np.repeat(1 - part, inner.shape[1], axis=1) / inner.shape[1]
    return np.concatenate([corners, inner], axis=1), np.concatenate([part * weight, rest], axis=1)
