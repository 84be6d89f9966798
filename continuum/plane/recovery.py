"""Stress at points, recovered from the elements around them.

Stress from displacements of order p converges as h^p, and as h^(p + 1) at p x p Gauss points of
quadrilaterals, or at the points of the rule of degree 2 (p - 1) in triangles (Barlow, Int. J.
Numer. Meth. Eng. 10, 1976). A polynomial of order p + 1 through those of the elements around a
point, by least squares with weights that fall with the distance, has this order everywhere
(superconvergent patch recovery; Zienkiewicz & Zhu, Int. J. Numer. Meth. Eng. 33, 1992). Elements
beyond a joint or of other rock do not count. Where there are too few the stress is that of the
element at the point.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.body import Body
from jointwave.continuum.space.elasticity import TENSOR, PlaneRock, elastic_moduli
from jointwave.continuum.space.evaluation import at_reference, matrix_of, reference_points
from jointwave.continuum.space.receivers import shares_of_pieces

COMPONENTS = ((0, 0), (1, 1), (0, 1))
LEAST = 1.5  # points for each coefficient of a polynomial
#: Points at a distance s, over the size of the element, count as exp(-FALL s^2 / 2).
FALL = 4.0


def recovered_stress(
    body: Body,
    materials: list[PlaneRock],
    vertex: np.ndarray,
    x: np.ndarray,
    which: np.ndarray,
    cell: np.ndarray,
) -> csr_matrix:
    """Return the stress at points x [n, 2], compression positive: [3 n, freedoms], xx of all
    points, then yy, then xy.

    vertex : int array [cells, corners], of the whole mesh, two on either side of a joint.
    which, cell : int arrays, every cell that each point is in or on; a point on a joint reads the
    mean of both sides.
    """
    piece = _pieces(body)
    share = shares_of_pieces(which, piece[cell])
    row, cells, at, weight = [], [], [], []
    rule = _points(body)
    for point in range(len(x)):
        own = which == point
        for one in np.unique(piece[cell[own]]):
            here = own & (piece[cell] == one)
            side = share[here].sum()
            some, local, shares = _patch(body, piece, vertex, x[point], cell[here], rule)
            row.append(np.full(len(some), point))
            cells.append(some)
            at.append(local)
            weight.append(side * shares)
    none = np.zeros(0, dtype=np.int64)
    cells_, at_ = np.concatenate([none, *cells]), np.concatenate([np.zeros((0, 2)), *at])
    moduli = np.array([elastic_moduli(material, 2, 2) for material in materials])
    of_stress = np.array([moduli[:, i, j] for i, j in COMPONENTS])[:, body.material[cells_]]
    gradient = at_reference(body, cells_, at_).gradient
    weights = -np.einsum(
        "dncj,nkj,n->dnkc", of_stress, gradient, np.concatenate([np.zeros(0), *weight])
    )
    return matrix_of(body, np.concatenate([none, *row]), cells_, weights, len(x))


def _pieces(body: Body) -> np.ndarray:
    """Return which piece of one rock each cell is of, int array [cells]."""
    return body.piece * (1 + body.material.max(initial=0)) + body.material


def _points(body: Body) -> np.ndarray:
    """Return the places in the reference cell where the stress is most accurate [m, 2]."""
    degree = 2 * body.order - 1 if body.mesh.cell in TENSOR else max(2 * body.order - 2, 1)
    return basix_versions.quadrature(body.mesh.cell, degree)[0]


def _patch(
    body: Body,
    piece: np.ndarray,
    vertex: np.ndarray,
    place: np.ndarray,
    own: np.ndarray,
    rule: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return cells [n], places in them [n, 2] and weights [n] of the stresses that make the one at
    a place in or on the cells `own`, which are of one piece."""
    near = np.isin(vertex, vertex[own]).any(axis=1)
    patch = np.flatnonzero(near & (piece == piece[own[0]]))
    cells, at = np.repeat(patch, len(rule)), np.tile(rule, (len(patch), 1))
    corners = body.corners[cells]
    x = np.einsum("nv,nvd->nd", basix_versions.tabulate(body.mesh.cell, 1, at)[0], corners)
    size = np.sqrt(np.ptp(body.corners[own], axis=1).prod(axis=1).mean())
    s = (x - place) / size
    powers = [(i, n - i) for n in range(body.order + 2) for i in range(n + 1)]
    if len(x) < LEAST * len(powers):
        there = np.tile(place, (own.size, 1))
        local = reference_points(body.mesh.cell, body.corners[own], there)
        return own, local, np.full(own.size, 1 / own.size)
    weight = np.exp(-FALL * (s**2).sum(axis=1) / 2)
    terms = weight[:, None] * np.stack([s[:, 0] ** i * s[:, 1] ** j for i, j in powers], axis=1)
    return cells, at, np.linalg.pinv(terms)[0] * weight
