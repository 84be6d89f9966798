"""Stiffness and mass of one piece of rock, by dolfinx.

On intervals, quadrilaterals and hexahedra stiffness and mass are integrated at the
Gauss-Lobatto-Legendre nodes: the mass is diagonal at every order, and both as accurate as the
order asks for (Komatitsch & Tromp, Geophys. J. Int. 139, 1999). Trilinear hexahedra take Gauss'
points for the stiffness: by their corners a column of Poisson's ratio 0.42, one element a block,
misses the waveform of the converged one by 14 % instead of 0.1 %.
Simplices take full quadrature for the stiffness, and for a diagonal mass the diagonal of the
consistent one, scaled to the true mass (Hinton, Rock & Zienkiewicz, Earthq. Eng. Struct. Dyn. 4,
1976).
"""

from typing import NamedTuple

import numpy as np
import ufl
from scipy.sparse import csr_matrix, kron

from continuum.mesh.description import Part
from continuum.space import compat

AT_ONCE = 500  # cells whose nodes are put in order together
TENSOR = ("interval", "quadrilateral", "hexahedron")


class Material(NamedTuple):
    """Linear elastic rock: Young's modulus, Pa; Poisson's ratio; density, kg/m3; Kelvin-Voigt
    time constant, s."""

    modulus: float
    poisson: float
    density: float
    time_constant: float = 0.0

    @property
    def shear_modulus(self) -> float:
        """G, Pa."""
        return self.modulus / (2 * (1 + self.poisson))


class Section(NamedTuple):
    """What a mesh of this dimension leaves out: components of the motion, and the factor (m2, m
    or 1) that makes an integral over the mesh one over the rock."""

    components: int
    extent: float


class Piece(NamedTuple):
    """One piece of rock, discretised; freedom node * components + component.

    x : float array [nodes, dim], m. cells : int array [cells, nodes per cell] in the order of the
    reference element. stiffness, N/m, and viscosity, N s/m (None without dashpots) : [n, n].
    mass : float array [nodes], kg, the diagonal; consistent : [n, n], kg, None where lumped.
    """

    x: np.ndarray
    cells: np.ndarray
    stiffness: csr_matrix
    viscosity: csr_matrix | None
    mass: np.ndarray
    consistent: csr_matrix | None


def discretise(
    part: Part,
    cell: str,
    order: int,
    materials: list[Material],
    section: Section,
    consistent: bool = False,
) -> Piece:
    """Return the operators of one piece of rock with elements of this order.

    materials : of `part.material`. consistent : whether to keep the consistent mass of simplices.
    """
    domain = compat.cell_mesh(cell, part.cells, part.x)
    space = compat.lagrange_space(domain, order)
    of_cell = [materials[m] for m in part.material]
    etas = np.array([m.time_constant for m in of_cell])
    stiffness = _stiffness(domain, cell, order, of_cell, np.ones(len(of_cell)), section)
    viscosity = None
    if etas.any():
        same = (etas == etas[0]).all()
        viscosity = etas[0] * stiffness if same else None
        if viscosity is None:
            viscosity = _stiffness(domain, cell, order, of_cell, etas, section)
    density = np.array([m.density for m in of_cell])
    mass, whole = _mass(space, cell, order, density, section, consistent)
    x = space.tabulate_dof_coordinates()[:, : part.x.shape[1]].copy()
    nodes = _in_reference_order(space, part, cell, order, x)
    return Piece(x, nodes, stiffness, viscosity, mass, whole)


def strain(u):
    """Return the small strain tensor of a displacement."""
    return ufl.sym(ufl.grad(u))


def stress(u, lame, shear):
    """Return the stress tensor of Lame's constants lambda and G."""
    return lame * ufl.tr(strain(u)) * ufl.Identity(len(u)) + 2 * shear * strain(u)


def lame_constants(material: Material, dim: int) -> tuple[float, float]:
    """Return lambda and G (Pa), in dim 2 those of plane stress."""
    e, nu = material.modulus, material.poisson
    lame = e * nu / (1 - nu**2) if dim == 2 else e * nu / ((1 + nu) * (1 - 2 * nu))
    return lame, material.shear_modulus


