"""Contact points of edges and square faces between blocks, and what each stands for."""

import numpy as np

#: Rule and number of points of a cut through intact rock.
CUT = ("gauss", 2)


def points_of(rule: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return places and weights [count] of a rule on an edge from 0 to 1; weights add up to 1.

    midpoint: the centres of equal parts; gauss: the Gauss-Legendre points; lobatto: the
    Gauss-Lobatto points, two of them the ends (Davis & Rabinowitz, Methods of numerical
    integration, 1984, 2.7).
    """
    if rule == "lobatto":
        last = np.polynomial.legendre.Legendre.basis(count - 1)
        x = np.concatenate([[-1.0], np.sort(last.deriv().roots().real), [1.0]])
        x = (x - x[::-1]) / 2  # symmetric to the last bit
        return (1 + x) / 2, 1 / (count * (count - 1) * last(x) ** 2)
    if rule == "gauss":
        x, w = np.polynomial.legendre.leggauss(count)
        return (1 + x) / 2, w / 2
    return (np.arange(count) + 0.5) / count, np.full(count, 1 / count)


def lever(rule: str, count: int) -> float:
    """Return how far the outermost points are from the centre of an edge, over half its length:
    1 - 1/n of n midpoints, 1 of Lobatto's points. They bear all that a face bears when it opens as
    far as it can."""
    return float(2 * points_of(rule, count)[0].max() - 1)


def face_points(side: float, count: int, rule: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x (m), z (m) and area (m2) of the n x n contact points of a square face, each [n * n].

    midpoint: as in Guo & Li (2002), (2), for n = 2; they carry 1 - 1/n^2 of the face's bending
    stiffness. gauss: for n >= 2 they carry all of it. Both are symmetric to the last bit.
    """
    at, share = points_of(rule, count)
    at, share = side * (at - at[::-1]) / 2, side * (share + share[::-1]) / 2
    x, z = np.meshgrid(at, at, indexing="ij")
    return x.ravel(), z.ravel(), np.outer(share, share).ravel()
