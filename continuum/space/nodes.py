"""The nodes of elements, told apart by the vertices around them.

A node lies on a corner, an edge or a facet of its cell, or inside: the vertices of that, and where
between them the node is, are the same from every cell that has the node. No two coordinates need
to be compared, which could not tell the two sides of a joint apart.
"""

import numpy as np

from jointwave.continuum.mesh.description import Part
from jointwave.continuum.mesh.facets import row_numbers
from jointwave.continuum.space import basix_versions

SAME = 1e-9  # of the pillar's size: nodes that are at one height
STEPS = 1_000_000  # of a place between vertices: nodes are much farther apart than one of them


def corner_shares(cell: str, order: int) -> np.ndarray:
    """Return how much each corner of a cell counts in the place of each node [nodes, corners]."""
    return basix_versions.tabulate(cell, 1, basix_versions.reference_element(cell, order).points)[0]


def node_numbers(
    cell: str, order: int, cells: np.ndarray, tied: np.ndarray | None = None
) -> np.ndarray:
    """Return numbers of the nodes of cells [cells, corners], equal for the same nodes, int array
    [cells, nodes per cell]; tied : as in `Part`, for numbers that are equal where they move alike.
    """
    share = np.rint(STEPS * corner_shares(cell, order)).astype(np.int64)
    around = np.where(share == 0, -1, cells[:, None])
    for row in () if tied is None else tied:  # a side is straight: what it has between is on it
        on_side = ((around < 0) | (row[around] >= 0)).all(axis=2, keepdims=True)
        around = np.where(on_side & (around >= 0), row[around], around)
    turn = np.argsort(around, axis=2)
    keys = [np.take_along_axis(a, turn, axis=2) for a in (around, share + 0 * around)]
    return numbered(np.concatenate(keys, axis=2))


def numbered(keys: np.ndarray) -> np.ndarray:
    """Return a number for every key [cells, nodes, entries], the same for equal ones."""
    if not keys.size:
        return np.empty(keys.shape[:2], dtype=np.int64)
    return row_numbers(keys.reshape(-1, keys.shape[2])).reshape(keys.shape[:2])


def nodes_of(part: Part, cell: str, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes of a part [nodes, dim], m, and those of each of its cells [cells, nodes per
    cell] in the order of the reference element; numbered as the cells come to them."""
    number = node_numbers(cell, order, part.cells)
    _, first, node = np.unique(number, return_index=True, return_inverse=True)
    x = corner_shares(cell, order) @ part.x[part.cells]
    rank = np.empty(first.size, dtype=np.int64)
    rank[np.argsort(first)] = np.arange(first.size)
    return x.reshape(-1, x.shape[2])[np.sort(first)], rank[node].reshape(number.shape)


def levels(y: np.ndarray, size: float) -> np.ndarray:
    """Return numbers of the different heights y, in a body of this size, of the shape of y."""
    order = np.argsort(y, axis=None)
    found = np.empty(y.size, dtype=np.int64)
    found[order] = np.cumsum(np.diff(y.ravel()[order], prepend=-np.inf) > SAME * size) - 1
    return found.reshape(y.shape)
