"""Elements and quadrature of basix 0.5 to 0.11, told apart by what they offer.

basix is dolfinx's library of elements; what dolfinx compiles, `continuum.space.dolfinx_export` has.
"""

from functools import cache
from importlib import import_module
from importlib.util import find_spec

import basix
import numpy as np

VERSION: str = basix.__version__


def load_mpi() -> None:
    """Load the MPI of the wheel that pip has of dolfinx, where it is that one that is installed:
    without it neither its PETSc nor its dolfinx finds any."""
    if find_spec("dolfinx_solver") is not None:
        import_module("dolfinx_solver")


@cache
def reference_element(cell: str, order: int):
    """Return the Lagrange element of a cell in reference coordinates; `points` are its nodes.

    On intervals, quadrilaterals and hexahedra these are Gauss-Lobatto-Legendre points.
    """
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
