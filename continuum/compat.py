"""The only file that knows dolfinx versions: 0.5 to 0.11, told apart by what they offer.

Everything is serial and real; matrices leave as scipy CSR, so that no PETSc build matters.
"""

import inspect
import logging
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from scipy.sparse import csr_matrix


@contextmanager
def quiet_logging() -> Iterator[None]:
    """Undo what the form compiler does to the root logger, and hide its progress reports."""
    root, disabled = logging.getLogger(), logging.root.manager.disable
    handlers, level = list(root.handlers), root.level
    logging.disable(max(disabled, logging.INFO))
    try:
        yield
    finally:
        root.handlers[:] = handlers
        root.setLevel(level)
        logging.disable(disabled)


def _start_petsc() -> None:
    """Keep PETSc from turning a closed pipe or an interrupt into a crash report of its own."""
    try:
        import petsc4py
    except ImportError:
        return
    petsc4py.init(["jointwave", "-no_signal_handler"])


_start_petsc()
with quiet_logging():
    import basix
    import dolfinx
    import ufl
    from dolfinx import fem, mesh
    from mpi4py import MPI

VERSION: str = dolfinx.__version__


def process_count() -> int:
    """Return the number of MPI processes."""
    return MPI.COMM_WORLD.size


def interval_mesh(cells: np.ndarray, x: np.ndarray):
    """Return the mesh of intervals between vertices `cells` [n, 2] at coordinates `x` [m], m.

    Cells that share no vertex are topologically disconnected, wherever the vertices lie.
    """
    if hasattr(basix, "ufl"):
        element = basix.ufl.element("Lagrange", "interval", 1, shape=(1,))
    else:
        element = ufl.VectorElement("Lagrange", "interval", 1)
    name = "e" if "e" in inspect.signature(mesh.create_mesh).parameters else "domain"
    return mesh.create_mesh(
        MPI.COMM_WORLD, cells=cells, x=x.reshape(-1, 1), **{name: ufl.Mesh(element)}
    )


def input_cells(domain) -> np.ndarray:
    """Return for each cell of a mesh its row in the array of cells it was made from."""
    return np.asarray(domain.topology.original_cell_index)


def lagrange_space(domain, order: int):
    """Return the Lagrange space of this order; its nodes are Gauss-Lobatto-Legendre points."""
    make = getattr(fem, "functionspace", None) or fem.FunctionSpace
    return make(domain, ("Lagrange", order))


def cell_nodes(space) -> np.ndarray:
    """Return the node numbers of each cell, int array [cells, nodes per cell]."""
    nodes = space.dofmap.list
    table = np.asarray(getattr(nodes, "array", nodes))
    return table.reshape(len(input_cells(space.mesh)), -1)


def matrix(form: ufl.Form) -> csr_matrix:
    """Assemble a bilinear form."""
    assembled = fem.assemble_matrix(_compiled(form))
    finish = getattr(assembled, "scatter_reverse", None) or assembled.finalize
    finish()
    parts = (np.array(getattr(assembled, part)) for part in ("data", "indices", "indptr"))
    size = len(assembled.indptr) - 1
    return csr_matrix(tuple(parts), shape=(size, size))


def vector(form: ufl.Form) -> np.ndarray:
    """Assemble a linear form."""
    return np.array(fem.assemble_vector(_compiled(form)).array)


def _compiled(form: ufl.Form):
    with quiet_logging():
        return fem.form(form, dtype=np.float64)
