"""Partition of a body of any shape: repeated bisection of the graph of its cells and joints."""

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix
from scipy.sparse.csgraph import laplacian
from scipy.sparse.linalg import eigsh

from jointwave.continuum.mesh.cells import FACETS
from jointwave.continuum.mesh.description import Mesh
from jointwave.continuum.mesh.facets import shared_facets
from jointwave.continuum.parallel.partition import cell_numbers, cells_enough, copies_of

SMALL = 0.02  # of the cells of one process: smaller copies are not divided
FEW = 100  # vertices of a graph up to which all of its modes are computed
SHIFT = 1e-9  # of the largest eigenvalue: shift below zero in the search for the lowest ones


def ranks_by_graph(mesh: Mesh, size: int) -> np.ndarray:
    """Return the process (of `size`) of each cell, int array [cells].

    All get the same number of cells, except that small copies are not divided. Raises SceneError if
    there are more processes than cells.
    """
    copies = copies_of(mesh)
    total = cells_enough(copies, size)
    repeated = np.array([part.copies > 1 for part in mesh.parts])[copies.part]
    whole = repeated & (copies.cells <= SMALL * total / size)
    copy = copies.of(np.arange(total))
    unit = np.where(whole[copy], copy, len(whole) + np.arange(total))
    _, unit = np.unique(unit, return_inverse=True)
    count = unit.max() + 1
    pair = unit[_neighbours(mesh)]
    graph = coo_matrix((np.ones(pair.shape[1]), pair), (count, count)).tocsr()
    return halved(graph + graph.T, np.bincount(unit).astype(float), size)[unit]


def _neighbours(mesh: Mesh) -> np.ndarray:
    """Return the pairs of cells that share a facet or have a joint between them [2, pairs]."""
    joints, pairs = mesh.joints, []
    for part, numbers in zip(mesh.parts, cell_numbers(mesh), strict=True):
        cell = shared_facets(mesh.cell, part.cells) // len(FACETS[mesh.cell])
        pairs.append(numbers[:, cell].swapaxes(0, 1).reshape(2, -1))
    return np.concatenate([*pairs, np.stack([joints.left, joints.right])], axis=1)


def halved(graph: csr_matrix, weight: np.ndarray, size: int) -> np.ndarray:
    """Return the part (of `size`, of equal weight) of each vertex of a graph, int array.

    Recursive spectral bisection (Pothen, Simon & Liou, SIAM J. Matrix Anal. Appl. 11, 1990).
    """
    if size == 1:
        return np.zeros(len(weight), dtype=np.int64)
    order, first = np.argsort(_fiedler(graph), kind="stable"), size // 2
    end = np.cumsum(weight[order])
    cut = np.searchsorted(end - weight[order] / 2, end[-1] * first / size)
    cut = np.clip(cut, first, len(weight) - (size - first))
    found = np.empty(len(weight), dtype=np.int64)
    for some, parts, base in ((order[:cut], first, 0), (order[cut:], size - first, first)):
        found[some] = base + halved(graph[some][:, some], weight[some], parts)
    return found


def _fiedler(graph: csr_matrix) -> np.ndarray:
    """Return the mode of the second lowest eigenvalue of a graph's Laplacian."""
    matrix = csc_matrix(laplacian(graph))
    if matrix.shape[0] <= FEW:
        return np.linalg.eigh(matrix.toarray())[1][:, min(1, matrix.shape[0] - 1)]
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    below = -SHIFT * matrix.diagonal().max()
    return eigsh(matrix, 2, sigma=below, v0=start)[1][:, 1]
