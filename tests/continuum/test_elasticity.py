"""Mass and stiffness of rock against what each must reproduce exactly."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import ufl
from scipy.linalg import eigh
from scipy.spatial import cKDTree

from jointwave import cases
from jointwave.continuum.mesh.description import Part
from jointwave.continuum.space import dolfinx_export
from jointwave.continuum.space.body import whole
from jointwave.continuum.space.elasticity import Material, Section, discretise, lame_constants

ROCK = Material(modulus=8.64e10, poisson=0.25, density=2400.0)
UNIT = Material(modulus=1.0, poisson=0.0, density=1.0)
ORDERS = [1, 2, 3, 4]
HEXAHEDRA = [(dim, "hexahedron", order) for dim in (1, 2, 3) for order in ORDERS]
SIMPLICES = [(dim, "simplex", order) for dim in (2, 3) for order in (1, 2)]
cells = pytest.mark.parametrize(("dim", "cell", "order"), HEXAHEDRA + SIMPLICES)

#: m/m; du/dx of a motion that strains, shears and turns.
GRADIENT = np.array([[0.3, -0.5, 0.2], [0.4, 0.7, -0.6], [-0.1, 0.9, 0.5]])


def bar(elements: int = 6, length: float = 3.0) -> Part:
    """Return a bar between 0 and its length."""
    cells = np.arange(elements)[:, None] + np.arange(2)
    x = length / elements * np.arange(elements + 1.0)[:, None]
    return Part(x, cells, np.zeros(elements, dtype=int), np.zeros((1, 1)))


def of_bar(order: int, elements: int = 6):
    """Return the piece of a bar of unit modulus, density and area."""
    return discretise(bar(elements), "interval", order, [UNIT], Section(1, 1.0))


def assembled(body):
    """Return the stiffness of a whole body, N/m."""
    return whole(body.layout, body.mesh, body.blocks)


def moved_by(body, gradient: np.ndarray) -> np.ndarray:
    """Return the freedoms of the displacement u = gradient x."""
    u, gradient = np.zeros(body.mass.size), np.atleast_2d(gradient)
    for c in range(body.section.components):
        u[body.freedom(np.arange(len(body.x)), c)] = body.x @ gradient[c]
    return u


@pytest.mark.parametrize(("dim", "cell", "order"), SIMPLICES)
def test_lumped_mass_of_simplices_has_the_proportions_of_the_consistent_diagonal(
    dim, cell, order, body
):
    """Hinton, Rock & Zienkiewicz (1976): cell by cell, the diagonal scaled to the cell's mass."""
    part = body(dim, cell, order).mesh.parts[0]
    kind = {2: "triangle", 3: "tetrahedron"}[dim]
    section = Section(dim, 1.0)
    piece = discretise(part, kind, order, [ROCK], section, consistent=True)
    whole_mass = piece.consistent.toarray()[::dim, ::dim]
    assert whole_mass.sum() == pytest.approx(piece.mass.sum(), rel=1e-13)
    assert np.linalg.eigvalsh(whole_mass).min() > 0
    assert np.ptp(piece.mass / whole_mass.diagonal()) < 1e-12


def moduli_of(domain, part, rock, dim):
    """Return lambda and G (Pa) as functions that are constant in each cell; in dim 1 E and G."""
    constants = [(m.modulus, m.shear_modulus) if dim == 1 else lame_constants(m, dim) for m in rock]
    space = getattr(dolfinx_export.fem, "functionspace", None) or dolfinx_export.fem.FunctionSpace
    found = []
    for values in np.array(constants).T:
        function = dolfinx_export.fem.Function(space(domain, ("DG", 0)), dtype=np.float64)
        where = dolfinx_export.cell_nodes(function.function_space)[:, 0]
        function.x.array[where] = values[part.material[dolfinx_export.input_cells(domain)]]
        found.append(function)
    return found


