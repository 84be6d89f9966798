"""Standing waves of the square column and of the strip, by the assembled operators.

Where both end faces are mirrors, the modes are exactly those of the infinite column of wave number
pi / L: no end effect is left."""

import numpy as np
import pytest
from scipy.sparse import diags
from scipy.sparse.linalg import eigsh

from closed_forms import beam, column
from jointwave.continuum.scene import body_of

DENSITY, MODULUS, SIDE = 2400.0, 9.6e9, 0.5


@pytest.fixture
def rock(pillar):
    """Return a function that gives a column of this length (m) and Poisson's ratio in space, with
    so many quartic elements along it and in each direction of the section."""

    def body(length, poisson, dim, along=4, across=1):
        scene = pillar(
            pillar={"length": length, "side": SIDE, "block": length / along},
            rock={"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": poisson},
            load={"shape": "step", "amplitude": 0.0},
            record={"stress": [], "velocity": [0.0], "interval": 1e-4},
            numerics__continuum__order=4,
            numerics__continuum__elements_per_block=1,
            numerics__continuum__elements_across=across,
        )
        return body_of(scene, "equivalent", dim=dim).body

    return body


def modes(body, held, near, count=4):
    """Return the frequencies (rad/s) nearest to `near`, and their shapes [freedoms, modes]."""
    free = np.ones(body.mass.size, bool)
    free[held] = False
    scale = diags(1 / np.sqrt(body.mass[free]))
    matrix = (scale @ body.stiffness[free][:, free] @ scale).tocsc()
    square, shapes = eigsh(matrix, count, sigma=0.99 * near**2)
    found = np.zeros((body.mass.size, count))
    found[free] = scale @ shapes
    return np.sqrt(square), found


def held(body, ends, components):
    """Return the freedoms of end faces in these directions."""
    nodes = np.unique(np.concatenate([body.sides[end].node for end in ends]))
    return (body.components * nodes[:, None] + np.array(components)).ravel()


def frequency(body, mirrored, near, shape):
    """Return the frequency (rad/s) of the mode that is like a shape [nodes, components], which
    holds all but 1 % of the shape's energy; mirrored : directions in which both ends are held."""
    like = shape.ravel()
    omega, shapes = modes(body, held(body, ("start", "end"), mirrored), near)
    overlap = (shapes.T @ (body.mass * like)) ** 2 / (like @ (body.mass * like))
    assert overlap.max() > 0.99
    return omega[overlap.argmax()]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("poisson", [0.25, 0.35])
def test_long_waves_are_slowed_as_love_and_rayleigh_say(rock, dim, poisson):
    """c falls short of sqrt(E/rho) by nu^2 k^2 r_p^2 / 2, within 1 % of that at k a = 0.2, and
    within 0.1 % once its term in k^4 is extrapolated away. What is left is the term in k^6, some
    1e-4; elements of the fourth order, four to half a wave, err by 1e-10 of c."""
    bar, found = np.sqrt(MODULUS / DENSITY), []
    for ka in (0.2, 0.4):
        k = ka / SIDE
        body = rock(np.pi / k, poisson, dim)
        y = body.x[:, 1]
        shape = np.zeros((y.size, dim))
        shape[:, 1] = np.sin(k * y)
        omega = frequency(body, [1], k * bar, shape)
        found.append((1 - omega / (k * bar)) / column.love_rayleigh(poisson, k, SIDE, dim))
    assert found[0] == pytest.approx(1, abs=1e-2)
    assert (4 * found[0] - found[1]) / 3 == pytest.approx(1, abs=1e-3)


def test_torsion_runs_at_saint_venants_speed(rock):
    """sqrt(G J / (rho I_p)), 0.9184 of the shear speed, within 0.02 %: four quartic elements
    resolve the warping to 3e-5 of the speed, and terms in k^2 are 2e-6 of it at k a = 0.2."""
    shear, k = np.sqrt(MODULUS / 2.5 / DENSITY), 0.2 / SIDE
    body = rock(np.pi / k, 0.25, 3, across=2)
    x, y, z = body.x.T
    shape = np.stack([z, 0 * y, -x], axis=1) * np.sin(k * y)[:, None]
    speed = column.torsion_speed(shear)
    omega = frequency(body, [0, 2], k * speed, shape)
    assert speed == pytest.approx(0.9184 * shear, rel=1e-4)
    assert omega / k == pytest.approx(speed, rel=2e-4)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("poisson, bound", [(0.0, 2e-5), (0.25, 2.5e-3)])
def test_a_cantilever_swings_at_timoshenkos_frequency(rock, dim, poisson, bound):
    """The lowest of a beam of 20 sides, 0.2 % below Euler's and Bernoulli's. Where Poisson's ratio
    is zero that beam is the whole truth but for terms in (a/L)^4, 6e-6. Else the clamp also keeps
    the section from widening, which shortens the column by some fiftieth of its side: omega, as the
    square of the length, rises by a/25L, and elements longer than the side would do more."""
    length = 20 * SIDE
    body = rock(length, poisson, dim, along=16)
    exact = beam.timoshenko(MODULUS, poisson, DENSITY, SIDE, length)
    omega = modes(body, held(body, ["start"], range(dim)), exact)[0].min()
    assert omega == pytest.approx(exact, rel=bound)
    slender = beam.euler_bernoulli(MODULUS, DENSITY, SIDE, length)
    assert 0.995 < exact / slender < 0.999
