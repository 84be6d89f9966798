"""Contact points on the faces of rigid blocks, and each point's share of the face.

vertices : corners and centroid, weighted by the moments of the face. They carry its whole bending
stiffness, and bear at its edges where it opens. midpoint : centres of n equal parts of an edge, or
n x n of a rectangle. gauss : Gauss-Legendre points.
"""

import numpy as np

#: Rule and number of points for a cut through intact rock.
CUT = ("gauss", 2)
#: Residual second moment, over the face's, below which all of it is placed at the centroid.
MERGED = 1e-10


def points_of(rule: str, count: int | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return points and weights of a rule on an edge from 0 to 1; the weights add up to 1.

    count : of points, 2 where absent; "vertices" always has Simpson's three.
    """
    if rule == "vertices":
        return np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6
    count = count or 2
    if rule == "gauss":
        x, w = np.polynomial.legendre.leggauss(count)
        return (1 + x) / 2, w / 2
    return (np.arange(count) + 0.5) / count, np.full(count, 1 / count)


def lever(rule: str, count: int | None = None) -> float:
    """Return the distance of the outermost points from an edge's centre over half its length: 1 -
    1/n for n midpoints, 1 for vertices. They bear the whole load when the face opens."""
    return float(2 * points_of(rule, count)[0].max() - 1)


def bending(rule: str, count: int | None = None) -> float:
    """Return the share of a face's second moments that its points carry: 1 - 1/n^2 for midpoints, 1
    for vertices and, from n = 2, Gauss points."""
    x, weight = points_of(rule, count)
    return float(12 * weight @ (x - 0.5) ** 2)


def vertex_points(corners: np.ndarray, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return points [n, p, t], m, relative to the centroid, and shares [n, p] of convex faces:
    their corners, then the centroid or two points around it.

    corners : around each face, relative to its centroid [n, k, t], m; the last may be repeated.
    spread : second moments over the area [n, t, t], m2. t = 1 for edges, 2 for polygons.

    A fan of triangles about the centroid (for edges: halves) gives corner weights w proportional to
    adjacent area, which have no first moment. With weights b w, b is the largest factor for which
    the corners' second moments b V nowhere exceed the face's S. The residual S - b V then has one
    zero eigenvalue, and two points along the other eigenvector carry the rest. b is 1/4 for
    triangles and 1/3 for parallelograms and edges, without residual; otherwise it is between 1/6
    and 1/2, and the two points lie within the face.
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
