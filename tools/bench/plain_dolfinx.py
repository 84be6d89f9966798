"""Jointed rock as a dolfinx tutorial would step it: compute the internal force, update by numpy.

All blocks are one mesh whose nodes are doubled at the joints, which are springs between the two
nodes. The force is assembled again in every step by a form compiled with -O2, or the product of one
scipy matrix.
"""

import inspect
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from scipy.sparse import csr_matrix

from jointwave.continuum.space import dolfinx_export
from jointwave.continuum.space.operator import without_round_off


class Pillar(NamedTuple):
    """What is stepped: cubes of side d (m) in a row along y, each n x n x n elements of order p.

    modulus, poisson, density : Pa, -, kg/m3. normal, shear : joint stiffness, Pa/m.
    dt : s; pressure : float array [steps], Pa, on the face y = 0; direction : of it, unit vector.
    """

    blocks: int
    d: float
    n: int
    p: int
    modulus: float
    poisson: float
    density: float
    normal: float
    shear: float
    dt: float
    pressure: np.ndarray
    direction: tuple[float, float, float]


class Steps:
    """Leapfrog with numpy, whatever computes the rock's internal force."""

    def __init__(self, pillar: Pillar, space, internal: Callable[[np.ndarray, np.ndarray], None]):
        """`internal(u, force)` sets the force (N) on every freedom at displacements u (m)."""
        self.pillar, self.internal, self.n = pillar, internal, 0
        self.x = space.tabulate_dof_coordinates()
        self.block = block_of_nodes(pillar, space)
        along = ufl.as_vector([1.0, 0.0, 0.0])
        work = pillar.density * ufl.inner(along, ufl.TestFunction(space)) * at_nodes(pillar)
        mass = dolfinx_export.vector(work)[::3]
        self.step_over_mass = pillar.dt / np.repeat(mass, 3)
        # Of an end node's mass, the share of the face: h / p (p + 1) is Lobatto's weight in y.
        depth = pillar.d / pillar.n / (pillar.p * (pillar.p + 1))
        area = mass / (pillar.density * depth)
        left, right = pairs(pillar, self.x, self.block)
        springs = np.array([pillar.shear, pillar.normal, pillar.shear])
        self.left, self.right = freedoms(left), freedoms(right)
        self.spring = (area[left][:, None] * springs).ravel()
        loaded = np.flatnonzero(np.isclose(self.x[:, 1], 0.0))
        self.loaded = freedoms(loaded)
        self.share = (area[loaded][:, None] * np.array(pillar.direction)).ravel()
        self.u, self.v, self.force = (np.zeros(3 * len(mass)) for _ in range(3))

    def march(self, steps: int) -> None:
        """Take some steps; the load has passed after the last of its values."""
        u, v, force, pressure = self.u, self.v, self.force, self.pillar.pressure
        for _ in range(steps):
            self.internal(u, force)
            traction = self.spring * (u[self.right] - u[self.left])
            force[self.left] += traction
            force[self.right] -= traction
            if self.n < pressure.size:
                force[self.loaded] += pressure[self.n] * self.share
            force *= self.step_over_mass
            v += force
            np.multiply(v, self.pillar.dt, out=force)
            u += force
            self.n += 1


def assembled(pillar: Pillar) -> Steps:
    """Return the steps that assemble the internal force."""
    space = vector_space(pillar)
    u = fem.Function(space, dtype=np.float64)
    form = compiled(-internal_work(pillar, space, u))

    def internal(_, force: np.ndarray) -> None:
        force[:] = 0.0
        fem.assemble_vector(force, form)

    steps = Steps(pillar, space, internal)
    steps.u = u.x.array  # what the form reads is what the steps move
    return steps


def multiplied(pillar: Pillar) -> Steps:
    """Return the steps that multiply the displacements by the stiffness of all blocks."""
    matrix = -without_zeros(pillar)

    def internal(u: np.ndarray, force: np.ndarray) -> None:
        force[:] = matrix @ u

    return Steps(pillar, vector_space(pillar), internal)


