"""What points and sections read, against motions whose values are known."""

import numpy as np
import pytest

from jointwave.continuum.space.body import Body, axis, whole
from jointwave.continuum.space.elasticity import Material
from jointwave.continuum.space.interface import jumps
from jointwave.continuum.space.receivers import _by_stress, points, sections

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


def axis_of(dim: int, places: list[float]) -> np.ndarray:
    """Return points on the axis [n, dim], m."""
    return np.array(places)[:, None] * np.eye(dim)[min(1, dim - 1)]


@cells
def test_points_read_polynomials_exactly_and_the_mean_on_a_joint(dim, cell, order, body):
    """Of the elements' own degree; each block is shifted by as many metres as it is far."""
    at = body(dim, cell, order)
    blocks = np.repeat(np.arange(3), len(at.x) // 3)[:, None]
    slope = GRADIENT[:dim, :dim]
    u = moved_by(at, lambda x: 1.0 + x @ slope + x**order @ slope.T + blocks)
    on_axis, side = axis_of(dim, PLACES), np.array([0, 0, 0, 0.5, 1, 1.5, 2])
    expected = 1.0 + on_axis @ slope + on_axis**order @ slope.T + side[:, None]
    read = (points(at, PLACES).motion @ u).reshape(dim, -1).T
    assert read == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_both_sides_of_a_joint_count_alike_however_many_cells_meet_there(body, rebuilt):
    """Three triangles meet the axis at the joint from one side, four from the other."""
    at = body(2, "simplex", 1, blocks=2)
    x = np.array([[-0.25, 0], [0, 0], [0.25, 0], [-0.25, 0.5], [0, 0.5], [0.25, 0.5]])
    few = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]])
    many = np.array([[0, 1, 3], [1, 4, 3], [1, 5, 4], [1, 2, 5]])
    part = at.mesh.parts[0]
    halves = [
        part._replace(
            x=x + np.array([0.0, y]),
            cells=cells,
            material=np.zeros(4, int),
            shifts=np.zeros((1, 2)),
        )
        for y, cells in ((0.0, few), (0.5, many))
    ]
    left, right = np.array([1, 3]), np.array([4, 7])
    corners = np.array([[[-0.25, 0.5], [0, 0.5]], [[0, 0.5], [0.25, 0.5]]])
    joints = at.mesh.joints._replace(
        left=left, right=right, corners=corners, joint=np.zeros(2, int)
    )
    at = rebuilt(at, at.mesh._replace(parts=tuple(halves), joints=joints))
    far = np.repeat([0.0, 1.0], 6)[:, None] * np.ones(2)
    assert points(at, [0.5]).motion @ moved_by(at, lambda x: far) == pytest.approx([0.5, 0.5])


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


@deep
def test_rotation_on_a_joint_is_the_mean_of_both_sides(dim, cell, order, body):
    at = body(dim, cell, order)
    block = np.repeat(np.arange(3), len(at.x) // 3)[:, None]
    spin = np.zeros((dim, dim))
    spin[0, 1], spin[1, 0] = -1.0, 1.0
    u = moved_by(at, lambda x: block * (x @ spin.T))
    turn = (points(at, PLACES).turn @ u).reshape(3, -1)
    assert turn[2] == pytest.approx([0, 0, 0, 0.5, 1, 1.5, 2], abs=1e-12)
    assert np.abs(turn[:2]).max() < 1e-12


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


@deep
def test_sections_by_stress_alone_read_it_too(dim, cell, order, body):
    """On hexahedra this is what remains where cells do not follow the section."""
    at = body(dim, cell, order, along=2, rock=ROCK)
    u, force = moved_by(at, lambda x: x @ GRADIENT[:dim, :dim].T), uniform_force(dim)
    for place in INSIDE:
        elastic, _, inertia = _by_stress(at, [ROCK], place)
        assert np.abs(elastic @ u - force).max() < 1e-12 * np.abs(force).max()
        assert inertia.nnz == 0


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


@cells
def test_section_on_a_joint_reads_the_traction_of_its_points(dim, cell, order, body):
    """Area times traction, whole joint; the section away from joints reads none."""
    at = body(dim, cell, order)
    read = sections(at, jumps(at), [ROCK], [0.25, 0.5, 1.0])
    every = read.contact @ np.ones(read.contact.shape[1])
    assert every == pytest.approx([0.0, 0.25, 0.25], rel=1e-13)
    which = jumps(at).joint
    assert (read.contact @ (which == 1)) == pytest.approx([0.0, 0.0, 0.25], rel=1e-13)
    rows = np.diff(read.elastic.indptr).reshape(at.section.components, -1)
    assert (rows[:, 1:] == 0).all() and (rows[:, 0] > 0).all()