def by_dolfinx(part, kind, order, rock):
    """Return the stiffness, the mass, and the nodes that dolfinx has for them: UFL, as written.

    One form, which is dear to compile, is both: of no density and of no moduli.
    """
    dim, tensor = part.x.shape[1], kind in ("interval", "quadrilateral", "hexahedron")
    lobatto = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    at_nodes = ufl.dx(metadata=lobatto) if tensor else ufl.dx
    dx = (
        ufl.dx(metadata={"quadrature_degree": 2})
        if (kind, order) == ("hexahedron", 1)
        else at_nodes
    )
    domain = dolfinx_export.cell_mesh(kind, part.cells, part.x)
    one, two = moduli = moduli_of(domain, part, rock, dim)
    density = dolfinx_export.fem.Constant(domain, 0.0)
    space = dolfinx_export.lagrange_space(domain, order, dim if dim > 1 else None)
    u, w = ufl.TrialFunction(space), ufl.TestFunction(space)
    if dim == 1:
        stress = one * ufl.grad(u)
    else:
        strain = ufl.sym(ufl.grad(u))
        stress = one * ufl.tr(strain) * ufl.Identity(dim) + 2 * two * strain
    both = ufl.inner(stress, ufl.grad(w)) * dx + density * ufl.inner(u, w) * at_nodes
    stiffness = dolfinx_export.matrix(both).toarray()
    for modulus in moduli:
        modulus.x.array[:] = 0.0
    density.value = 1.0
    mass = dolfinx_export.matrix(both).toarray()
    for c in range(1, dim):
        assert (mass[c::dim, c::dim] == mass[::dim, ::dim]).all()
    return stiffness, mass[::dim, ::dim], space.tabulate_dof_coordinates()[:, :dim]


def distance(found, expected):
    """Return the largest difference of two arrays, of the largest entry."""
    return np.abs(found - expected).max() / np.abs(expected).max()


STRAIGHT = [(*kind, False) for kind in HEXAHEDRA + SIMPLICES if kind[0] == 1 or kind[2] <= 2]
BENT = [(*kind, True) for kind in HEXAHEDRA + SIMPLICES if kind[0] > 1]


@pytest.mark.parametrize(
    ("dim", "cell", "order", "bent"),
    [
        pytest.param(*kind, marks=pytest.mark.slow if kind[2] == 3 else ())
        for kind in STRAIGHT + BENT
    ],
)
def test_matrices_are_those_of_the_form_as_dolfinx_assembles_it(dim, cell, order, bent, body):
    """Cell by cell, through the map of straight cells, of which some are alike, and of bent ones,
    in two materials; by Lobatto's rule the mass matrix has no entries beside its diagonal, and is
    not lumped by hand. Slow in order 3, whose forms take long to compile, between 2 and 4."""
    at = body(dim, cell, order, along=2, bent=bent_everywhere if bent else None)
    part = at.mesh.parts[0]
    part = part._replace(material=np.arange(len(part.cells)) % 2)
    rock = [ROCK, Material(1e10, 0.1, 1.0)]
    rock = [m._replace(density=1.0) for m in rock]
    piece = discretise(part, at.mesh.cell, order, rock, Section(dim, 1.0), consistent=True)
    stiffness, mass, x = by_dolfinx(part, at.mesh.cell, order, rock)
    apart, node = cKDTree(piece.x).query(x)
    assert apart.max() < 1e-12 and np.unique(node).size == len(piece.x) == len(x)
    freedom = (dim * node[:, None] + np.arange(dim)).ravel()
    assert distance(piece.stiffness.toarray()[np.ix_(freedom, freedom)], stiffness) < 1e-14
    if cell == "hexahedron":
        assert distance(np.diag(piece.mass[node]), mass) < 1e-13
    else:
        assert distance(piece.consistent.toarray()[::dim, ::dim][np.ix_(node, node)], mass) < 1e-14


