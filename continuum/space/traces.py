"""Nodes on facets of cells and their weights, in the same order on both sides of a joint."""

from typing import Any, NamedTuple

import numpy as np

from jointwave.continuum.mesh.conforming import Places, facets_of
from jointwave.continuum.space.compat import quadrature, reference

FACET = {"triangle": "interval", "quadrilateral": "interval"}
FACET |= {"tetrahedron": "triangle", "hexahedron": "quadrilateral"}
ON = 1e-9  # shape function of a corner below which a node is on a facet without this corner


class Trace(NamedTuple):
    """Nodes of k facets, q of each.

    node : [k, q]. weight : integrals of the shape functions over the facet [k, q], m^(d-1).
    normal : unit vectors out of the cell [k, q, d]. place : [k, q, d], m. The order of nodes
    follows from the numbers of the facet's vertices.
    """

    node: np.ndarray
    weight: np.ndarray
    normal: np.ndarray
    place: np.ndarray


class Reference(NamedTuple):
    """A cell with its basix element, which is complete up to `order`.

    shares : shape functions of the corners at the nodes [nodes, corners]. at : points of a facet's
    quadrature, by shape functions of its corners [r, c]. functions : of the nodes there, times the
    quadrature weights, on each reference facet [facets, r, nodes].
    """

    kind: str
    order: int
    element: Any
    shares: np.ndarray
    at: np.ndarray
    functions: np.ndarray


def reference_cell(kind: str, order: int, element: Any) -> Reference:
    """Return the reference cell of a kind with a basix element, one function a node."""
    corners = reference(kind, 1)
    shares = corners.tabulate(0, element.points)[0, :, :, 0]
    degree = int(element.highest_degree if hasattr(element, "highest_degree") else element.degree)
    functions = []
    for facet in facets_of(kind):
        at, weight = _rule(kind, 2 * degree)
        values = element.tabulate(0, at @ corners.points[facet])[0, :, :, 0]
        functions.append(weight[:, None] * values)
    return Reference(kind, order, element, shares, at, np.array(functions))


def _rule(kind: str, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return quadrature points [n, corners], by shape functions of the corners, and weights [n]."""
    if kind == "interval":
        return np.ones((1, 1)), np.ones(1)
    at, weight = quadrature(FACET[kind], degree)
    return reference(FACET[kind], 1).tabulate(0, at)[0, :, :, 0], weight


def trace(
    cell: Reference, nodes: np.ndarray, vertices: np.ndarray, x: np.ndarray, of: Places
) -> Trace:
    """Return the nodes of facets of cells.

    nodes, vertices : of cells [cells, n]. x : their corners [cells, corners, d], m. of : k facets.
    """
    facets = facets_of(cell.kind)
    own = facets[of.facet]
    order = np.argsort(vertices[of.cell[:, None], own], axis=1)
    rows = np.column_stack([of.facet, np.take_along_axis(own, order, 1)])
    kinds, which = np.unique(rows, axis=0, return_inverse=True)
    which, parts = which.reshape(-1), []
    for k, (facet, *corners) in enumerate(kinds.tolist()):
        some = of.cell[which == k]
        local, shares = _nodes_on(cell, corners)
        places = x[some]
        normal, _ = _normals(cell, facet, cell.shares[local][:, facets[facet]], places)
        _, area = _normals(cell, facet, cell.at, places)
        weight = area @ cell.functions[facet][:, local]
        parts.append((nodes[some][:, local], weight, normal, shares @ places[:, corners]))
    back = np.argsort(np.argsort(which, kind="stable"), kind="stable")
    return Trace(*(np.concatenate(one)[back] for one in zip(*parts, strict=True)))


def _nodes_on(cell: Reference, corners: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes [q] on a facet, and the shape functions of its corners there [q, c]."""
    others = np.delete(cell.shares, corners, axis=1)
    local = np.flatnonzero(np.abs(others).max(axis=1) < ON)
    shares = cell.shares[local][:, corners]
    order = np.lexsort(np.round(shares, 9).T)
    return local[order], shares[order]


def _normals(
    cell: Reference, facet: int, at: np.ndarray, x: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit normals out of cells with corners x [k, corners, d] at points of a facet
    [k, q, d], and the ratio of area to reference area there [k, q]; at : as `Reference.at`."""
    corners, dim = facets_of(cell.kind)[facet], x.shape[2]
    if dim == 1:
        normal = np.ones((len(x), len(at), 1))
    else:
        flat = reference(FACET[cell.kind], 1)
        slopes = flat.tabulate(1, at @ flat.points)[1:, :, :, 0]
        along = np.einsum("aqc,kcd->akqd", slopes, x[:, corners])
        if dim == 2:
            normal = np.stack([-along[0, ..., 1], along[0, ..., 0]], axis=-1)
        else:
            normal = np.cross(*along)
    area = np.linalg.norm(normal, axis=2)
    out = x[:, corners].mean(axis=1) - x.mean(axis=1)
    sense = np.sign(np.einsum("kqd,kd->kq", normal, out))
    return normal * (sense / area)[..., None], area
