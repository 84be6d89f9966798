"""The process of each node of a body, by the partitioner of dolfinx."""

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from jointwave.cases.errors import SceneError
from jointwave.continuum.space import compat
from jointwave.continuum.space.evaluation import nodes_of_cells
from jointwave.continuum.space.model import Body
from jointwave.continuum.stepping.leapfrog import products_for_steps
from jointwave.continuum.stepping.product import LANES, SHARED

SAME = 1e-9  # difference of a node's places on two processes, over the size of the domain


def ranks_of_nodes(body: Body, comm: Any) -> np.ndarray:
    """Return the process of each node [nodes], the lowest rank among its cells; the same on all
    processes of an mpi4py communicator.

    Raises SceneError if a process would have no node, or has another mesh.
    """
    found, x = None, comm.bcast(body.x)
    same = x.shape == body.x.shape and np.allclose(x, body.x, 0.0, SAME * np.ptp(x))
    if not all(comm.allgather(same)):
        raise SceneError("mpiexec", "-n", comm.size, "has meshed the scene in different ways")
    if comm.rank == 0:
        found = np.full(len(body.x), comm.size)
        nodes, rank = nodes_of_cells(body), ranks_of_cells(body, comm.size)
        np.minimum.at(found, nodes, rank[:, None])
    found = comm.bcast(found)
    if np.unique(found).size < comm.size:
        allowed = f"is too many for a mesh of so few cells: {len(body.block)}"
        raise SceneError("mpiexec", "-n", comm.size, allowed)
    return found


def ranks_of_cells(body: Body, size: int) -> np.ndarray:
    """Return the process (of `size`) of each cell [cells].

    Blocks that share one matrix stay whole if each process gets many of them.
    """
    unit = np.arange(len(body.block))
    if body.block.max() + 1 >= LANES * size and products_for_steps(body)[0].kind == SHARED:
        unit = body.block
    first, second = unit[adjacent_cells(body)]
    count, apart = unit.max() + 1, first != second
    edges = np.ones(apart.sum()), (first[apart], second[apart])
    graph = csr_matrix(coo_matrix(edges, (count, count)))
    graph = csr_matrix(graph + graph.T)
    return compat.parts_of_graph(graph.indptr, graph.indices, size)[unit]


def adjacent_cells(body: Body) -> np.ndarray:
    """Return pairs of cells [2, n]: those that share a facet, and a pair for each point of a joint
    and for each node at periodic sides."""
    nodes, cells = compat.cell_nodes(body.space), np.arange(len(body.block))[:, None]
    pairs, at = [compat.neighbours(body.mesh)], np.empty(nodes.max() + 1, np.int64)
    at[nodes] = cells
    if body.tied is not None:
        one = np.empty(len(body.x), np.int64)
        one[body.tied] = at
        pairs.append(np.stack([at, one[body.tied]]))
        at = one
    return np.concatenate([*pairs, at[body.joints.node.T]], axis=1)