def _stiffness(domain, cell, order, of_cell, factor, section: Section) -> csr_matrix:
    """Return the stiffness matrix, each cell's share times its factor."""
    dim, (degree, lobatto) = domain.geometry.dim, stiffness_rule(cell, order)
    dx = measure(cell, order) if lobatto else ufl.dx(metadata={"quadrature_degree": degree})
    if dim == 1:
        return _of_bar(domain, order, dx, of_cell, factor, section)
    space = compat.lagrange_space(domain, order, dim)
    u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
    constants = np.array([lame_constants(m, dim) for m in of_cell]).T * factor
    lame, shear = (compat.cell_values(domain, section.extent * c) for c in constants)
    return compat.matrix(ufl.inner(stress(u, lame, shear), strain(w)) * dx)


def _of_bar(domain, order, dx, of_cell, factor, section: Section) -> csr_matrix:
    """Return the stiffness of a bar: E along it, and G across it where it moves in space."""
    space = compat.lagrange_space(domain, order)
    u, w = ufl.TrialFunction(space), ufl.TestFunction(space)

    def stiffness(moduli: list[float]) -> csr_matrix:
        modulus = compat.cell_values(domain, section.extent * np.array(moduli) * factor)
        return compat.matrix(modulus * ufl.inner(ufl.grad(u), ufl.grad(w)) * dx)

    along = stiffness([m.modulus for m in of_cell])
    if section.components == 1:
        return along
    across = stiffness([m.shear_modulus for m in of_cell])
    x_z, y = np.diag([1.0, 0.0, 1.0]), np.diag([0.0, 1.0, 0.0])
    return csr_matrix(kron(across, x_z) + kron(along, y))


def measure(cell: str, order: int) -> ufl.Measure:
    """Return the measure of integrals over rock: Lobatto's points on tensor-product cells."""
    if cell not in TENSOR:
        return ufl.dx
    rule = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    return ufl.dx(metadata=rule)


def stiffness_rule(cell: str, order: int) -> tuple[int, bool]:
    """Return the degree that the stiffness is integrated to, and whether at Lobatto's points."""
    lobatto = cell in TENSOR and (cell, order) != ("hexahedron", 1)
    return (max(2 * order - 1, 1) if lobatto else 2 * order), lobatto


def _mass(space, cell, order, density, section: Section, consistent: bool):
    """Return the diagonal of the mass matrix, kg, and the consistent one where it is asked for."""
    rho = compat.cell_values(space.mesh, section.extent * density)
    w = ufl.TestFunction(space)
    if cell in TENSOR:
        return compat.vector(rho * w * measure(cell, order)), None
    whole = compat.matrix(rho * ufl.TrialFunction(space) * w * ufl.dx)
    # The scale is that of every cell: simplices of one order are affine images of each other.
    diagonal = whole.diagonal()
    lumped = diagonal * (whole.sum() / diagonal.sum()) if diagonal.any() else diagonal
    return lumped, kron(whole, np.eye(section.components)).tocsr() if consistent else None


def _in_reference_order(space, part: Part, cell: str, order: int, x: np.ndarray) -> np.ndarray:
    """Return each cell's node numbers in the order of the reference element, cells as in `part`."""
    nodes = np.empty_like(compat.cell_nodes(space))
    nodes[compat.input_cells(space.mesh)] = compat.cell_nodes(space)
    reference = compat.reference_element(cell, order).points
    shape, _ = compat.tabulate(cell, 1, reference)
    for some in np.array_split(np.arange(len(nodes)), 1 + len(nodes) // AT_ONCE):
        places = np.einsum("kv,cvd->ckd", shape, part.x[part.cells[some]])
        distance = np.linalg.norm(places[:, :, None] - x[nodes[some]][:, None], axis=3)
        nodes[some] = np.take_along_axis(nodes[some], distance.argmin(axis=2), 1)
    return nodes
