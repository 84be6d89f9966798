"""The mesh of a rock mass in the plane, from its partition into convex blocks.

Blocks share the nodes of the segments between them; nodes on joints are duplicated afterwards. If
every block has four corners and meets at most one other along each edge, cells are quadrilaterals,
else triangles.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.periodic import Across, of_all
from jointwave.continuum.mesh.blocks import BlockEdges, cells_along, has_four_corners, meshed_blocks
from jointwave.continuum.mesh.cells import FACETS
from jointwave.continuum.mesh.copies import moved_alike, parts_of_pieces
from jointwave.continuum.mesh.cut import pieces, split
from jointwave.continuum.mesh.description import Joints, Mesh, Side
from jointwave.continuum.mesh.segments import Segments, segments_of


class PlaneMesh(NamedTuple):
    """A mesh with the origin of its cells and joints.

    mesh : its joints are numbered by contact, first the partition's, then those across periodic
    sides, where rock that no joint cuts moves alike. block : int array [cells], of the partition.
    piece : int array [cells], of rock not cut by joints. vertex : int array [cells, corners],
    distinct on the two sides of a joint.
    """

    mesh: Mesh
    block: np.ndarray
    piece: np.ndarray
    vertex: np.ndarray


def plane_mesh(
    partition: Partition,
    across: list[Across],
    sizes: Mapping[str, float],
    cell: str | None = None,
) -> PlaneMesh:
    """Return the mesh of a partition; sizes : approximate size of quadrilaterals and triangles, m.

    cell : "quadrilateral" or "triangle"; None for the first if possible. Raises ValueError if
    blocks cannot be meshed with quadrilaterals.
    """
    segments, loops = segments_of(partition, across)
    four = has_four_corners(loops)
    if cell == "quadrilateral" and not four.all():
        x, y = partition.centroid[np.argmin(four)]
        raise ValueError(
            f"the block at ({x:.4g}, {y:.4g}) m does not have four edges with one neighbour each"
        )
    kind = cell or ("quadrilateral" if four.all() else "triangle")
    size = sizes[kind]
    counts = cells_along(segments, loops, size, kind == "quadrilateral")
    x, cells, block, edges = meshed_blocks(segments, loops, counts, size, kind)
    joint_set = np.append(
        of_all(partition.blocks, across, "joint_set"), NO_SET
    )  # the last: boundary's
    cuts = joint_set[segments.contact[edges.segment]] != NO_SET
    cut = np.zeros((len(cells), len(FACETS[kind])), dtype=bool)
    cut[edges.cell[cuts], edges.facet[cuts]] = True
    whole, doubled = split(kind, x, cells, cut)
    piece = pieces(doubled)
    tied = _tied(partition, across, segments, edges, whole, doubled, kind, cuts)
    held = piece if tied is None else pieces(moved_alike(doubled, tied))
    parts, number = parts_of_pieces(whole, doubled, held, partition.region[block] + 1, tied)
    edges = edges._replace(cell=number[edges.cell])
    sides = {
        name: Side(edges.cell[there], x[edges.vertex[there]])
        for k, name in enumerate(partition.sides)
        if (there := segments.side[edges.segment] == k).any()
    }
    joints = _joints(partition, across, segments, edges, x, cuts)
    order = np.argsort(number)
    mesh = Mesh(kind, parts, (), joints, sides)
    return PlaneMesh(mesh, block[order], piece[order], doubled[order])


def _joints(
    partition: Partition,
    across: list[Across],
    segments: Segments,
    edges: BlockEdges,
    x: np.ndarray,
    cuts: np.ndarray,
) -> Joints:
    """Return the facet pairs of joints, by contact and along it: those of its block i on the left,
    of its block j on the right."""
    left, right = _facing(partition, across, segments, edges, np.flatnonzero(cuts))
    none = np.zeros((len(partition.contacts), 2))
    shift = np.concatenate([none, *(np.tile(by, (len(c), 1)) for c, by, _ in across)])
    joint = segments.contact[edges.segment[left]]
    return Joints(joint, edges.cell[left], edges.cell[right], x[edges.vertex[left]], shift[joint])


def _tied(
    partition: Partition,
    across: list[Across],
    segments: Segments,
    edges: BlockEdges,
    x: np.ndarray,
    cells: np.ndarray,
    kind: str,
    cuts: np.ndarray,
) -> np.ndarray | None:
    """Return the vertices that move alike across periodic sides, as `Part.tied` has them; None
    without. x, cells : of the mesh with its joints cut."""
    found = np.full((len(across), len(x)), -1)
    last = len(partition.contacts)
    for row, one in zip(found, across, strict=True):
        first, last = last, last + len(one.contacts)
        contact = segments.contact[edges.segment]
        own = np.flatnonzero(~cuts & (first <= contact) & (contact < last))
        sides = []
        for some in _facing(partition, across, segments, edges, own):
            vertex = np.take_along_axis(cells[edges.cell[some]], FACETS[kind][edges.facet[some]], 1)
            along = np.argsort(x[vertex].sum(axis=2), axis=1)  # one coordinate varies
            sides.append(np.take_along_axis(vertex, along, 1))
        row[sides[0]] = sides[1]
    return found if (found >= 0).any() else None


def _facing(
    partition: Partition,
    across: list[Across],
    segments: Segments,
    edges: BlockEdges,
    own: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return those of some edges that are of their contact's block i, and of its block j, each by
    contact and along it."""
    contact = segments.contact[edges.segment[own]]
    blocks = of_all(partition.blocks, across, "blocks")
    is_left = (edges.block[own] == blocks[contact, 0]) & (
        segments.like[edges.segment[own]] == edges.segment[own]
    )
    order = np.lexsort((edges.number[own], contact))
    return own[order][is_left[order]], own[order][~is_left[order]]
