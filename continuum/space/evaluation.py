"""The motion of a body and its gradient at points: rows of matrices on its freedoms."""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space import compat
from jointwave.continuum.space.bubbles import bubble_element
from jointwave.continuum.space.model import Body

INSIDE = 1e-7  # of the reference cell: how far outside it a point on its face may come out
CLOSE = 1e-12  # of the reference cell: when Newton's iteration has found a point
ROUNDS = 20
NOTHING = 1e-11  # a basis function that is zero but for round-off
HIGHEST = 4  # order of elements
WITH_BUBBLES = {"triangle": 7, "tetrahedron": 15}  # nodes of elements of order 2
#: Kinds of cells by their dimension and corners.
KINDS = {
    (1, 2): "interval", (2, 3): "triangle", (2, 4): "quadrilateral", (3, 4): "tetrahedron",
    (3, 8): "hexahedron",
}  # fmt: skip


class Places(NamedTuple):
    """Points in cells; a point on several cells is in each.

    point, cell : int arrays [n]. local : in the reference cell [n, d]. basis : float array [n,
    nodes of a cell]. gradient : [n, nodes, d], 1/m.
    """

    point: np.ndarray
    cell: np.ndarray
    local: np.ndarray
    basis: np.ndarray
    gradient: np.ndarray


def nodes_of_cells(body: Body) -> np.ndarray:
    """Return the nodes of the body in each cell, int array [cells, nodes of a cell]."""
    nodes = compat.cell_nodes(body.space)
    return nodes if body.tied is None else body.tied[nodes]


def blocks_of_nodes(body: Body) -> np.ndarray:
    """Return the block of each node, int array; of nodes that several share one of them."""
    if body.space is None:
        return body.block
    found = np.zeros(len(body.x), dtype=np.int64)
    found[nodes_of_cells(body)] = body.block[:, None]
    return found


def kind_of(body: Body) -> str:
    """Return the kind of a body's cells."""
    return KINDS[body.x.shape[1], compat.cell_corners(body.mesh).shape[1]]


def order_of(body: Body) -> int:
    """Return the order of a body's elements."""
    kind, nodes = kind_of(body), nodes_of_cells(body).shape[1]
    return 2 if nodes == WITH_BUBBLES.get(kind) else int(element(kind, nodes).degree)


@cache
def element(kind: str, nodes: int):
    """Return the element of a cell with so many nodes; `points` are their places."""
    if nodes == WITH_BUBBLES.get(kind):
        return bubble_element(kind)
    every = (compat.reference(kind, order) for order in range(1, HIGHEST + 1))
    return next(one for one in every if len(one.points) == nodes)


def lattice_of(kind: str, nodes: int) -> np.ndarray:
    """Return the nodes of an element without those of bubbles, int array: a full lattice."""
    points = element(kind, nodes).points
    if nodes != WITH_BUBBLES.get(kind):
        return np.arange(nodes)
    return np.flatnonzero(np.isclose(2 * points, np.rint(2 * points)).all(axis=1))


def places_of_nodes(body: Body) -> np.ndarray:
    """Return the places of the nodes of each cell [cells, nodes, d], m."""
    kind, corners = kind_of(body), compat.cell_corners(body.mesh)
    points = element(kind, compat.cell_nodes(body.space).shape[1]).points
    return tabulate(kind, corners.shape[1], points)[0] @ corners


def tabulate(kind: str, nodes: int, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return functions [n, nodes] and their gradients [n, nodes, d] at points [n, d] of the
    reference cell."""
    if not len(at):  # an assertion of basix stops the process
        return np.zeros((0, nodes)), np.zeros((0, nodes, at.shape[1]))
    table = element(kind, nodes).tabulate(1, at)[..., 0]
    return table[0], np.moveaxis(table[1:], 0, 2)


def at_reference(body: Body, point: np.ndarray, cell: np.ndarray, at: np.ndarray) -> Places:
    """Return points that are given in reference coordinates [n, d] of cells [n]."""
    kind, corners = kind_of(body), compat.cell_corners(body.mesh)[cell]
    basis, gradient = tabulate(kind, nodes_of_cells(body).shape[1], at)
    inverse = np.linalg.inv(jacobians(kind, corners, at))
    basis = np.where(np.abs(basis) > NOTHING, basis, 0.0)
    return Places(point, cell, at, basis, gradient @ inverse)


def jacobians(kind: str, corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return dx/dX [n, d, d] of cells with these corners [n, corners, d] at points [n, d]."""
    gradient = tabulate(kind, corners.shape[1], at)[1]
    return np.einsum("nvd,nve->nde", corners, gradient)


def reference_points(kind: str, corners: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return reference coordinates [n, d] of points [n, d] in cells; Newton, one step where
    affine."""
    at = np.full_like(x, 0.3)
    for _ in range(ROUNDS):
        missing = x - np.einsum("nv,nvd->nd", tabulate(kind, corners.shape[1], at)[0], corners)
        step = np.linalg.solve(jacobians(kind, corners, at), missing[..., None])[..., 0]
        at = at + step
        if np.abs(step).max(initial=0.0) < CLOSE:
            break
    return at


def places_in(body: Body, x: np.ndarray) -> Places:
    """Return points [m, d], m, in all cells that they are in or on."""
    corners, kind = compat.cell_corners(body.mesh), kind_of(body)
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
    """Return the matrix [count * r, freedoms] of weights [n, r, nodes of a cell, d]: r rows for
    each number of `row` [n], one after the other; what falls on one place adds up."""
    r, dim = weights.shape[1], weights.shape[3]
    node = nodes_of_cells(body)[cell]
    column = dim * node[:, None, :, None] + np.arange(dim)
    rows = r * row[:, None, None, None] + np.arange(r)[:, None, None]
    column, rows = (np.broadcast_to(one, weights.shape).ravel() for one in (column, rows))
    shape = count * r, body.stiffness.shape[0]
    found = csr_matrix((weights.ravel(), (rows, column)), shape)
    found.eliminate_zeros()
    return found
