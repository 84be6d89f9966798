"""The only file that knows dolfinx versions: 0.5 to 0.11, told apart by what they offer.

Meshes and forms live on one process each; matrices leave as real scipy CSR.
"""

import inspect
import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

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
ABANDONED = 60.0  # s: no form takes a compiler so long


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
        return _once_compiled(lambda: fem.functionspace(domain, ("Lagrange", order, *shape)))
    if components is None:
        return _once_compiled(lambda: fem.FunctionSpace(domain, ("Lagrange", order)))
    vector = fem.VectorFunctionSpace
    return _once_compiled(lambda: vector(domain, ("Lagrange", order), dim=components))


def cell_values(domain, values: np.ndarray) -> fem.Function:
    """Return the function that is constant in each cell, from values in the order of input."""
    make = getattr(fem, "functionspace", None) or fem.FunctionSpace
    constant = _once_compiled(lambda: make(domain, ("DG", 0)))
    function = fem.Function(constant, dtype=np.float64)
    function.x.array[cell_nodes(function.function_space)[:, 0]] = values[input_cells(domain)]
    return function


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
        return _once_compiled(lambda: fem.form(form, dtype=np.float64))


def _once_compiled(make):
    """Return what is made of compiled code, once whoever compiles it has put it into the cache."""
    while True:
        try:
            return make()
        except TimeoutError:
            _forget_abandoned()


def _forget_abandoned() -> None:
    """Remove what compilers that were killed have left in the cache, or else all wait for it."""
    jit = dolfinx.jit
    options = getattr(jit, "get_options", None) or jit.get_parameters
    for source in Path(options()["cache_dir"]).glob("libffcx_*.c"):
        with suppress(FileNotFoundError):
            is_old = time.time() - source.stat().st_mtime > ABANDONED
            if is_old and not source.with_suffix(".c.cached").exists():
                source.unlink()


def reference_element(cell: str, order: int):
    """Return the Lagrange element of a cell in reference coordinates; `points` are its nodes."""
    family, variant = basix.ElementFamily.P, basix.LagrangeVariant.gll_warped
    return basix.create_element(family, getattr(basix.CellType, cell), order, variant)


def tabulate(cell: str, order: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return basis functions [points, nodes] and their gradients [points, nodes, dim] at
    `points` [n, dim] of the reference cell."""
    element, (count, dim) = reference_element(cell, order), points.shape
    if not count:  # an assertion of basix stops the process
        nodes = len(element.points)
        return np.zeros((0, nodes)), np.zeros((0, nodes, dim))
    table = element.tabulate(1, points)[..., 0]
    return table[0], np.moveaxis(table[1 : dim + 1], 0, 2)


def quadrature(cell: str, degree: int, lobatto: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return points [n, dim] and weights [n] on the reference cell, exact to this degree.

    lobatto : Gauss-Lobatto-Legendre points, which tensor-product cells have.
    """
    kind, types = getattr(basix.CellType, cell), basix.QuadratureType
    usual = types.default if hasattr(types, "default") else types.Default
    rule = types.gll if lobatto else usual
    try:
        return basix.make_quadrature(kind, degree, rule=rule)
    except TypeError:  # older: the rule comes first, and nothing has a name
        return basix.make_quadrature(rule, kind, degree)


def vtx_writer():
    """Return the class that writes VTX files; None where dolfinx is built without ADIOS2."""
    import dolfinx.io

    return getattr(dolfinx.io, "VTXWriter", None)
