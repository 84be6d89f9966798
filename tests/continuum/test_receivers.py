"""What points and sections read, against motions whose values are known."""

import numpy as np
import pytest

from jointwave.continuum.space.body import Body, axis, whole
from jointwave.continuum.space.elasticity import Material
from jointwave.continuum.space.receivers import points, sections

ROCK = Material(modulus=8.64e10, poisson=0.25, density=2400.0, time_constant=1e-5)
HEXAHEDRA = [(dim, "hexahedron", order) for dim in (1, 2, 3) for order in (1, 2, 3, 4)]
SIMPLICES = [(dim, "simplex", order) for dim in (2, 3) for order in (1, 2)]
cells = pytest.mark.parametrize(("dim", "cell", "order"), HEXAHEDRA + SIMPLICES)
deep = pytest.mark.parametrize(
    ("dim", "cell", "order"), [kind for kind in HEXAHEDRA + SIMPLICES if kind[0] > 1]
)

PLACES = [0.0, 0.11, 0.25, 0.5, 0.77, 1.0, 1.5]  # m; joints at 0.5 and 1.0
INSIDE = [0.0, 0.11, 0.25, 0.77, 1.23, 1.5]

#: m/m; du/dx of a motion that strains, shears and turns.
GRADIENT = np.array([[0.3, -0.5, 0.2], [0.4, 0.7, -0.6], [-0.1, 0.9, 0.5]])


def moved_by(body: Body, motion) -> np.ndarray:
    """Return the freedoms of a displacement; motion(x) gives [n, components], m."""
    u, found = np.zeros(body.mass.size), motion(body.x)
    for c in range(body.section.components):
        u[body.freedom(np.arange(len(body.x)), c)] = found[:, c]
    return u


@deep
def test_rotation_is_half_the_curl(dim, cell, order, body):
    """Of an affine motion, everywhere: (A - A^T) / 2 as a vector; in dim 2 about z alone."""
    at, a = body(dim, cell, order), GRADIENT[:dim, :dim]
    turn = points(at, PLACES).turn @ moved_by(at, lambda x: x @ a.T)
    curl = np.zeros(3)
    if dim == 3:
        curl[:2] = a[2, 1] - a[1, 2], a[0, 2] - a[2, 0]
    curl[2] = a[1, 0] - a[0, 1]
    assert np.abs(turn.reshape(3, -1).T - curl / 2).max() < 1e-12


def stress_of(gradient: np.ndarray, dim: int) -> np.ndarray:
    """Return the stress of a displacement gradient, Pa; plane stress in dim 2."""
    strain, nu = (gradient + gradient.T) / 2, ROCK.poisson
    shear = ROCK.modulus / (2 * (1 + nu))
    lame = 2 * shear * nu / (1 - nu if dim == 2 else 1 - 2 * nu)
    return lame * np.trace(strain) * np.eye(dim) + 2 * shear * strain


def uniform_force(dim: int) -> np.ndarray:
    """Return the force on what lies beyond a section of GRADIENT: along y, then x and z, N."""
    if dim == 1:
        return np.array([-ROCK.modulus * GRADIENT[0, 0] * 0.25])
    return -0.25 * stress_of(GRADIENT[:dim, :dim], dim)[[1, 0, 2][:dim], 1]


@cells
def test_sections_read_uniform_stress_exactly(dim, cell, order, body):
    """Compression and the shear along x and z, all as the force on what lies beyond; and the
    dashpots' of a rate."""
    at = body(dim, cell, order, along=2, rock=ROCK)
    u = moved_by(at, lambda x: x @ GRADIENT[:dim, :dim].T)
    read = sections(at, None, [ROCK], INSIDE)
    force = uniform_force(dim)
    found = (read.elastic @ u).reshape(dim, -1).T
    assert np.abs(found - force).max() < 1e-12 * np.abs(force).max()
    damped = (read.viscous @ u).reshape(dim, -1).T
    assert np.abs(damped - 1e-5 * force).max() < 1e-17 * np.abs(force).max()
    assert bool(read.inertia.nnz) == (cell == "hexahedron")


def bent(x: np.ndarray) -> np.ndarray:
    """Move vertices inside the pillar, those on joints stay."""
    inside = np.prod(np.cos(np.pi * np.delete(x, 1, axis=-1) / 0.5), axis=-1)
    ways = np.array([0.4, 0.8, -0.3])[: x.shape[-1]]
    return x + 0.05 * (np.sin(2 * np.pi * x[..., 1]) * inside)[..., None] * ways


@deep
def test_sections_of_bent_cells_read_uniform_stress_exactly(dim, cell, order, body):
    at = body(dim, cell, order, along=2, across=2, rock=ROCK, bent=bent)
    u, force = moved_by(at, lambda x: x @ GRADIENT[:dim, :dim].T), uniform_force(dim)
    read = sections(at, None, [ROCK], [0.11, 0.3, 0.77])
    found = (read.elastic @ u).reshape(dim, -1).T
    assert np.abs(found - force).max() < 1e-12 * np.abs(force).max()
    assert read.inertia.nnz == 0


@pytest.mark.parametrize(("dim", "cell", "order"), HEXAHEDRA)
def test_section_force_of_a_bar_pushed_at_one_end_falls_linearly(dim, cell, order, body):
    """A free bar under a constant end force F accelerates as a whole; force(y) = F (1 - y / L).

    Whatever Poisson's ratio bends the section to: the balance of momentum holds on every mesh.
    """
    rock, force = Material(1.0, 0.25, 1.0), 5.0
    at = body(dim, cell, order, blocks=2, along=2 if order < 4 else 1, rock=rock)
    nodes = np.arange(len(at.x) // 2)
    freedoms = np.concatenate([at.freedom(nodes, c) for c in range(dim)])
    upright = np.repeat(np.arange(dim) == axis(dim), nodes.size)
    face = upright & (np.tile(at.y[nodes], dim) < 1e-9)
    mass = at.mass[freedoms]
    push = force * mass * (face / mass[face].sum() - upright / mass[upright].sum())
    u, rate = np.zeros(at.mass.size), np.zeros(at.mass.size)
    stiffness = whole(at.layout, at.mesh, at.blocks)[freedoms][:, freedoms]
    u[freedoms] = np.linalg.lstsq(stiffness.toarray(), push, rcond=1e-12)[0]
    rate[freedoms] = upright * force / mass[upright].sum()
    places = np.array([0.0, 0.05, 0.2, 0.3, 0.41])
    read = sections(at, None, [rock], places.tolist())
    found = (read.elastic @ u + read.inertia @ rate).reshape(dim, -1)
    assert found[0] == pytest.approx(force * (1 - places / 0.5), abs=1e-11)
    assert np.abs(found[1:]).max(initial=0.0) < 1e-11
