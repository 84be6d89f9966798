"""The mesh of a rock mass in the plane, from its partition into convex blocks.

Blocks share the nodes of the segments between them; what joints cut is doubled afterwards. Where
every block has four corners, and none meets more than one other along an edge, cells are
quadrilaterals, else triangles.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from cases.partition.blocks import Partition
from cases.partition.subdivision import NO_SET
from continuum.mesh.cells import FACETS, oriented
from continuum.mesh.cut import pieces, split
from continuum.mesh.description import Joints, Mesh, Part, Side
from continuum.mesh.facets import row_numbers
from continuum.mesh.segments import Across, Loops, Segments, segments_of
from continuum.mesh.templates import Template, quadrilaterals, triangles

ALIKE = 1e-9  # of the domain: pieces that are copies of each other
REPEATED = 6  # copies from which a part is worth lanes of its own
CORNER = {3: "triangle", 4: "quadrilateral"}


class PlaneMesh(NamedTuple):
    """A mesh and what it is made of.

    mesh : its joints are numbered by contact, first the partition's, then those across periodic
        sides. block : int array [cells], of the partition. piece : int array [cells], of the rock
        that joints do not cut.
    """

    mesh: Mesh
    block: np.ndarray
    piece: np.ndarray


class _Edges(NamedTuple):
    """Edges of cells on segments, one after the other around each block; int arrays [n].

    segment, number : which of the edges on a segment, from its first end. block. cell, facet.
    vertex : [n, 2].
    """

    segment: np.ndarray
    number: np.ndarray
    block: np.ndarray
    cell: np.ndarray
    facet: np.ndarray
    vertex: np.ndarray


def has_four_corners(loops: Loops) -> np.ndarray:
    """Return which blocks can be cut into quadrilaterals, bool array [blocks]."""
    corners = np.add.reduceat(loops.is_corner, loops.first[:-1])
    return (np.diff(loops.first) == 4) & (corners == 4)


def plane_mesh(
    partition: Partition,
    across: list[Across],
    sizes: Mapping[str, float],
    cell: str | None = None,
) -> PlaneMesh:
    """Return the mesh of a partition; sizes : about how large quadrilaterals and triangles are, m.

    cell : "quadrilateral" or "triangle"; None for the first where it can be. Raises ValueError
    where blocks cannot be cut into quadrilaterals.
    """
    segments, loops = segments_of(partition, across)
    four = has_four_corners(loops)
    if cell == "quadrilateral" and not four.all():
        x, y = partition.centroid[np.argmin(four)]
        raise ValueError(
            f"the block at ({x:.4g}, {y:.4g}) m has not four edges, one neighbour each"
        )
    kind = cell or ("quadrilateral" if four.all() else "triangle")
    size = sizes[kind]
    counts = _counts(segments, loops, size, kind == "quadrilateral")
    x, cells, block, edges = _meshed(segments, loops, counts, size, kind)
    sets = [partition.contacts.joint_set, *(c.joint_set for c, _, _ in across)]
    joint_set = np.append(np.concatenate(sets), NO_SET)  # the last is the boundary's
    cuts = joint_set[segments.contact[edges.segment]] != NO_SET
    cut = np.zeros((len(cells), len(FACETS[kind])), dtype=bool)
    cut[edges.cell[cuts], edges.facet[cuts]] = True
    whole, doubled = split(kind, x, cells, cut)
    piece = pieces(doubled)
    parts, number = _parts(whole, doubled, piece, ALIKE * np.ptp(x, axis=0).max())
    edges = edges._replace(cell=number[edges.cell])
    sides = {
        name: Side(edges.cell[there], x[edges.vertex[there]])
        for k, name in enumerate(partition.sides)
        if (there := segments.side[edges.segment] == k).any()
    }
    joints = _joints(partition, across, segments, edges, x, cuts)
    order = np.argsort(number)
    return PlaneMesh(Mesh(kind, parts, (), joints, sides), block[order], piece[order])


def _counts(segments: Segments, loops: Loops, size: float, across: bool) -> np.ndarray:
    """Return the cells along each segment, int array [s]; across : as many on opposite edges."""
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


def _meshed(
    segments: Segments, loops: Loops, counts: np.ndarray, size: float, kind: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray, _Edges]:
    """Return vertices, cells, the block of each cell, and the edges on segments; not cut yet."""
    x, vertex, edges, around = _on_segments(segments, loops, counts)
    blocks = np.arange(len(loops.first) - 1)
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
    assert blocks.size == block.max() + 1
    return x, found, block, _with_cells(edges, kind, found, block)


def _length(around: np.ndarray, loops: Loops, block: int) -> int:
    """Return the nodes around a block."""
    return int(around[loops.first[block + 1]] - around[loops.first[block]])


def _on_segments(
    segments: Segments, loops: Loops, counts: np.ndarray
) -> tuple[np.ndarray, np.ndarray, _Edges, np.ndarray]:
    """Return the nodes on segments [n, 2], m; those around all blocks [k]; the edges between them,
    without their cells; and where each segment of the loops begins among them."""
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
    return x, vertex, _Edges(segment, number, block, none, none, pair), around


def _templates(
    x: np.ndarray, vertex: np.ndarray, loops: Loops, counts: np.ndarray, size: float, kind: str
) -> list[tuple[Template, np.ndarray]]:
    """Return templates and the blocks [n] that each is for."""
    if kind == "quadrilateral":
        pair = counts[loops.segment.reshape(-1, 4)[:, :2]]
        different, which = np.unique(pair, axis=0, return_inverse=True)
        which = which.reshape(-1)
        return [
            (quadrilaterals(m, n), np.flatnonzero(which == k))
            for k, (m, n) in enumerate(different.tolist())
        ]
    around = np.concatenate([[0], np.cumsum(counts[loops.segment])])
    alike: dict[bytes, list[int]] = {}
    shapes = []
    for block in range(len(loops.first) - 1):
        own = slice(loops.first[block], loops.first[block + 1])
        corners, many = x[vertex[around[:-1][own]]], counts[loops.segment[own]]
        shape = np.rint((corners - corners[0]) / (ALIKE * np.ptp(x, axis=0).max()))
        key = shape.tobytes() + many.tobytes()
        if key not in alike:
            shapes.append((corners, many))
        alike.setdefault(key, []).append(block)
    found = triangles(shapes, size)
    return [(t, np.array(own)) for t, own in zip(found, alike.values(), strict=True)]


def _with_cells(edges: _Edges, kind: str, cells: np.ndarray, block: np.ndarray) -> _Edges:
    """Return edges with the cell of their block that each belongs to, and which facet it is."""
    table = FACETS[kind]
    facets = np.sort(cells[:, table].reshape(-1, 2), axis=1)
    every = np.column_stack([np.repeat(block, len(table)), facets])
    own = np.column_stack([edges.block, np.sort(edges.vertex, axis=1)])
    number = row_numbers(np.concatenate([every, own]))
    at = np.empty(number.max() + 1, dtype=np.int64)
    at[number[: len(every)]] = np.arange(len(every))
    cell, facet = np.divmod(at[number[len(every) :]], len(table))
    return edges._replace(cell=cell, facet=facet)


def _parts(
    x: np.ndarray, cells: np.ndarray, piece: np.ndarray, same: float
) -> tuple[tuple[Part, ...], np.ndarray]:
    """Return the pieces of the rock as parts, and the new number of each cell.

    Pieces that are alike are copies; what occurs seldom is one part together.
    """
    own = np.split(np.argsort(piece, kind="stable"), np.cumsum(np.bincount(piece))[:-1])
    alike: dict[bytes, list[np.ndarray]] = {}
    for some in own:
        vertices, local = _in_order(cells[some])
        shape = np.rint((x[vertices] - x[vertices[0]]) / same)
        alike.setdefault(shape.tobytes() + local.tobytes(), []).append(some)
    groups = [some for some in alike.values() if len(some) >= REPEATED]
    alone = [one for some in alike.values() if len(some) < REPEATED for one in some]
    if alone:
        groups.append([np.sort(np.concatenate(alone))])
    number, parts = np.empty(len(cells), dtype=np.int64), []
    ordered = np.concatenate([cells_of for group in groups for cells_of in group])
    number[ordered] = np.arange(len(cells))
    for group in groups:
        vertices, local = _in_order(cells[group[0]])
        first = np.array([cells[one[0], 0] for one in group])
        shifts = x[first] - x[first[0]]
        parts.append(Part(x[vertices], local, np.zeros(len(local), dtype=np.int64), shifts))
    return tuple(parts), number


def _in_order(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices of cells as these come to them, and the cells by their places there."""
    vertices, first, local = np.unique(cells, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(order.size, dtype=np.int64)
    rank[order] = np.arange(order.size)
    return vertices[order], rank[local].reshape(cells.shape)


def _joints(
    partition: Partition,
    across: list[Across],
    segments: Segments,
    edges: _Edges,
    x: np.ndarray,
    cuts: np.ndarray,
) -> Joints:
    """Return the facets that joints hold together, by contact and along it: of its block i on the
    left, of its block j on the right."""
    own = np.flatnonzero(cuts)
    contact = segments.contact[edges.segment[own]]
    blocks = np.concatenate([partition.contacts.blocks, *(c.blocks for c, _, _ in across)])
    is_left = (edges.block[own] == blocks[contact, 0]) & (
        segments.like[edges.segment[own]] == edges.segment[own]
    )
    order = np.lexsort((edges.number[own], contact))
    left, right = (own[order][choice[order]] for choice in (is_left, ~is_left))
    none = np.zeros((len(partition.contacts), 2))
    shift = np.concatenate([none, *(np.tile(by, (len(c), 1)) for c, by, _ in across)])
    joint = segments.contact[edges.segment[left]]
    return Joints(joint, edges.cell[left], edges.cell[right], x[edges.vertex[left]], shift[joint])
