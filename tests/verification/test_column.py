"""Standing waves of the square column and of the strip, by the assembled operators.

Where both end faces are mirrors, the modes are exactly those of the infinite column of wave number
pi / L: no end effect is left.
"""

import numpy as np
import pytest
from scipy.sparse import diags
from scipy.sparse.linalg import eigsh

from compare.exact import beam, column
from continuum.build import discretise, operators
from continuum.ends import face_area, held_ends

DENSITY, MODULUS, SIDE = 2400.0, 9.6e9, 0.5


@pytest.fixture
def rock(pillar):
    """Return a function that gives a column of this length (m) and Poisson's ratio in space."""

    def discrete(length, poisson, dim, order=4, blocks=4, across=1):
        scene = pillar(
            pillar={"length": length, "side": SIDE, "block": length / blocks},
            rock={
                "density": DENSITY,
                "equivalent_modulus": MODULUS,
                "equivalent_poisson": poisson,
            },
            load={"shape": "step", "amplitude": 0.0},
            record={"stress": [], "velocity": [0.0], "interval": 1e-4},
            numerics__continuum__order=order,
            numerics__continuum__elements_per_block=1,
            numerics__continuum__elements_across=across,
        )
        return scene, discretise(scene, "equivalent", dim)

    return discrete


def modes(discrete, held, near, count=4):
    """Return the frequencies (rad/s) nearest to `near`, and their shapes [freedoms, modes]."""
    stiffness, _ = operators(discrete)
    free = stiffness.diagonal() > 0
    free[held] = False
    mass = discrete.body.mass
    scale = diags(1 / np.sqrt(mass[free]))
    matrix = (scale @ stiffness[free][:, free] @ scale).tocsc()
    square, shapes = eigsh(matrix, count, sigma=0.99 * near**2)
    found = np.zeros((mass.size, count))
    found[free] = scale @ shapes
    return np.sqrt(square), found


def faces(discrete, components):
    """Return the freedoms of both end faces in these directions."""
    body = discrete.body
    areas = [face_area(body, side) for side in (body.mesh.start, body.mesh.end)]
    return np.concatenate([np.flatnonzero(area[c]) for area in areas for c in components])


def closest(discrete, held, near, shape):
    """Return the frequency of the mode that is most like a shape [nodes, components]."""
    body, like = discrete.body, np.zeros(discrete.body.mass.size)
    for c, values in enumerate(shape.T):
        like[body.freedom(np.arange(len(body.x)), c)] = values
    omega, shapes = modes(discrete, held, near)
    overlap = np.abs(shapes.T @ (body.mass * like))
    overlap /= np.sqrt(like @ (body.mass * like))
    return omega[overlap.argmax()], overlap.max()


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("poisson", [0.25, 0.35])
def test_long_waves(rock, dim, poisson):
    bar = np.sqrt(MODULUS / DENSITY)
    found = []
    for ka in (0.2, 0.4):
        k = ka / SIDE
        _, discrete = rock(np.pi / k, poisson, dim)
        y = discrete.body.x[:, 1]
        shape = np.zeros((len(y), dim))
        shape[:, 1] = np.sin(k * y)
        omega, like = closest(discrete, faces(discrete, [1]), bar * k, shape)
        found.append((1 - omega / (k * bar)) / column.love_rayleigh(poisson, k, SIDE, dim))
        print(dim, poisson, ka, found[-1], like, discrete.body.degrees_of_freedom)
    print((4 * found[0] - found[1]) / 3)


def test_torsion(rock):
    shear = np.sqrt(MODULUS / 2.5 / DENSITY)
    speeds=[]
    for ka in (0.2, 0.4):
        k = ka / SIDE
        _, discrete = rock(np.pi / k, 0.25, 3)
        x, y, z = discrete.body.x.T
        shape = np.stack([z * np.sin(k * y), 0 * y, -x * np.sin(k * y)], axis=1)
        omega, like = closest(discrete, faces(discrete, [0, 2]), shear * k * .92, shape)
        speeds.append(omega/k)
        print(omega / k / shear, like)
    print((4 * speeds[0] - speeds[1]) / 3/shear, column.torsion_speed(1))


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("poisson", [0., 0.25])
def test_bending(rock, dim, poisson):
    length = 20 * SIDE
    scene, discrete = rock(length, poisson, dim)
    body = discrete.body
    start = np.concatenate([np.flatnonzero(a) for a in face_area(body, body.mesh.start)])
    exact = beam.timoshenko(MODULUS, poisson, DENSITY, SIDE, length)
    omega, shapes = modes(discrete, start, exact)
    print(dim, poisson, omega[:3], exact, omega.min()/exact-1, beam.euler_bernoulli(MODULUS, DENSITY, SIDE, length)/exact-1)
