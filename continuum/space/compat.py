"""Differences between dolfinx 0.5 and 0.11, detected by their attributes."""

import inspect
import os
from collections.abc import Callable
from functools import cache
from typing import Any

import basix
import numpy as np
import ufl
from scipy.sparse import csr_matrix

from jointwave.continuum.space.compiling import compiled
from jointwave.continuum.space.fenicsx import MPI, dolfinx

fem, mesh = dolfinx.fem, dolfinx.mesh
NEW = hasattr(basix, "ufl")  #: whether basix's elements are UFL elements
function_space = fem.functionspace if hasattr(fem, "functionspace") else fem.FunctionSpace
if not NEW:
    import basix.ufl_wrapper


def make_mesh(kind: str, x: np.ndarray, cells: np.ndarray) -> Any:
    """Return the dolfinx mesh of cells [n, corners] between vertices x [m, d], m.

    Cells without a common vertex number are not connected, even if vertices coincide.
    """
    dim = x.shape[1]
    if NEW:
        element = basix.ufl.element("Lagrange", kind, 1, shape=(dim,))
    else:  # for other variants ffcx rewrites the element and compiles forms again in later runs
        cell = ufl.Cell(kind, geometric_dimension=dim)
        element = ufl.VectorElement("Lagrange", cell, 1, variant="equispaced")
    name = "e" if "e" in inspect.signature(mesh.create_mesh).parameters else "domain"
    given = {"cells": cells, "x": x, name: ufl.Mesh(element)}
    return compiled(lambda: mesh.create_mesh(MPI.COMM_SELF, **given))


def input_cells(domain: Any) -> np.ndarray:
    """Return the row of each cell of a mesh in the array of cells from which it was made."""
    return np.asarray(domain.topology.original_cell_index)


def lagrange(domain: Any, order: int, components: int) -> Any:
    """Return the vector space of Lagrange elements of this order.

    On intervals, quadrilaterals and hexahedra its nodes are Gauss-Lobatto-Legendre points.
    """
    return _space(domain, "Lagrange", order, components)


def vector_space(domain: Any, element: Any, components: int) -> Any:
    """Return the vector space with a scalar basix element for each component."""
    if NEW:
        whole = basix.ufl.blocked_element(basix.ufl.wrap_element(element), shape=(components,))
    else:
        scalar = basix.ufl_wrapper.BasixElement(element)
        whole = basix.ufl_wrapper.VectorElement(scalar, components)
    return compiled(lambda: function_space(domain, whole))


def custom_element(kind: str, span: np.ndarray, points: list, complete: int, degree: int) -> Any:
    """Return the basix element whose degrees of freedom are values at points.

    span : functions in orthonormal polynomials up to `degree` [n, m]. points : of each entity of
    each dimension [k, d]. complete : highest degree of which all polynomials are in the span.
    """
    cell, dim = getattr(basix.CellType, kind), points[0][0].shape[1]
    x = [*points, *[[]] * (3 - dim)]
    values = [[np.eye(len(one))[:, None, :, None] for one in entities] for entities in x]
    span = np.ascontiguousarray(span)
    given: tuple[Any, ...] = cell, [], span, x, values, 0, basix.MapType.identity
    if not NEW:
        return basix.create_custom_element(*given, False, complete, degree)
    continuous = basix.SobolevSpace.H1, False, complete, degree, basix.PolysetType.standard
    return basix.create_custom_element(*given, *continuous)


def cell_constants(domain: Any, values: np.ndarray) -> Any:
    """Return the vector function with values [cells, n] in the cells of a mesh."""
    found = fem.Function(_space(domain, "DG", 0, values.shape[1]), dtype=np.float64)
    found.x.array[:] = values.ravel()
    return found


def of_cells(domain: Any) -> Any:
    """Return the space of scalars constant in each cell."""
    return compiled(lambda: function_space(domain, ("DG", 0)))


def constant(domain: Any, shape: tuple[int, ...], value: float = 0.0) -> Any:
    """Return a UFL constant on a mesh, with a mutable `value`."""
    return fem.Constant(domain, np.full(shape, value))


