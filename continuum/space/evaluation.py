"""Evaluation of a body's motion and its gradient at points, as matrix rows on its freedoms."""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space import compat
from jointwave.continuum.space.model import Body

INSIDE = 1e-7  # distance outside the reference cell at which a point is on its face
CLOSE = 1e-12  # convergence of Newton's iteration in reference coordinates
ROUNDS = 20
NOTHING = 1e-11  # value of a basis function that counts as zero


class Places(NamedTuple):
    """Points in cells; a point on several cells appears once for each.

    point, cell : numbers [n]. local : reference coordinates [n, d]. basis : functions of the nodes
    [n, nodes of a cell]. gradient : of these [n, nodes, d], 1/m.
    """

    point: np.ndarray
    cell: np.ndarray
    local: np.ndarray
    basis: np.ndarray
    gradient: np.ndarray


def nodes_of_cells(body: Body) -> np.ndarray:
    """Return the nodes of the body in each cell [cells, nodes of a cell]."""
    nodes = compat.cell_nodes(body.space)
    return nodes if body.tied is None else body.tied[nodes]


def blocks_of_nodes(body: Body) -> np.ndarray:
    """Return the block of each node [nodes], any one for a node of several blocks."""
    if body.space is None:
        return body.block
    found = np.zeros(len(body.x), dtype=np.int64)
    found[nodes_of_cells(body)] = body.block[:, None]
    return found


def places_of_nodes(body: Body) -> np.ndarray:
    """Return the places of the nodes of each cell [cells, nodes, d], m."""
    return body.cell.shares @ compat.cell_corners(body.mesh)


def tabulate(element: Any, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the functions [n, nodes] of a basix element and their gradients [n, nodes, d] at
    points [n, d] of the reference cell."""
    if not len(at):  # basix would abort the process by an assertion
        nodes = len(element.points)
        return np.zeros((0, nodes)), np.zeros((0, nodes, at.shape[1]))
    table = element.tabulate(1, at)[..., 0]
    return table[0], np.moveaxis(table[1:], 0, 2)


def at_reference(body: Body, point: np.ndarray, cell: np.ndarray, at: np.ndarray) -> Places:
    """Return `Places` of points given in reference coordinates [n, d] of cells [n]."""
    basis, gradient = tabulate(body.cell.element, at)
    corners = compat.cell_corners(body.mesh)[cell]
    inverse = np.linalg.inv(jacobians(body.cell.kind, corners, at))
    basis = np.where(np.abs(basis) > NOTHING, basis, 0.0)
    return Places(point, cell, at, basis, gradient @ inverse)


def jacobians(kind: str, corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return dx/dX [n, d, d] of cells with these corners [n, corners, d] at points [n, d]."""
    gradient = tabulate(compat.reference(kind, 1), at)[1]
    return np.einsum("nvd,nve->nde", corners, gradient)


def reference_points(kind: str, corners: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return reference coordinates [n, d] of points [n, d] in cells, by Newton's method."""
    at, flat = np.full_like(x, 0.3), compat.reference(kind, 1)
    for _ in range(ROUNDS):
        missing = x - np.einsum("nv,nvd->nd", tabulate(flat, at)[0], corners)
        step = np.linalg.solve(jacobians(kind, corners, at), missing[..., None])[..., 0]
        at = at + step
        if np.abs(step).max(initial=0.0) < CLOSE:
            break
    return at


def places_in(body: Body, x: np.ndarray) -> Places:
    """Return `Places` of points [m, d], m, in all cells that contain them."""
    corners, kind = compat.cell_corners(body.mesh), body.cell.kind
    low, high = corners.min(axis=1), corners.max(axis=1)
    slack = INSIDE * float((high - low).max(initial=0.0))
    near = [np.flatnonzero(((low - slack <= one) & (one <= high + slack)).all(axis=1)) for one in x]
    cell = np.concatenate([np.zeros(0, np.int64), *near])
    point = np.repeat(np.arange(len(x)), [len(one) for one in near])
    at = reference_points(kind, corners[cell], x[point])
    inside = (at >= -INSIDE).all(axis=1)
    if kind in ("triangle", "tetrahedron"):
        inside &= at.sum(axis=1) <= 1 + INSIDE
    else:
        inside &= (at <= 1 + INSIDE).all(axis=1)
    return at_reference(body, point[inside], cell[inside], at[inside])


def matrix_of(body: Body, row: np.ndarray, cell: np.ndarray, weights: np.ndarray, count: int):
    """Return the matrix [count * r, freedoms] from weights [n, r, nodes of a cell, d]; `row` [n] is
    the group of r rows of each, and entries at the same position are summed."""
    r, dim = weights.shape[1], weights.shape[3]
    node = nodes_of_cells(body)[cell]
    column = dim * node[:, None, :, None] + np.arange(dim)
    rows = r * row[:, None, None, None] + np.arange(r)[:, None, None]
    column, rows = (np.broadcast_to(one, weights.shape).ravel() for one in (column, rows))
    shape = count * r, body.stiffness.shape[0]
    found = csr_matrix((weights.ravel(), (rows, column)), shape)
    found.eliminate_zeros()
    return found
