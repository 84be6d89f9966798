"""What the verification shares: a bar under a Ricker pulse, and a body with a known motion."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from closed_forms.manufactured import Manufactured
from jointwave.continuum.mesh.cells import CORNERS, DIMENSION, oriented
from jointwave.continuum.mesh.description import Joints, Mesh, Part
from jointwave.continuum.mesh.facets import Facets, normals, outer_facets
from jointwave.continuum.space.body import Body, build_body
from jointwave.continuum.space.elasticity import Material, Section, lame_constants
from jointwave.continuum.space.evaluation import Places, places_in, quadrature_in
from jointwave.continuum.space.interface import facet_points

PERIOD = 0.01  # s, of the Ricker wavelet's peak frequency
DENSITY, MODULUS, SPEED = 2400.0, 9.6e9, 2000.0
BAR: dict[str, Any] = {
    "pillar": {"length": 60.0, "side": 0.5, "block": 1.0},
    "rock": {"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": 0.25},
    "load": {"shape": "ricker", "amplitude": 1e6, "period": PERIOD},
    "ends": {"start": "quiet", "end": "quiet"},
    "time": {"duration": 0.1},
    "record": {"stress": [10.0, 30.0], "velocity": [], "interval": 1e-4},
    "numerics__continuum__elements_per_block": 1,
}


@pytest.fixture
def bar(pillar):
    """Return a function that gives 60 m of rock of 2000 m/s between quiet ends, keys changed.

    Waves of the peak frequency are 20 blocks of 1 m long, one quadratic element each.
    """
    return lambda **changes: pillar(**{**BAR, **changes})


@pytest.fixture
def soft_joint():
    """Return a function that gives the soft layer at y (m) whose joint has kappa = K/(Z omega) at
    the peak frequency; the homogenised bar holds the compliance of an ordinary joint already."""

    def layer(y: float, kappa: float, impedance: float = DENSITY * SPEED) -> dict[str, float]:
        excess = 1 / (kappa * impedance * 2 * np.pi / PERIOD)
        return {"y": y, "normal_stiffness": 1 / (excess + 1.0 / MODULUS)}

    return layer


@pytest.fixture
def amplitude():
    """Return a function of equally spaced times (s) and a wave, silent at both ends, that gives the
    magnitude of its Fourier integral at the peak frequency."""

    def magnitude(times: np.ndarray, wave: np.ndarray) -> float:
        return float(abs(wave @ np.exp(-2j * np.pi / PERIOD * times)) * (times[1] - times[0]))

    return magnitude


class Problem(NamedTuple):
    """A body that the force g'' inertia + g elastic (N) on its freedoms moves as g(t) U(x).

    point, x, volume : quadrature points in all cells, their places (m) and volumes (m2 or m3).
    inertia, elastic : float arrays [freedoms], the work of the manufactured body force and traction
    on every basis function, by quadrature that leaves no error.
    """

    body: Body
    motion: Manufactured
    point: Places
    x: np.ndarray
    volume: np.ndarray
    inertia: np.ndarray
    elastic: np.ndarray

    def at_nodes(self) -> np.ndarray:
        """Return U at the nodes [freedoms], m."""
        body, found = self.body, np.zeros(self.body.mass.size)
        for c, u in enumerate(self.motion.displacement(body.x).T):
            found[body.freedom(np.arange(len(body.x)), c)] = u
        return found

    def error(self, u: np.ndarray, g: float) -> float:
        """Return the distance of u [freedoms] from g U over g U, in the L2 norm of the body."""
        nodes = self.body.cells[self.point.cell]
        exact = g * self.motion.displacement(self.x)
        square = 0.0
        for c in range(self.body.dim):
            there = (self.point.basis * u[self.body.freedom(nodes, c)]).sum(axis=1)
            square += self.volume @ (there - exact[:, c]) ** 2
        return float(np.sqrt(square / (self.volume @ (exact**2).sum(axis=1))))


@pytest.fixture(scope="module")
def problem():
    """Return a function that gives the manufactured problem on a unit square or cube (m) with
    `count` cells a side of a kind, of elements of this order."""

    @cache
    def built(kind: str, count: int, order: int, distorted=False, consistent=False) -> Problem:
        dim, material = DIMENSION[kind], Material(MODULUS, 0.25, DENSITY)
        x, cells = unit_cube(kind, count)
        if distorted:
            x = x + 0.08 * np.sin(np.pi * x) * np.roll(np.cos(2 * np.pi * x), 1, axis=1)
        part = Part(x, cells, np.zeros(len(cells), dtype=np.int64), np.zeros((1, dim)))
        none = np.zeros(0, dtype=np.int64), np.zeros((0, 2 ** (dim - 1), dim))
        joints = Joints(none[0], none[0], none[0], none[1])
        mesh = Mesh(kind, (part,), (), joints, {})
        body = build_body(mesh, order, [material], Section(dim, 1.0), consistent=consistent)
        wave = np.array([[1.9, 0.7, -0.4], [-0.6, 2.3, 0.5], [0.8, -0.5, 1.6]])[:dim, :dim]
        motion = Manufactured(wave, np.array([0.3, -0.5, 0.8])[:dim], 4000.0, 0.4)
        point, x, volume = quadrature_in(body, np.arange(len(body.cells)), 2 * body.order + 4)
        forces = loads(body, motion, material, point, x, volume)
        return Problem(body, motion, point._replace(gradient=None), x, volume, *forces)

    return built


def unit_cube(kind: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and cells of a unit square or cube; simplices are quarters of the square's
    cells by one diagonal, or Kuhn's six of the cube's."""
    dim = DIMENSION[kind]
    grid = np.stack(np.meshgrid(*[np.arange(count + 1)] * dim, indexing="ij"), axis=-1)
    x = grid.reshape(-1, dim) / count
    corner = np.array(list(np.ndindex(*[2] * dim)))[:, ::-1]
    low = np.array(list(np.ndindex(*[count] * dim)))
    cells = (low[:, None] + corner) @ (count + 1) ** np.arange(dim)[::-1]
    if CORNERS[kind] == dim + 1:
        paths = {2: [[0, 1, 3], [0, 2, 3]], 3: KUHN}[dim]
        cells = np.concatenate([cells[:, path] for path in paths])
    return x, oriented(kind, x, cells)


