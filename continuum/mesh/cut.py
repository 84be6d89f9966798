"""Cutting a mesh along facets, and identifying its pieces."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from jointwave.continuum.mesh.cells import FACETS
from jointwave.continuum.mesh.facets import facet_vertices, shared_facets


def split(
    kind: str, x: np.ndarray, cells: np.ndarray, cut: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and cells that share no vertex across the cut facets.

    `cut` (bool array [cells, facets]) marks each facet from both of its cells. A vertex at the tip
    of a cut, around which uncut facets lead to the other side, is not split.
    """
    on_cut = np.zeros(len(x), dtype=bool)
    cell, facet = np.nonzero(cut)
    on_cut[facet_vertices(kind, cells, cell, facet)] = True
    count, piece = connected_components(_corners_held_together(kind, cells, cut), directed=False)
    vertex = cells.ravel()
    place = np.where(on_cut[vertex], piece, count + vertex)
    _, first, number = np.unique(place, return_index=True, return_inverse=True)
    return x[vertex[first]], number.reshape(cells.shape)


def pieces(cells: np.ndarray) -> np.ndarray:
    """Return the number of the connected piece of each cell, int array."""
    first = np.repeat(cells[:, 0], cells.shape[1])
    size = int(cells.max()) + 1
    graph = coo_matrix((np.ones(first.size, dtype=bool), (first, cells.ravel())), (size, size))
    found = connected_components(graph, directed=False)[1][cells[:, 0]]
    return np.unique(found, return_inverse=True)[1].reshape(-1)


def _corners_held_together(kind: str, cells: np.ndarray, cut: np.ndarray) -> coo_matrix:
    """Return the graph of all cells' corners, in which uncut facets link those of two cells."""
    table, corners = FACETS[kind], cells.shape[1]
    facet = shared_facets(kind, cells)
    cell, local = np.divmod(facet[:, ~cut.ravel()[facet].any(axis=0)], len(table))
    corner = cell[..., None] * corners + table[local]
    # The two cells list the facet's vertices in different orders.
    by_vertex = np.argsort(cells.ravel()[corner], axis=-1)
    one, other = np.take_along_axis(corner, by_vertex, axis=-1).reshape(2, -1)
    return coo_matrix((np.ones(one.size, dtype=bool), (one, other)), (cells.size, cells.size))
