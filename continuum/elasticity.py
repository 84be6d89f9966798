"""The bar's stiffness and mass on Gauss-Lobatto-Legendre elements.

With the nodes at the quadrature points the mass is diagonal at every order, and as accurate as
the order asks for (Komatitsch & Tromp, Geophys. J. Int. 139, 1999).
"""

from typing import NamedTuple

import numpy as np
import ufl
from scipy.sparse import csr_matrix

from continuum import compat
from continuum.mesh import Grid, create


class Bar(NamedTuple):
    """A bar of unit modulus, density and section, its nodes numbered along y.

    grid : the elements.
    y : float array [nodes], m.
    elements : int array [elements, order + 1], node numbers along y; the two nodes at a cut have
        the same y and belong to one element each.
    stiffness : [nodes, nodes], 1/m.
    mass : float array [nodes], m, the diagonal of the mass matrix.
    """

    grid: Grid
    y: np.ndarray
    elements: np.ndarray
    stiffness: csr_matrix
    mass: np.ndarray

    @property
    def order(self) -> int:
        """Polynomial order of the elements."""
        return self.elements.shape[1] - 1


def discretise(grid: Grid, order: int) -> Bar:
    """Return the bar on a grid, with elements of this order (1 to 4)."""
    space = compat.lagrange_space(create(grid), order)
    y = space.tabulate_dof_coordinates()[:, 0]
    elements = _elements_along_y(space, y)
    # Numbers in the order of first appearance along y: neighbours in the pillar are in memory.
    flat = elements.ravel()
    along = flat[np.sort(np.unique(flat, return_index=True)[1])]
    number = np.empty_like(along)
    number[along] = np.arange(along.size)
    stiffness = compat.matrix(stiffness_form(space))[along][:, along]
    stiffness.sort_indices()
    mass = compat.vector(mass_form(space, order))[along]
    return Bar(grid, y[along], number[elements], stiffness, mass)


def stiffness_form(space) -> ufl.Form:
    """Return the integral of u' w' over the bar."""
    u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
    return ufl.inner(u.dx(0), w.dx(0)) * ufl.dx


def mass_form(space, order: int) -> ufl.Form:
    """Return the integral of w by GLL quadrature: each node's quadrature weight, its mass."""
    rule = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    return ufl.TestFunction(space) * ufl.dx(metadata=rule)


def _elements_along_y(space, y: np.ndarray) -> np.ndarray:
    nodes = compat.cell_nodes(space)
    elements = np.empty_like(nodes)
    elements[compat.input_cells(space.mesh)] = np.take_along_axis(nodes, np.argsort(y[nodes]), 1)
    return elements