def test_neither_dolfinx_nor_a_form_compiler_is_needed():
    """Nor MPI, PETSc and gmsh, to step a pillar of quadrilaterals explicitly."""
    program = (
        "import sys, cases\n"
        "from jointwave.continuum.run import discrete_and_steps\n"
        "scene = cases.load_variant(sys.argv[1], '', {'variants': []})\n"
        "for dim in (1, 2, 3):\n"
        "    discrete_and_steps(scene, 'jointed', dim)\n"
        "heavy = {'dolfinx', 'ffcx', 'ufl', 'cffi', 'mpi4py', 'petsc4py', 'gmsh', 'meshio'}\n"
        "sys.exit(', '.join(heavy & sys.modules.keys()) or 0)\n"
    )
    scene = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
    command = [sys.executable, "-c", program, str(scene)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@cells
def test_stiffness_is_symmetric_and_knows_no_rigid_motion(dim, cell, order, body):
    """Turns about any axis included, small ones."""
    at = body(dim, cell, order)
    matrix = assembled(at)
    largest = np.abs(matrix).max()
    assert np.abs(matrix - matrix.T).max() < 1e-13 * largest
    for c in range(at.section.components):
        u = np.zeros(at.mass.size)
        u[at.freedom(np.arange(len(at.x)), c)] = 1.0
        assert np.abs(matrix @ u).max() < 1e-12 * largest
    if dim > 1:
        turn = (GRADIENT - GRADIENT.T)[:dim, :dim]
        assert np.abs(matrix @ moved_by(at, turn)).max() < 1e-12 * largest


def bent_across(x: np.ndarray) -> np.ndarray:
    """Move vertices inside the section, alike in all sections: faces of cells stay plane."""
    bump = np.cos(np.pi * x[..., :1] / 0.5)
    if x.shape[-1] == 2:
        return x + 0.02 * np.concatenate([bump * np.sin(7 * x[..., 1:]), 0 * bump], axis=-1)
    bump = bump * np.cos(np.pi * x[..., 2:] / 0.5)
    return x + 0.05 * bump * np.array([1.0, 0.0, -0.6])


def bent_everywhere(x: np.ndarray) -> np.ndarray:
    """Move vertices inside the pillar along y too: faces of hexahedra are warped."""
    inside = np.prod(np.cos(np.pi * np.delete(x, 1, axis=-1) / 0.5), axis=-1, keepdims=True)
    along = np.sin(2 * np.pi * x[..., 1:2]) * inside
    return bent_across(x) + 0.05 * along * np.eye(x.shape[-1])[1]


SHAPES = [
    (*kind, bent)
    for kind in HEXAHEDRA[4:] + SIMPLICES
    for bent in (None, bent_across, bent_everywhere)
    if (*kind, bent) != (3, "hexahedron", 1, bent_everywhere)
]


@pytest.mark.parametrize(("dim", "cell", "order", "bent"), SHAPES)
def test_patch_of_any_shape_carries_uniform_strain_exactly(dim, cell, order, bent, body):
    """No force on nodes inside (Irons' patch test), and sum of f x over all nodes = V sigma.

    Lobatto's rule integrates cof(J) grad w exactly, but for warped faces of trilinear hexahedra:
    it is of degree order + 1 in each coordinate there, the rule of degree 2 order - 1.
    """
    across = 4 if dim == 2 else 2  # the fewest with vertices inside that bend, in space
    at = body(dim, cell, order, blocks=2, along=3, across=across, bent=bent)
    gradient = GRADIENT[:dim, :dim]
    force = assembled(at) @ moved_by(at, gradient)
    half, nodes = 0.25, np.arange(len(at.x))
    inside = (np.abs(np.delete(at.x, 1, axis=1)) < half - 1e-9).all(axis=1)
    inside &= np.abs(at.x[:, 1] / 0.5 - np.round(at.x[:, 1] / 0.5)) > 1e-9
    every = np.stack([force[at.freedom(nodes, c)] for c in range(dim)], axis=1)
    stress = stress_of(gradient, dim)
    assert inside.any()
    assert np.abs(every[inside]).max() < 1e-12 * np.abs(stress).max()
    volume = 0.25 * 1.0
    assert np.abs(every.T @ at.x - volume * stress).max() < 1e-12 * np.abs(stress).max()


def stress_of(gradient: np.ndarray, dim: int) -> np.ndarray:
    """Return the stress of a displacement gradient, Pa; plane stress in dim 2."""
    strain, nu = (gradient + gradient.T) / 2, ROCK.poisson
    shear = ROCK.modulus / (2 * (1 + nu))
    lame = 2 * shear * nu / (1 - nu if dim == 2 else 1 - 2 * nu)
    return lame * np.trace(strain) * np.eye(dim) + 2 * shear * strain


@pytest.mark.parametrize("order", ORDERS)
def test_frequencies_converge_at_twice_the_order(order):
    """Lumped by GLL quadrature, omega converges at 2p (Cohen, Higher-Order Numerical Methods for
    Transient Wave Equations, 2002); the second free mode of a bar of length 3 is 2 pi / 3."""
    errors = []
    for elements in (4, 8):
        piece = of_bar(order, elements)
        values = eigh(piece.stiffness.toarray(), np.diag(piece.mass), eigvals_only=True)
        errors.append(abs(np.sqrt(values[2]) - 2 * np.pi / 3))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * order, abs=0.25)
