"""Blocks with the corners of a box in quadrilaterals or hexahedra, and intervals."""

from itertools import combinations, product

import numpy as np

from jointwave.cases.geometry.cell_complex import GENERIC, Complex
from jointwave.cases.geometry.relations import composed, distinct, joined, merged
from jointwave.continuum.mesh.conforming import BOXES, Conforming, facets_of

ALIKE = 1e-9  # of the body: vertices of neighbours are one within it
FLAT = 1e-3  # of a box of these edges: the volume below which its corners are in a line or plane


def box_corners(body: Complex) -> np.ndarray | None:
    """Return the corners of each cell in basix's order, vertices [count, 2^d]; None where some cell
    is no box: it has another number of facets, edges or corners, or corners within an edge."""
    half, dim = body.halves(), body.dim
    pairs = np.stack([half.cell, half.facet], axis=1)
    own = body.vertices_of(pairs)
    edges = _edges(body, pairs)
    sizes = (pairs, 2 * dim), (own, 2**dim), (edges, dim * 2 ** (dim - 1))
    for one, number in sizes:
        if (np.bincount(one[:, 0], minlength=body.count) != number).any():
            return None
    own = own[:, 1].reshape(body.count, -1)
    beside = _neighbours(own, edges[:, 1:].reshape(body.count, -1, 2))
    if (beside.sum(axis=2) != dim).any():
        return None
    found = np.take_along_axis(own, _ordered(body.vertices[own], beside), 1)
    return None if _is_flat(body.vertices[found]) else found


def _edges(body: Complex, pairs: np.ndarray) -> np.ndarray:
    """Return the edges of cells, int array [m, 3] of a cell and two vertices; pairs : (cell,
    facet)."""
    if body.dim == 1:
        cell, vertex = pairs[np.lexsort(pairs.T[::-1])].T
        return np.column_stack([cell[::2], vertex.reshape(-1, 2)])
    if body.dim == 3:
        pairs = composed(pairs, body.bounds[1])[0]
    pairs = distinct(pairs)
    return np.column_stack([pairs[:, 0], body.bounds[0][:, 1].reshape(-1, 2)[pairs[:, 1]]])


