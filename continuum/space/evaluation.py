"""Position of a point of the pillar in the mesh, and the elements' functions there."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.body import Body

INSIDE = 1e-7  # how far outside the reference cell a point on its face may come out
CLOSE = 1e-12  # of the reference cell: when Newton's iteration has found a point
ROUNDS = 20
NOTHING = 1e-11  # a basis function that is zero but for round-off


class Places(NamedTuple):
    """Points in cells.

    cell : int array [n]. basis : float array [n, nodes per cell], what is zero but for round-off
    is zero. gradient : float array [n, nodes per cell, dim], 1/m.
    """

    cell: np.ndarray
    basis: np.ndarray
    gradient: np.ndarray


def places_in(body: Body, cell: np.ndarray, x: np.ndarray) -> Places:
    """Return points x [n, dim] (m) of the cells [n] that hold them."""
    return at_reference(body, cell, reference_points(body.mesh.cell, body.corners[cell], x))


def at_reference(body: Body, cell: np.ndarray, at: np.ndarray) -> Places:
    """Return points that are given in reference coordinates [n, dim] of the cells [n]."""
    basis, gradient = basix_versions.tabulate(body.mesh.cell, body.order, at)
    inverse = np.linalg.inv(jacobians(body.mesh.cell, body.corners[cell], at))
    basis = np.where(np.abs(basis) > NOTHING, basis, 0.0)
    return Places(cell, basis, np.einsum("nkd,nde->nke", gradient, inverse))


def quadrature_in(
    body: Body, cells: np.ndarray, degree: int, lobatto: bool = False
) -> tuple[Places, np.ndarray, np.ndarray]:
    """Return the quadrature points of cells, where they are [n, dim] (m), and volumes [n] (m3)."""
    at, weight = basix_versions.quadrature(body.mesh.cell, degree, lobatto)
    cell, at = np.repeat(cells, len(at)), np.tile(at, (cells.size, 1))
    corners = body.corners[cell]
    x = np.einsum("nv,nvd->nd", basix_versions.tabulate(body.mesh.cell, 1, at)[0], corners)
    size = np.abs(np.linalg.det(jacobians(body.mesh.cell, corners, at)))
    return at_reference(body, cell, at), x, body.section.extent * size * np.tile(weight, cells.size)


def jacobians(cell: str, corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return dx/dX [n, dim, dim] of cells with these corners [n, corners, dim] at points [n, dim]
    of the reference cell."""
    _, gradient = basix_versions.tabulate(cell, 1, at)
    return np.einsum("nvd,nve->nde", corners, gradient)


def reference_points(cell: str, corners: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return reference coordinates [n, dim] of points x in cells; Newton, one step where affine."""
    at = np.full_like(x, 0.3)
    for _ in range(ROUNDS):
        basis, _ = basix_versions.tabulate(cell, 1, at)
        missing = x - np.einsum("nv,nvd->nd", basis, corners)
        step = np.linalg.solve(jacobians(cell, corners, at), missing[..., None])[..., 0]
        at = at + step
        if np.abs(step).max(initial=0.0) < CLOSE:
            break
    return at


def cells_at(body: Body, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (point, cell) int arrays of every cell that each point x [n, dim] is in or on."""
    low, high = body.corners.min(axis=1), body.corners.max(axis=1)
    slack = INSIDE * (high - low).max()
    none = np.empty(0, dtype=np.int64)
    points, cells = [none], [none]
    for i, place in enumerate(x):
        near = np.flatnonzero(((low - slack <= place) & (place <= high + slack)).all(axis=1))
        at = reference_points(body.mesh.cell, body.corners[near], np.tile(place, (near.size, 1)))
        here = near[_is_inside(body.mesh.cell, at)]
        points.append(np.full(here.size, i))
        cells.append(here)
    return np.concatenate(points), np.concatenate(cells)


def _is_inside(cell: str, at: np.ndarray) -> np.ndarray:
    inside = (at >= -INSIDE).all(axis=1)
    if cell in ("triangle", "tetrahedron"):
        return inside & (at.sum(axis=1) <= 1 + INSIDE)
    return inside & (at <= 1 + INSIDE).all(axis=1)


def matrix_of(body: Body, rows: np.ndarray, cell: np.ndarray, weights: np.ndarray, count: int):
    """Return the matrix [directions * count, freedoms] of weights [directions, n, nodes per cell,
    components] in rows [n] of each direction.

    What falls on one place is added up; cells without nodes here have none.
    """
    node = np.broadcast_to(body.cells[cell][:, :, None], weights.shape)
    component = np.broadcast_to(np.arange(weights.shape[3]), weights.shape)
    row = rows[:, None, None] + count * np.arange(len(weights))[:, None, None, None]
    row, there = np.broadcast_to(row, weights.shape), (weights != 0.0) & (node >= 0)
    column, shape = (
        body.freedom(node[there], component[there]),
        (len(weights) * count, body.mass.size),
    )
    return csr_matrix((weights[there], (row[there], column)), shape)


def on_freedoms(body: Body, cell: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return sums of weights [directions, n, nodes per cell, components] on every freedom
    [directions, freedoms]."""
    return matrix_of(body, np.zeros(cell.size, dtype=np.int64), cell, weights, 1).toarray()
