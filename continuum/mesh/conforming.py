"""A conforming mesh of all blocks, and its cut along joints by doubling vertices."""

from typing import NamedTuple

import basix
import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.relations import joined

#: Kinds of cells by dimension: intervals, quadrilaterals and hexahedra, and simplices.
BOXES = {1: "interval", 2: "quadrilateral", 3: "hexahedron"}
SIMPLICES = {1: "interval", 2: "triangle", 3: "tetrahedron"}
SIMPLEX = ("triangle", "tetrahedron")


class Marks(NamedTuple):
    """Marks of the facets of a complex [facets]: column of the law of a resolved joint, or -1;
    index of a side in `names`, or -1."""

    column: np.ndarray
    side: np.ndarray
    names: tuple[str, ...]


def marks_of(
    blocks: Blocks, columns: np.ndarray, side: np.ndarray, names: tuple[str, ...]
) -> Marks:
    """Return the marks of the facets of blocks; columns : of each contact, -1 without a joint.
    side : index of the side of each boundary facet."""
    body, contacts = blocks.body, blocks.contacts
    sets, inner = int(body.joint_set.max(initial=0)) + 2, body.inner

    def number(pairs: np.ndarray, joint_set: np.ndarray) -> np.ndarray:
        """Return a unique number for two blocks and a joint set, in the order of contacts."""
        return (np.sort(pairs, axis=1) @ [blocks.count, 1]) * sets + joint_set + 1

    column = np.full(len(inner), -1)
    known = number(contacts.blocks, contacts.joint_set)
    own = number(body.sides[inner], body.joint_set[inner])
    column[inner] = columns[np.searchsorted(known, own)]
    return Marks(column, np.where(inner, -1, side), names)


class Conforming(NamedTuple):
    """A mesh of a cell complex in which neighbours share vertices.

    kind : of cells, by basix's name. x : vertices [v, d], m. cells : [c, corners], in basix's
    order. block : cell of the complex [c]. on : facet of the complex that contains each facet of
    each cell [c, facets of a cell], or -1 within a block.
    """

    kind: str
    x: np.ndarray
    cells: np.ndarray
    block: np.ndarray
    on: np.ndarray


class Places(NamedTuple):
    """Facets [n], or pairs of facets [n, 2]: numbers of cells, and local numbers of facets."""

    cell: np.ndarray
    facet: np.ndarray

    def of(self, chosen: np.ndarray) -> "Places":
        """Return the rows of a mask."""
        return Places(self.cell[chosen], self.facet[chosen])

    def side(self, k: int) -> "Places":
        """Return the first (0) or second (1) facet of each pair."""
        return Places(self.cell[:, k], self.facet[:, k])


def facets_of(kind: str) -> np.ndarray:
    """Return the corners of each facet of a cell [facets, corners of a facet]."""
    return np.array(basix.topology(getattr(basix.CellType, kind))[-2])


def on_facets(
    kind: str, cells: np.ndarray, vertices: np.ndarray, facet: np.ndarray, count: int
) -> np.ndarray:
    """Return `Conforming.on` of cells; vertices : of mesh facets [n, corners of a facet] on these
    facets of the complex [n]. count : number of vertices."""
    corners = np.sort(cells[:, facets_of(kind)], axis=2)
    own, known = (row_numbers(np.sort(one, axis=-1), count) for one in (corners, vertices))
    order = np.argsort(known)
    at = np.minimum(np.searchsorted(known[order], own), len(known) - 1)
    return np.where(known[order][at] == own, facet[order][at], -1)


def row_numbers(rows: np.ndarray, count: int) -> np.ndarray:
    """Return a number for each row [..., n] of vertices below `count`, unique up to equal rows."""
    flat = rows.reshape(-1, rows.shape[-1])
    found = flat[:, 0].astype(np.int64)
    for column in flat.T[1:3]:  # three vertices identify a facet in space
        found = found * count + column
    return found.reshape(rows.shape[:-1])


def shared(mesh: Conforming) -> Places:
    """Return the pairs of cell facets at each facet that two cells share."""
    vertices = np.sort(mesh.cells[:, facets_of(mesh.kind)], axis=2)  # [c, facets, n]
    number = row_numbers(vertices, len(mesh.x)).ravel()
    order = np.argsort(number, kind="stable")
    first = np.flatnonzero(np.diff(number[order]) == 0)
    return Places(*np.divmod(np.stack([order[first], order[first + 1]], axis=1), vertices.shape[1]))


def cut_open(mesh: Conforming, pairs: Places, cut: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return cells [c, corners] with vertices doubled along cuts, and each new vertex's original.

    pairs : all shared facets. cut : which of them to cut, bool [n]. A vertex at the tip of a cut is
    not doubled: facets that are not cut connect both sides around it.
    """
    corners = facets_of(mesh.kind)
    at = mesh.cells.shape[1] * pairs.cell[..., None] + corners[pairs.facet]  # corners of all cells
    order = np.argsort(mesh.cells.ravel()[at], axis=2)
    at = np.take_along_axis(at, order, 2)
    piece = joined(at[~cut].swapaxes(1, 2), mesh.cells.size)
    split = np.zeros(len(mesh.x), bool)
    split[mesh.cells.ravel()[at[cut]]] = True
    vertex = mesh.cells.ravel()
    key = np.where(split[vertex], len(mesh.x) + piece, vertex)
    _, first, number = np.unique(key, return_index=True, return_inverse=True)
    return number.reshape(mesh.cells.shape), vertex[first]