def _neighbours(own: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return which corners edges join, bool array [n, corners, corners]; own : vertices of each box
    in order [n, corners]. edges : vertices [n, edges, 2]."""
    at = (own[:, None, None] < edges[..., None]).sum(axis=3)
    found, box = np.zeros((*own.shape, own.shape[1]), bool), np.arange(len(own))[:, None]
    found[box, at[..., 0], at[..., 1]] = found[box, at[..., 1], at[..., 0]] = True
    return found


def _ordered(x: np.ndarray, beside: np.ndarray) -> np.ndarray:
    """Return the corners of boxes in basix's order, int array [n, 2^d], alike in equal boxes.

    x : float array [n, 2^d, d], m. beside : which corners edges join, bool array [n, 2^d, 2^d].
    Corner k is from the first along axis i where bit i of k is set.
    """
    box, (_, many, dim) = np.arange(len(x)), x.shape
    found = np.empty(x.shape[:2], np.int64)
    found[:, 0] = (x @ GENERIC[:dim]).argmin(axis=1)
    axes = np.nonzero(beside[box, found[:, 0]])[1].reshape(-1, dim)
    arms = np.take_along_axis(x, axes[..., None], 1) - x[box, found[:, 0]][:, None]
    towards = arms @ GENERIC[::-1][:dim] / np.linalg.norm(arms, axis=2)
    order = np.argsort(-towards, axis=1)
    axes, arms = (np.take_along_axis(axes, order, 1), np.take_along_axis(arms, order[..., None], 1))
    if dim > 1:
        mirrored = np.linalg.det(arms) < 0
        axes[mirrored, -2:] = axes[mirrored, -2:][:, ::-1]
    found[:, 1 << np.arange(dim)] = axes
    for i, j in combinations(range(dim), 2):
        both = beside[box, axes[:, i]] & beside[box, axes[:, j]]
        both[box, found[:, 0]] = False
        found[:, (1 << i) + (1 << j)] = both.argmax(axis=1)
    if dim == 3:
        found[:, 7] = many * (many - 1) // 2 - found[:, :7].sum(axis=1)
    return found


def _is_flat(x: np.ndarray) -> bool:
    """Return whether some box has edges in a line or plane at a corner; x : [n, 2^d, d], m."""
    dim = x.shape[2]
    at = np.arange(2**dim)
    arms = np.stack([x[:, at ^ (1 << i)] - x[:, at] for i in range(dim)], axis=3)
    volume = np.abs(np.linalg.det(arms)) / np.linalg.norm(arms, axis=2).prod(axis=2)
    return bool((volume < FLAT).any())


def extents(body: Complex, corners: np.ndarray) -> np.ndarray:
    """Return the longest edge of boxes along each of their axes [count, d], m."""
    return np.stack([
        np.linalg.norm(body.vertices[a] - body.vertices[b], axis=2).max(axis=1)
        for a, b in _parallel_edges(corners)
    ], axis=1)  # fmt: skip


def along_edges(corners: np.ndarray, wanted: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Return numbers of cells along the axes of boxes [count, d] that neighbours have in common, at
    least those wanted, int array [count, d]; like : int array [v], the vertex that each counts as,
    which differs across periodic sides."""
    corners = like[corners]
    edges = [np.sort(np.stack(ends, axis=2), axis=2) for ends in _parallel_edges(corners)]
    every = np.stack(edges, axis=1)
    number = np.unique(every.reshape(-1, 2), axis=0, return_inverse=True)[1]
    number = number.reshape(every.shape[:3])
    pairs = np.stack(np.broadcast_arrays(number[..., :1], number), axis=-1)
    group = joined(pairs.reshape(-1, 2), int(number.max()) + 1)[number[..., 0]]
    most = np.zeros(int(group.max()) + 1, np.int64)
    np.maximum.at(most, group, wanted)
    return most[group]


def _parallel_edges(corners: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the ends of the edges along each axis of boxes, vertices [count, 2^(d - 1)]."""
    at = np.arange(corners.shape[1])
    axes = 1 << np.arange(corners.shape[1].bit_length() - 1)
    return [(corners[:, at[at & i == 0]], corners[:, at[at & i > 0]]) for i in axes]


def box_mesh(body: Complex, corners: np.ndarray, counts: np.ndarray) -> Conforming:
    """Return the mesh of boxes with `corners` [count, 2^d] and numbers of cells along their axes
    [count, d]."""
    kind, dim = BOXES[body.dim], body.dim
    faces = _faces(body, corners, kind)
    x, cells, block, on, total = [], [], [], [], 0
    for count in np.unique(counts, axis=0):
        own = np.flatnonzero((counts == count).all(axis=1))
        weights, local, face = _grid(kind, count)
        first = total + len(weights) * np.arange(len(own))
        x.append((weights @ body.vertices[corners[own]]).reshape(-1, dim))
        cells.append((first[:, None, None] + local).reshape(-1, 2**dim))
        block.append(np.repeat(own, len(local)))
        on.append(np.where(face >= 0, faces[own][:, face], -1).reshape(-1, 2 * dim))
        total += len(weights) * len(own)
    places, order = np.concatenate(x), np.argsort(np.concatenate(block), kind="stable")
    same = merged(places, ALIKE * float(np.ptp(places, axis=0).max()))
    used, vertex = np.unique(same, return_inverse=True)
    found = vertex.reshape(-1)[np.concatenate(cells)[order]]
    parts = (np.concatenate(one)[order] for one in (block, on))
    return Conforming(kind, places[used], found, *parts)


def _faces(body: Complex, corners: np.ndarray, kind: str) -> np.ndarray:
    """Return the facet of the complex on each facet of boxes, in basix's order, [count, 2 d]."""
    half = body.halves()
    key = np.arange(len(half.cell))
    pairs = body.vertices_of(np.stack([key, half.facet], axis=1))
    vertex = pairs[:, 1].reshape(len(key), -1)
    at = (corners[half.cell][:, None] == vertex[..., None]).argmax(axis=2).sum(axis=1)
    sums = facets_of(kind).sum(axis=1)  # each facet has its own
    found = np.empty((body.count, len(sums)), np.int64)
    found[half.cell, np.searchsorted(sums, at)] = half.facet
    return found


def _grid(kind: str, count: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a box in cells: the weights of its corners at each vertex [v, 2^d], vertices of cells
    [c, 2^d], and the facet of the box on each facet of cells [c, 2 d], or -1; all in basix's order
    of corners and facets."""
    dim = len(count)
    bits = np.arange(2**dim)[:, None] >> np.arange(dim) & 1
    vertex = np.array(list(product(*map(range, count[::-1] + 1))))[:, ::-1]
    away = (vertex / count)[:, None]
    weights = np.where(bits, away, 1 - away).prod(axis=2)
    cell = np.array(list(product(*map(range, count[::-1]))))[:, ::-1]
    stride = np.cumprod(np.append(1, count[:-1] + 1))
    cells = (cell[:, None] + bits) @ stride
    facets, face = facets_of(kind), np.empty((len(cell), 2 * dim), np.int64)
    for k, corners in enumerate(facets):
        axis = np.flatnonzero(np.ptp(bits[corners], axis=0) == 0)[0]
        end = bits[corners[0], axis]
        face[:, k] = np.where(cell[:, axis] == end * (count[axis] - 1), k, -1)
    return weights, cells, face