def stiffness(pillar: Pillar) -> csr_matrix:
    """Return the stiffness of all blocks as dolfinx assembles it, N/m."""
    space = vector_space(pillar)
    return dolfinx_export.matrix(internal_work(pillar, space, ufl.TrialFunction(space)))


def without_zeros(pillar: Pillar) -> csr_matrix:
    """Return the stiffness without the entries that quadrature makes zero, N/m."""
    return without_round_off(stiffness(pillar))


def compiled(form: ufl.Form):
    """Return a form compiled with -O2 and nothing else."""
    key = "jit_params" if "jit_params" in inspect.signature(fem.form).parameters else "jit_options"
    with dolfinx_export.quiet_logging():
        options = {"cffi_extra_compile_args": ["-O2"]}
        return fem.form(form, dtype=np.float64, **{key: options})


def vector_space(pillar: Pillar):
    """Return the space of displacements on all blocks, doubled at joints."""
    n, edge = pillar.n, np.arange(pillar.n + 1)
    corner = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    near = [slice(0, -1), slice(1, None)]
    cells = np.stack([corner[k, j, i].ravel() for k in near for j in near for i in near], axis=1)
    z, y, x = np.meshgrid(edge, edge, edge, indexing="ij")
    cube = pillar.d / n * np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    cube -= pillar.d / 2 * np.array([1.0, 0.0, 1.0])
    of_block = np.arange(pillar.blocks)[:, None, None]
    vertices = cube + of_block * np.array([0.0, pillar.d, 0.0])
    numbers = cells + of_block * len(cube)
    domain = dolfinx_export.cell_mesh(
        "hexahedron", numbers.reshape(-1, 8).astype(np.int64), vertices.reshape(-1, 3)
    )
    return dolfinx_export.lagrange_space(domain, pillar.p, 3)


def internal_work(pillar: Pillar, space, u) -> ufl.Form:
    """Return the virtual work of the stress of u, by the engine's own quadrature."""
    e, nu, w = pillar.modulus, pillar.poisson, ufl.TestFunction(space)
    lame, shear = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
    strain = ufl.sym(ufl.grad(u))
    stress = lame * ufl.tr(strain) * ufl.Identity(3) + 2 * shear * strain
    dx = ufl.dx(metadata={"quadrature_degree": 2}) if pillar.p == 1 else at_nodes(pillar)
    return ufl.inner(stress, ufl.grad(w)) * dx


def at_nodes(pillar: Pillar) -> ufl.Measure:
    """Return the measure with Gauss-Lobatto-Legendre points."""
    rule = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * pillar.p - 1, 1)}
    return ufl.dx(metadata=rule)


def block_of_nodes(pillar: Pillar, space) -> np.ndarray:
    """Return for each node the block that it belongs to."""
    block = np.empty(len(space.tabulate_dof_coordinates()), dtype=np.int64)
    cells = dolfinx_export.input_cells(space.mesh) // pillar.n**3
    block[dolfinx_export.cell_nodes(space)] = cells[:, None]
    return block


def pairs(pillar: Pillar, x: np.ndarray, block: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes left and right of the joints, at the same places in turn."""
    right = np.isclose(x[:, 1], block * pillar.d) & (block > 0)
    left = np.isclose(x[:, 1], (block + 1) * pillar.d) & (block < pillar.blocks - 1)
    return in_order(x, block, left), in_order(x, block, right)


def in_order(x: np.ndarray, block: np.ndarray, chosen: np.ndarray | None = None) -> np.ndarray:
    """Return the chosen nodes, or all, by block, y, z and x."""
    nodes = np.arange(len(x)) if chosen is None else np.flatnonzero(chosen)
    at = np.round(x[nodes], 9)
    return nodes[np.lexsort((at[:, 0], at[:, 2], at[:, 1], block[nodes]))]


def freedoms(nodes: np.ndarray) -> np.ndarray:
    """Return the three freedoms of each node."""
    return (3 * nodes[:, None] + np.arange(3)).ravel()
