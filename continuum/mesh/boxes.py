"""Meshes of box-shaped blocks, in intervals, quadrilaterals or hexahedra."""

from itertools import product
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import GENERIC, Complex
from jointwave.cases.geometry.relations import joined, merged
from jointwave.continuum.mesh.conforming import BOXES, Conforming, facets_of

ALIKE = 1e-9  # distance, over the size of the body, below which vertices coincide
FLAT = 1e-3  # volume, over that of a box of the same edges, below which edges are coplanar


class Boxes(NamedTuple):
    """Boxes in basix's order, the same for equal boxes: vertices of corners [count, 2^d], and
    facets of the complex [count, 2 d].

    Bit i of the number of a corner is its end, 0 or 1, of axis i.
    """

    corners: np.ndarray
    facets: np.ndarray


def boxes_of(body: Complex) -> Boxes | None:
    """Return the cells of a complex as boxes; None if some cell is no box: wrong number of facets
    or corners, corners within an edge, or facets without an opposite facet."""
    half, dim = body.halves(), body.dim
    facet = half.facet[np.argsort(half.cell, kind="stable")]
    own = body.corners(half)
    each = body.vertices_of(np.stack([np.arange(len(facet)), facet], axis=1))
    sizes = (half.cell, 2 * dim), (own[:, 0], 2**dim), (each[:, 0], 2 ** (dim - 1))
    if any((np.bincount(one) != number).any() for one, number in sizes):
        return None
    own, facet = own[:, 1].reshape(body.count, -1), facet.reshape(body.count, -1)
    on = (own[:, None, :, None] == each[:, 1].reshape(*facet.shape, 1, -1)).any(axis=3)
    apart = ~(on[:, :, None] & on[:, None]).any(axis=3)
    if (apart.sum(axis=2) != 1).any():
        return None
    x = body.vertices[own]
    first = (x @ GENERIC[:dim]).argmin(axis=1)
    near = np.nonzero(np.take_along_axis(on, first[:, None, None], 2)[..., 0])[1].reshape(-1, dim)
    far = np.take_along_axis(apart.argmax(axis=2), near, 1)
    order = _axes(x, first, np.take_along_axis(on, far[..., None], 1))
    near, far = (np.take_along_axis(one, order, 1) for one in (near, far))
    bits = np.take_along_axis(on, far[..., None], 1)
    corners = np.empty_like(own)
    np.put_along_axis(corners, (1 << np.arange(dim)) @ bits, own, 1)
    axis, end = _sides(BOXES[dim])
    sides = np.where(end, far[:, axis], near[:, axis])
    found = Boxes(corners, np.take_along_axis(facet, sides, 1))
    return None if _is_flat(body.vertices[corners]) else found


def _axes(x: np.ndarray, first: np.ndarray, beyond: np.ndarray) -> np.ndarray:
    """Return the order of the axes of boxes [n, d], right-handed and the same for equal boxes;
    first : corner at which axes begin. beyond : corners at their far ends, bool [n, d, 2^d]."""
    alone, box = beyond & (beyond.sum(axis=1) == 1)[:, None], np.arange(len(x))
    arms = np.take_along_axis(x, alone.argmax(axis=2)[..., None], 1) - x[box, first][:, None]
    towards = arms @ GENERIC[::-1][: x.shape[2]] / np.linalg.norm(arms, axis=2)
    order = np.argsort(-towards, axis=1)
    if x.shape[2] > 1:
        mirrored = np.linalg.det(np.take_along_axis(arms, order[..., None], 1)) < 0
        order[mirrored, -2:] = order[mirrored, -2:][:, ::-1]
    return order


def _sides(kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the axis normal to each facet of a box, and its end of the axis, 0 or 1."""
    corners = facets_of(kind)
    bits = corners[..., None] >> np.arange(len(corners) // 2) & 1
    axis = (np.ptp(bits, axis=1) == 0).argmax(axis=1)
    return axis, bits[np.arange(len(axis)), 0, axis]


def _is_flat(x: np.ndarray) -> bool:
    """Return whether edges at a corner of some box lie in a line or plane; x : [n, 2^d, d], m."""
    dim = x.shape[2]
    at = np.arange(2**dim)
    arms = np.stack([x[:, at ^ (1 << i)] - x[:, at] for i in range(dim)], axis=3)
    volume = np.abs(np.linalg.det(arms)) / np.linalg.norm(arms, axis=2).prod(axis=2)
    return bool((volume < FLAT).any())


def extents(body: Complex, corners: np.ndarray) -> np.ndarray:
    """Return the longest edge of boxes along each axis [count, d], m."""
    return np.stack([
        np.linalg.norm(body.vertices[a] - body.vertices[b], axis=2).max(axis=1)
        for a, b in _parallel_edges(corners)
    ], axis=1)  # fmt: skip


def along_edges(corners: np.ndarray, wanted: np.ndarray, like: np.ndarray) -> np.ndarray:
    """Return numbers of cells along the axes of boxes [count, d], at least `wanted` [count, d] and
    equal on shared edges; like : of each vertex [v], its partner across periodic sides or itself.
    """
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


def box_mesh(body: Complex, boxes: Boxes, counts: np.ndarray) -> Conforming:
    """Return the mesh of boxes; counts : cells along their axes [count, d]."""
    kind, dim, (corners, faces) = BOXES[body.dim], body.dim, boxes
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


def _grid(kind: str, count: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Divide a box into cells: return the weights of its corners at each vertex [v, 2^d], vertices
    of cells [c, 2^d], and the box facet of each cell facet [c, 2 d], or -1; in basix's order."""
    dim = len(count)
    bits = np.arange(2**dim)[:, None] >> np.arange(dim) & 1
    vertex = np.array(list(product(*map(range, count[::-1] + 1))))[:, ::-1]
    away = (vertex / count)[:, None]
    weights = np.where(bits, away, 1 - away).prod(axis=2)
    cell = np.array(list(product(*map(range, count[::-1]))))[:, ::-1]
    stride = np.cumprod(np.append(1, count[:-1] + 1))
    cells = (cell[:, None] + bits) @ stride
    axis, end = _sides(kind)
    face = np.where(cell[:, axis] == end * (count[axis] - 1), np.arange(2 * dim), -1)
    return weights, cells, face