KUHN = [[0, a, a + b, 7] for a in (1, 2, 4) for b in (1, 2, 4) if a != b]


def loads(
    body: Body, motion: Manufactured, material: Material, point: Places, x, volume
) -> tuple[np.ndarray, np.ndarray]:
    """Return inertia and elastic force (N, for g'' and g of 1) on every freedom."""
    lame = lame_constants(material, body.dim)

    def work(place, weight, values):
        found, nodes = np.zeros(body.mass.size), body.cells[place.cell]
        for c in range(body.dim):
            each = (weight * values[:, c])[:, None] * place.basis
            freedom = body.freedom(nodes, c).ravel()
            found += np.bincount(freedom, each.ravel(), found.size)
        return found

    inertia = work(point, volume, material.density * motion.displacement(x))
    elastic = work(point, volume, -motion.divergence(x, *lame))
    outer = outer_facets(body.mesh.cell, body.mesh.parts)
    surface = facet_points(body._replace(order=body.order + 3), outer.corners)
    place = places_in(body, outer.cell[surface.facet], surface.x)
    traction = np.einsum(
        "nij,nj->ni", motion.stress(surface.x, *lame), outward(outer)[surface.facet]
    )
    return inertia, elastic + work(place, surface.weight, traction)


def outward(outer: Facets) -> np.ndarray:
    """Return the outward unit normals of flat facets [facets, dim]."""
    normal = normals(outer)
    side = np.sign(((outer.middle - outer.inside) * normal).sum(axis=1))
    return normal * side[:, None]
