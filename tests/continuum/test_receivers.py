"""What points and sections of pillars read, against motions whose values are known."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum.problem import problem_of
from jointwave.continuum.receivers.sections import points_on_axis, sections
from jointwave.continuum.scene import body_of
from tests.continuum.drawing import drawn

BOXES = [(1, "hexahedron", order) for order in (1, 3)]
BOXES += [(2, "hexahedron", order) for order in (1, 2, 4)]
BOXES += [(3, "hexahedron", order) for order in (1, 2)]
SIMPLICES = [(2, "simplex", 1), (2, "simplex", 2), (3, "simplex", 1)]

SIDE, PLACES = 0.4, [0.0, 0.11, 0.25, 0.5, 0.77, 1.23, 1.5]  # m

#: m/m; du/dx of a motion that strains, shears and turns.
GRADIENT = np.array([[0.3, -0.5, 0.2], [0.4, 0.7, -0.6], [-0.1, 0.9, 0.5]])


def affine(body) -> np.ndarray:
    """Return the displacement of GRADIENT, of all freedoms, m."""
    dim = body.components
    return (body.x @ GRADIENT[:dim, :dim].T).ravel()


def uniform_force(modulus: float, poisson: float, dim: int) -> np.ndarray:
    """Return the force on what lies beyond a section of GRADIENT, along y, then x and z, of the
    body of that dimension; plane stress in two."""
    a = GRADIENT[:dim, :dim]
    if dim == 1:
        return -modulus * a[0]
    strain, shear = (a + a.T) / 2, modulus / (2 * (1 + poisson))
    lame = 2 * shear * poisson / (1 - poisson if dim == 2 else 1 - 2 * poisson)
    stress = lame * np.trace(strain) * np.eye(dim) + 2 * shear * strain
    return -(SIDE ** (dim - 1)) * stress[[1, 0, 2][:dim], 1]


@pytest.mark.parametrize(("dim", "cell", "order"), BOXES + SIMPLICES)
def test_an_affine_motion_is_read_exactly(dim, cell, order, column):
    """By sections, compression and the shear along x and z as the force on what lies beyond, and
    that of the dashpots of a rate. By points, half the curl, (A - A^T) / 2 as a vector; in the
    plane about z alone."""
    keys = {"cell": cell, "order": order, "elements_per_block": 1, "elements_across": 1}
    keys = {f"numerics__continuum__{key}": value for key, value in keys.items()}
    scene, a = column(**keys, joints__damping_ratio=0.05), np.zeros((3, 3))
    found = body_of(scene, "equivalent", dim=dim)
    rock, u = calibrate(scene).each[0], affine(found.body)
    read = sections(found, PLACES[1:-1])
    force = uniform_force(rock.modulus, rock.poisson, dim)
    for matrix, expected in ((read.elastic, force), (read.viscous, rock.time_constant * force)):
        values = (matrix @ u).reshape(-1, dim)
        assert np.abs(values - expected).max() < 1e-11 * np.abs(expected).max()
    assert bool(read.inertia.nnz) == (cell == "hexahedron")
    a[:dim, :dim] = GRADIENT[:dim, :dim]
    turn = (points_on_axis(found.body, PLACES) @ u)[dim * len(PLACES) :].reshape(-1, 3)
    curl = np.array([a[2, 1] - a[1, 2], a[0, 2] - a[2, 0], a[1, 0] - a[0, 1]])
    assert dim == 1 or turn == pytest.approx(np.tile(curl / 2, (len(PLACES), 1)), abs=1e-12)


@pytest.mark.parametrize("kind", ["quadrilateral", "hexahedron"])
def test_sections_of_skewed_cells_read_uniform_stress_exactly(kind, column, tmp_path):
    """Between joints that are inclined, where no layer of cells has faces across the pillar."""
    dim = {"quadrilateral": 2, "hexahedron": 3}[kind]
    path = drawn(tmp_path / "skewed.msh", kind, [(0.4, 0.6), (1.1, 0.9)])
    scene = column(path, joints__damping_ratio=None)
    found, rock = body_of(scene, "jointed", dim=dim), scene.rock
    read = sections(found, [0.2, 0.5, 0.77])
    values = (read.elastic @ affine(found.body)).reshape(-1, dim)
    force = uniform_force(rock.intact_modulus, rock.intact_poisson, dim)
    assert np.abs(values - force).max() < 1e-11 * np.abs(force).max()
    assert read.inertia.nnz == 0


UPPER = [([3.0, 8.0, 2.0], 60.0, 180.0), ([8.0, 3.0, 2.0], 60.0, 270.0), (None, 90.0, -60.2551187)]


@pytest.mark.parametrize(("size", "dip", "towards"), UPPER)
def test_joints_in_space_are_read_above_them(size, dip, towards, rock_mass, tmp_path, monkeypatch):
    """Whatever the numbers of blocks, which are cells in a file, on either side of one joint."""
    joint = {"dip": dip, "dip_direction": towards % 360, "spacing": 1.0}
    domain, places = {"size": size}, [[0.5 * one for one in size or []]]
    if size is None:  # upright, 0.7 m in y on 0.4 m in x: its normal points to the north
        monkeypatch.chdir(tmp_path)
        drawn(tmp_path / "rock.msh", "tetrahedron", [(0.6, 1.3)], names=["joint set 0"], elements=3)
        del joint["spacing"]
        domain, places = {"mesh": "rock.msh"}, [[0.0, 0.95, 0.0]]
    stress = {"xx": 3e6, "yy": 1e6, "zz": 2e6, "xy": 4e5, "yz": -6e5, "xz": 8e5}
    scene = rock_mass(joint, dim=3, domain=domain, prestress=stress, record={"joints": places})
    steep, turned = np.radians([dip, towards])
    along, up = np.array([np.sin(turned), np.cos(turned), 0.0]), np.eye(3)[2]
    normal = np.sin(steep) * along + np.cos(steep) * up
    upwards = np.sin(steep) * up - np.cos(steep) * along
    traction = scene.prestress.tensor @ normal
    expected = [frame @ traction for frame in (normal, np.cross(upwards, normal), upwards)]
    carried = problem_of(scene, body_of(scene)).readings.carried
    np.testing.assert_allclose(carried, expected, rtol=0, atol=1e-1)
