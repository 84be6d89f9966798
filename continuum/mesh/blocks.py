"""The cells of all blocks of a partition, which share the nodes of the segments between them."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from jointwave.continuum.mesh.cells import FACETS, oriented
from jointwave.continuum.mesh.facets import row_numbers
from jointwave.continuum.mesh.segments import Loops, Segments
from jointwave.continuum.mesh.templates import ONE, Template, quadrilaterals, triangles

ALIKE = 1e-9  # of the domain: tolerance for equal shapes of blocks


class BlockEdges(NamedTuple):
    """Edges of cells on segments, one after the other around each block; int arrays [n].

    segment, number : segment, and number of the edge on it from its first end. block. cell, facet.
    vertex : [n, 2].
    """

    segment: np.ndarray
    number: np.ndarray
    block: np.ndarray
    cell: np.ndarray
    facet: np.ndarray
    vertex: np.ndarray


def has_four_corners(loops: Loops) -> np.ndarray:
    """Return which blocks can be meshed with quadrilaterals, bool array [blocks]."""
    corners = np.add.reduceat(loops.is_corner, loops.first[:-1])
    return (np.diff(loops.first) == 4) & (corners == 4)


def cells_along(segments: Segments, loops: Loops, size: float, across: bool) -> np.ndarray:
    """Return the number of cells along each segment [s]; across : equal on opposite edges."""
    wanted = np.maximum(1, np.ceil(segments.length / size * (1 - 1e-9))).astype(np.int64)
    pairs = [np.stack([np.arange(len(wanted)), segments.like], axis=1)]
    if across:
        edges = loops.segment.reshape(-1, 4)
        pairs += [edges[:, [0, 2]], edges[:, [1, 3]]]
    pair = np.concatenate(pairs)
    graph = coo_matrix((np.ones(len(pair)), pair.T), 2 * wanted.shape)
    group = connected_components(graph, directed=False)[1]
    most = np.zeros(group.max() + 1, dtype=np.int64)
    np.maximum.at(most, group, wanted)
    return most[group]


def meshed_blocks(
    segments: Segments, loops: Loops, counts: np.ndarray, size: float, kind: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, BlockEdges]:
    """Return vertices, cells, the block of each cell, and the edges on segments; not cut yet."""
    x, vertex, edges, around = _on_segments(segments, loops, counts)
    places, cells, block, count = [x], [], [], len(x)
    for template, own in _templates(x, vertex, loops, counts, size, kind):
        starts = loops.first[own][:, None] + np.arange(
            loops.first[own[0] + 1] - loops.first[own[0]]
        )
        corners = x[vertex[around[starts]]]
        inside = count + np.arange(len(own) * len(template.inside)).reshape(len(own), -1)
        loop = vertex[around[starts[:, 0]][:, None] + np.arange(_length(around, loops, own[0]))]
        local = np.concatenate([loop, inside], axis=1)
        cells.append(local[:, template.cells].reshape(-1, template.cells.shape[1]))
        block.append(np.repeat(own, len(template.cells)))
        places.append(template.placed(corners).reshape(-1, 2))
        count += inside.size
    order = np.argsort(np.concatenate(block), kind="stable")
    x, block = np.concatenate(places), np.concatenate(block)[order]
    found = oriented(kind, x, np.concatenate(cells)[order])
    return x, found, block, _with_cells(edges, kind, found, block)


def _length(around: np.ndarray, loops: Loops, block: int) -> int:
    """Return the number of nodes around a block."""
    return int(around[loops.first[block + 1]] - around[loops.first[block]])


def _on_segments(
    segments: Segments, loops: Loops, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, BlockEdges, np.ndarray]:
    """Return the nodes on segments [n, 2], m; those around all blocks [k]; the edges between them,
    without their cells; and the index at which each segment of the loops begins."""
    inner = counts - 1
    base = len(segments.x) + np.cumsum(inner) - inner
    of = np.repeat(np.arange(len(counts)), inner)
    place = (1 + np.arange(of.size) - np.repeat(np.cumsum(inner) - inner, inner)) / counts[of]
    start, end = segments.x[segments.point[of]].swapaxes(0, 1)
    x = np.concatenate([segments.x, start + place[:, None] * (end - start)])
    many = counts[loops.segment]
    around = np.concatenate([[0], np.cumsum(many)])
    item = np.repeat(np.arange(many.size), many)
    step, segment, forward = (
        np.arange(item.size) - around[item],
        loops.segment[item],
        loops.forward[item],
    )
    number = np.where(forward, step, counts[segment] - 1 - step)
    at = np.where(forward, number, number + 1)
    ends = np.where(forward, segments.point[segment, 0], segments.point[segment, 1])
    vertex = np.where(step == 0, ends, base[segment] + at - 1)
    block = np.repeat(np.arange(len(loops.first) - 1), np.diff(around[loops.first]))
    following = 1 + np.arange(vertex.size)
    following[around[loops.first[1:]] - 1] = around[loops.first[:-1]]
    none = np.full(vertex.size, -1)
    pair = np.stack([vertex, vertex[following]], axis=1)
    return x, vertex, BlockEdges(segment, number, block, none, none, pair), around


def _templates(
    x: np.ndarray, vertex: np.ndarray, loops: Loops, counts: np.ndarray, size: float, kind: str
) -> list[tuple[Template, np.ndarray]]:
    """Return templates, each with its blocks [n]."""
    if kind == "quadrilateral":
        pair = counts[loops.segment.reshape(-1, 4)[:, :2]]
        different, which = np.unique(pair, axis=0, return_inverse=True)
        which = which.reshape(-1)
        return [
            (quadrilaterals(m, n), np.flatnonzero(which == k))
            for k, (m, n) in enumerate(different.tolist())
        ]
    around = np.concatenate([[0], np.cumsum(counts[loops.segment])])
    is_cell = np.diff(around[loops.first]) == 3
    alone = [(ONE, np.flatnonzero(is_cell))] if is_cell.any() else []
    alike: dict[bytes, list[int]] = {}
    shapes = []
    for block in np.flatnonzero(~is_cell):
        own = slice(loops.first[block], loops.first[block + 1])
        corners, many = x[vertex[around[:-1][own]]], counts[loops.segment[own]]
        shape = np.rint((corners - corners[0]) / (ALIKE * np.ptp(x, axis=0).max()))
        key = shape.tobytes() + many.tobytes()
        if key not in alike:
            shapes.append((corners, many))
        alike.setdefault(key, []).append(block)
    found = triangles(shapes, size) if shapes else []
    return alone + [(t, np.array(own)) for t, own in zip(found, alike.values(), strict=True)]


def _with_cells(edges: BlockEdges, kind: str, cells: np.ndarray, block: np.ndarray) -> BlockEdges:
    """Return edges with the cell of their block and its facet that each belongs to."""
    table = FACETS[kind]
    facets = np.sort(cells[:, table].reshape(-1, 2), axis=1)
    every = np.column_stack([np.repeat(block, len(table)), facets])
    own = np.column_stack([edges.block, np.sort(edges.vertex, axis=1)])
    number = row_numbers(np.concatenate([every, own]))
    at = np.empty(number.max() + 1, dtype=np.int64)
    at[number[: len(every)]] = np.arange(len(every))
    cell, facet = np.divmod(at[number[len(every) :]], len(table))
    return edges._replace(cell=cell, facet=facet)
