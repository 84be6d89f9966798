"""Identity of nodes of different processes, from the mesh alone."""

from typing import NamedTuple

import numpy as np

from jointwave.continuum.mesh.copies import moved_alike, tied_together
from jointwave.continuum.mesh.description import Mesh
from jointwave.continuum.parallel.partition import Copies, copies_of
from jointwave.continuum.parallel.serial import Pieces
from jointwave.continuum.space.nodes import corner_shares, levels, node_numbers, numbered


class Border(NamedTuple):
    """The cells whose nodes several processes may share.

    cell : int array [cells], in the whole mesh. node : int array [cells, nodes per cell], numbers
    valid on every process; those of tied nodes are equal.
    """

    cell: np.ndarray
    node: np.ndarray


def border(
    mesh: Mesh, rank_of: np.ndarray, order: int, plane_sections: bool = False, tied: bool = False
) -> Border:
    """Return the border between the processes of a whole mesh, equal on all of them.

    rank_of : int array [cells]. plane_sections : whether nodes of a copy at one height are tied.
    tied : whether nodes across periodic sides are.
    """
    copies, joints = copies_of(mesh), mesh.joints
    is_there = np.zeros(rank_of.size, dtype=bool)
    is_there[joints.right[rank_of[joints.left] != rank_of[joints.right]]] = True
    first, last = (f.reduceat(rank_of, copies.first) for f in (np.minimum, np.maximum))
    cut = (first != last)[copies.of(np.arange(rank_of.size))]
    if plane_sections:
        cell = np.flatnonzero(is_there | cut)
        return Border(cell, _levels(mesh, copies, cell, order))
    ties = _ties(mesh, copies) if tied else None
    vertices = moved_alike(_vertices(mesh, copies, np.flatnonzero(cut)), ties)
    is_there[np.flatnonzero(cut)[_meet_others(vertices, rank_of[cut])]] = True
    cell = np.flatnonzero(is_there)
    return Border(cell, node_numbers(mesh.cell, order, _vertices(mesh, copies, cell), ties))


def _meet_others(vertices: np.ndarray, rank: np.ndarray) -> np.ndarray:
    """Return which cells share a vertex with a cell of another process, bool array [cells]."""
    low = np.full(vertices.max(initial=-1) + 1, rank.max(initial=0))
    high = np.zeros_like(low)
    np.minimum.at(low, vertices, rank[:, None])
    np.maximum.at(high, vertices, rank[:, None])
    return (low != high)[vertices].any(axis=1)


def _vertices(mesh: Mesh, copies: Copies, cell: np.ndarray) -> np.ndarray:
    """Return the vertices of cells, numbered consecutively over all copies [cells, corners]."""
    sizes = np.array([len(part.x) for part in mesh.parts])[copies.part]
    copy, base = copies.of(cell), np.cumsum(sizes) - sizes
    found = np.empty((cell.size, mesh.parts[0].cells.shape[1]), dtype=np.int64)
    for number, part in enumerate(mesh.parts):
        here = copies.part[copy] == number
        found[here] = part.cells[(cell - copies.first[copy])[here]] + base[copy[here], None]
    return found


def _ties(mesh: Mesh, copies: Copies) -> np.ndarray | None:
    """Return what the vertices of all copies are tied to, numbered as `_vertices` does; None
    without ties."""
    sizes = np.array([len(part.x) for part in mesh.parts])[copies.part]
    return tied_together([mesh.parts[k].tied for k in copies.part], np.cumsum(sizes) - sizes)


def _levels(mesh: Mesh, copies: Copies, cell: np.ndarray, order: int) -> np.ndarray:
    """Return the numbers of the nodes of cells by their copy and height."""
    copy, shape = copies.of(cell), corner_shares(mesh.cell, order)
    y = np.empty((cell.size, shape.shape[0]))
    along = min(1, mesh.parts[0].x.shape[1] - 1)
    for number, part in enumerate(mesh.parts):
        here = copies.part[copy] == number
        corners = part.x[part.cells[(cell - copies.first[copy])[here]], along]
        y[here] = corners @ shape.T
    level = levels(y, max(np.ptp(part.x) for part in mesh.parts))
    return numbered(np.stack([np.broadcast_to(copy[:, None], y.shape), level], axis=2))


def joined(pieces: list[Pieces], border: Border) -> Pieces:
    """Return the pieces of all processes as one, cells in the order of the whole mesh."""
    sizes = [len(p.of_nodes[0]) for p in pieces]
    first = np.cumsum(sizes) - sizes
    order = np.argsort(np.concatenate([p.cell for p in pieces]))
    table = np.concatenate([p.table + n for p, n in zip(pieces, first, strict=True)])[order]
    same, label = np.arange(sum(sizes)), border.node
    lowest = np.full(label.max(initial=-1) + 1, same.size)
    np.minimum.at(lowest, label, table[border.cell])
    same[table[border.cell]] = lowest[label]
    kept, number = np.unique(same[table], return_inverse=True)
    of_cells = (np.concatenate(a)[order] for a in zip(*(p.of_cells for p in pieces), strict=True))
    of_nodes = (np.concatenate(a)[kept] for a in zip(*(p.of_nodes for p in pieces), strict=True))
    return Pieces(
        np.arange(len(table)), number.reshape(table.shape), tuple(of_cells), tuple(of_nodes)
    )
