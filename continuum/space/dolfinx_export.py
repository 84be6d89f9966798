"""Meshes, spaces and forms of dolfinx itself, versions 0.5 to 0.11 told apart by what they offer.

No run needs them, nor the compiler that forms need: the benchmark of plain dolfinx and the tests
do. Meshes and forms live on one process each; matrices leave as real scipy CSR.
"""

import inspect
import logging
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import basix
import numpy as np
from scipy.sparse import csr_matrix


@contextmanager
def quiet_logging() -> Iterator[None]:
    """Restore the root logger changed by the form compiler, and hide its progress messages."""
    root, disabled = logging.getLogger(), logging.root.manager.disable
    handlers, level = list(root.handlers), root.level
    logging.disable(max(disabled, logging.INFO))
    try:
        yield
    finally:
        root.handlers[:] = handlers
        root.setLevel(level)
        logging.disable(disabled)


with suppress(ImportError):
    from jointwave.continuum.parallel import petsc as _  # noqa: F401  before dolfinx starts it in its own way
with quiet_logging():
    import ufl
    from dolfinx import fem, mesh
    from mpi4py import MPI


def cell_mesh(cell: str, cells: np.ndarray, x: np.ndarray):
    """Return the mesh of `cells` [n, corners] of this kind between vertices `x` [m, dim], m.

    Cells that share no vertex are topologically disconnected, wherever the vertices lie.
    """
    dim = x.shape[1]
    if hasattr(basix, "ufl"):
        element = basix.ufl.element("Lagrange", cell, 1, shape=(dim,))
    else:
        element = ufl.VectorElement("Lagrange", ufl.Cell(cell, geometric_dimension=dim), 1)
    name = "e" if "e" in inspect.signature(mesh.create_mesh).parameters else "domain"
    return mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=x, **{name: ufl.Mesh(element)})


def input_cells(domain) -> np.ndarray:
    """Return for each cell of a mesh its row in the array of cells it was made from."""
    return np.asarray(domain.topology.original_cell_index)


def lagrange_space(domain, order: int, components: int | None = None):
    """Return the Lagrange space of this order, of vectors where `components` is given.

    On intervals, quadrilaterals and hexahedra its nodes are Gauss-Lobatto-Legendre points.
    """
    if hasattr(fem, "functionspace"):
        shape = () if components is None else ((components,),)
        return fem.functionspace(domain, ("Lagrange", order, *shape))
    if components is None:
        return fem.FunctionSpace(domain, ("Lagrange", order))
    return fem.VectorFunctionSpace(domain, ("Lagrange", order), dim=components)


def cell_nodes(space) -> np.ndarray:
    """Return the node numbers of each cell of the mesh, int array [cells, nodes per cell]."""
    nodes = space.dofmap.list
    table = np.asarray(getattr(nodes, "array", nodes))
    return table.reshape(len(input_cells(space.mesh)), -1)


def matrix(form: ufl.Form) -> csr_matrix:
    """Assemble a bilinear form; of vectors with all components of a node side by side."""
    import dolfinx.fem.petsc

    assembled = dolfinx.fem.petsc.assemble_matrix(_compiled(form))
    assembled.assemble()
    start, column, value = assembled.getValuesCSR()
    size = len(start) - 1
    found = csr_matrix((np.real(value).copy(), column.copy(), start.copy()), shape=(size, size))
    assembled.destroy()
    return found


def vector(form: ufl.Form) -> np.ndarray:
    """Assemble a linear form."""
    return np.array(fem.assemble_vector(_compiled(form)).array)


def _compiled(form: ufl.Form):
    with quiet_logging():
        return fem.form(form, dtype=np.float64)