def cell_sums(domain: Any, form: ufl.Form) -> Callable[[], np.ndarray]:
    """Return a function that integrates a form without arguments over each cell [cells], with the
    values of its constants at the call."""
    one = ufl.TestFunction(_space(domain, "DG", 0, 1))[0]
    each = [part.reconstruct(integrand=part.integrand() * one) for part in form.integrals()]
    made = compiled(lambda: fem.form(ufl.Form(each), dtype=np.float64))
    return lambda: np.array(fem.assemble_vector(made).array)


def _space(domain: Any, family: str, order: int, size: int) -> Any:
    if hasattr(fem, "functionspace"):
        return compiled(lambda: fem.functionspace(domain, (family, order, (size,))))
    return compiled(lambda: fem.VectorFunctionSpace(domain, (family, order), dim=size))


def neighbours(domain: Any) -> np.ndarray:
    """Return the pairs of cells of a mesh that share a facet [2, n]."""
    topology, dim = domain.topology, domain.topology.dim
    topology.create_entities(dim - 1)
    topology.create_connectivity(dim - 1, dim)
    links = topology.connectivity(dim - 1, dim)
    first = links.offsets[:-1][np.diff(links.offsets) == 2]
    return np.stack([links.array[first], links.array[first + 1]])


def parts_of_graph(start: np.ndarray, column: np.ndarray, parts: int) -> np.ndarray:
    """Partition a graph into parts of about equal size with few edges between them; return the
    part of each vertex. start, column : edges in both directions, CSR."""
    graph, none = dolfinx.graph, np.zeros(0, np.int32)
    os.environ.setdefault("SCOTCH_PTHREAD_NUMBER", "1")  # threads give random partitions
    made = graph.adjacencylist if hasattr(graph, "adjacencylist") else graph.create_adjacencylist
    edges, divide = made(column.astype(np.int64), start.astype(np.int32)), graph.partitioner()
    given = MPI.COMM_SELF, parts, getattr(edges, "_cpp_object", edges)
    try:
        return np.array(divide(*given, False).array)
    except TypeError:  # newer versions also take weights of vertices and edges
        return np.array(divide(*given, none, none, False).array)


def cell_nodes(space: Any) -> np.ndarray:
    """Return the nodes of each cell of the mesh [cells, nodes per cell]."""
    nodes = space.dofmap.list
    table = np.asarray(getattr(nodes, "array", nodes))
    return table.reshape(len(input_cells(space.mesh)), -1)


def matrix(form: ufl.Form) -> csr_matrix:
    """Assemble a bilinear form."""
    made = compiled(lambda: fem.form(form, dtype=np.float64))
    found = dolfinx.fem.petsc.assemble_matrix(made)
    found.assemble()
    start, column, value = (np.array(one) for one in found.getValuesCSR())
    found.destroy()
    size = len(start) - 1
    return csr_matrix((np.real(value), column, start), shape=(size, size))


def quadrature(kind: str, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points [n, d] and weights [n] on the reference cell, exact to this degree."""
    cell, types = getattr(basix.CellType, kind), basix.QuadratureType
    rule = types.default if hasattr(types, "default") else types.Default
    try:
        return basix.make_quadrature(cell, degree, rule=rule)
    except TypeError:  # older versions take the rule first, without keywords
        return basix.make_quadrature(rule, cell, degree)


@cache
def reference(kind: str, order: int) -> Any:
    """Return the basix Lagrange element of a cell; its `points` are the nodes."""
    family, variant = basix.ElementFamily.P, basix.LagrangeVariant.gll_warped
    return basix.create_element(family, getattr(basix.CellType, kind), order, variant)


def cell_corners(domain: Any) -> np.ndarray:
    """Return the corners of each cell of a mesh of straight cells [cells, corners, d], m."""
    geometry = domain.geometry
    table = geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap
    table = np.asarray(getattr(table, "array", table)).reshape(len(input_cells(domain)), -1)
    return geometry.x[table][..., : geometry.dim]
