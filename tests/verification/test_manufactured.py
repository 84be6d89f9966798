"""The order of the elements and of the step, by a manufactured motion g(t) U(x) of a whole body."""

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest

from closed_forms.manufactured import Manufactured
from jointwave.continuum.mesh.conforming import Conforming, facets_of
from jointwave.continuum.mesh.domain import Marks
from jointwave.continuum.space import compat
from jointwave.continuum.space.build import build_body
from jointwave.continuum.space.evaluation import (
    Places,
    at_reference,
    jacobians,
    nodes_of_cells,
    tabulate,
)
from jointwave.continuum.space.model import Body
from jointwave.continuum.space.rock import isotropic
from jointwave.continuum.stepping.implicit import Implicit
from jointwave.continuum.stepping.steps import Leapfrog, Problem
from tests.continuum.stacked import readings

DENSITY, LAME, SHEAR = 2400.0, 4e9, 3.8e9
#: Kind, order p, and cells a side of the coarser mesh.
MESHES = [
    *(("quadrilateral", p, count) for p, count in ((1, 8), (2, 4), (3, 3), (4, 2))),
    *(("hexahedron", p, count) for p, count in ((1, 4), (2, 2), (3, 2))),
    *(("triangle", p, count) for p, count in ((1, 8), (2, 4))),
    *(("tetrahedron", p, count) for p, count in ((1, 4), (2, 3))),
]
SIMPLICES = {"triangle": [[0, 1, 3], [0, 2, 3]]}
SIMPLICES["tetrahedron"] = [[0, a, a + b, 7] for a in (1, 2, 4) for b in (1, 2, 4) if a != b]
WAVES = np.array([[1.9, 0.7, -0.4], [-0.6, 2.3, 0.5], [0.8, -0.5, 1.6]])  # 1/m
PHASES = np.array([0.3, -0.5, 0.8])
END = 1e-3  # s, 0.6 of a period
NEVER = 10**9  # steps between samples


class Moved(NamedTuple):
    """A body that the force g'' inertia + g elastic (N) on its freedoms moves as g(t) U(x).

    at, x, volume : quadrature points in all cells, their places (m) and volumes (m2 or m3).
    """

    body: Body
    motion: Manufactured
    at: Places
    x: np.ndarray
    volume: np.ndarray
    inertia: np.ndarray
    elastic: np.ndarray

    def error(self, u: np.ndarray) -> float:
        """Return the distance of u [freedoms] from U at the end, over U, in the L2 norm."""
        exact = self.motion.history(END) * self.motion.displacement(self.x)
        nodes = u.reshape(-1, self.body.components)[nodes_of_cells(self.body)[self.at.cell]]
        off = np.einsum("nk,nkc->nc", self.at.basis, nodes) - exact
        return float(np.sqrt((self.volume @ off**2).sum() / (self.volume @ exact**2).sum()))


class Load:
    """The force of a moved body at steps dt (s); inertia : g'' (1/s2) at a time (s)."""

    def __init__(self, moved, dt, inertia):
        self.moved, self.dt, self.inertia = moved, dt, inertia
        self.freedom = np.arange(moved.inertia.size)

    def at(self, first, last):
        times = self.dt * np.arange(first, last)
        inertia, history = (
            np.array([of(t) for t in times]) for of in (self.inertia, self.moved.motion.history)
        )
        return np.outer(inertia, self.moved.inertia) + np.outer(history, self.moved.elastic)


@cache
def moved(kind, order, count, consistent=False) -> Moved:
    """Return a unit square or cube (m) of skewed cells, `count` a side, under that motion."""
    x, cells = unit_cube(kind, count)
    dim = x.shape[1]
    x = x + 0.08 * np.sin(np.pi * x) * np.roll(np.cos(2 * np.pi * x), 1, axis=1)
    block, on = np.zeros(len(cells), int), np.full((len(cells), len(facets_of(kind))), -1)
    none = Marks(np.zeros(0, int), np.zeros(0, int), ())
    mesh = Conforming(kind, x, cells, block, on)
    body = build_body(
        mesh, none, order, lambda space, _: isotropic(space, DENSITY, LAME, SHEAR),
        consistent=consistent,
    )  # fmt: skip
    motion = Manufactured(WAVES[:dim, :dim], PHASES[:dim], 4000.0, 0.4)
    points, weights = compat.quadrature(kind, 2 * order + 4)
    cell, local = np.repeat(np.arange(len(cells)), len(points)), np.tile(points, (len(cells), 1))
    at = at_reference(body, cell, cell, local)
    corners = compat.cell_corners(body.mesh)[cell]
    places = np.einsum("nv,nvd->nd", tabulate(kind, corners.shape[1], local)[0], corners)
    volume = np.abs(np.linalg.det(jacobians(kind, corners, local))) * np.tile(weights, len(cells))
    stress = motion.stress(places, LAME, SHEAR)
    inertia = DENSITY * at.basis[:, :, None] * motion.displacement(places)[:, None]
    elastic = np.einsum("nkj,ncj->nkc", at.gradient, stress)
    forces = (summed(body, cell, volume[:, None, None] * one) for one in (inertia, elastic))
    return Moved(body, motion, at, places, volume, *forces)


def unit_cube(kind, count):
    """Return vertices and cells of a unit square or cube; simplices are halves of the square's
    cells by one diagonal, or Kuhn's six of the cube's."""
    dim = 2 if kind in ("quadrilateral", "triangle") else 3
    x = np.array(list(product(range(count + 1), repeat=dim))) / count
    corner = np.array(list(product(range(2), repeat=dim)))[:, ::-1]
    first = np.array(list(product(range(count), repeat=dim)))
    cells = (first[:, None] + corner) @ (count + 1) ** np.arange(dim)[::-1]
    if kind in SIMPLICES:
        cells = np.concatenate([cells[:, path] for path in SIMPLICES[kind]])
    return x, cells


def summed(body, cell, values):
    """Return the sum [freedoms] of values [n, nodes of a cell, d] of cells [n]."""
    found = np.zeros((len(body.x), body.components))
    np.add.at(found, nodes_of_cells(body)[cell], values)
    return found.ravel()


def free(one):
    """Return the problem of a body alone."""
    return Problem(one.body, readings(one.body))


def drive(one, dt, steps, inertia):
    """Return the displacement after so many steps dt (s) of leapfrog from the exact start.

    inertia : g'' (1/s2) at a time (s).
    """
    g, start = one.motion.history, one.motion.displacement(one.body.x).ravel()
    leapfrog = Leapfrog(free(one)._replace(forces=Load(one, dt, inertia)), dt, 1, energy=False)
    leapfrog.start(g(0.0) * start)
    leapfrog.throw((g(0.0) - g(-dt)) / dt * start)
    leapfrog.take(0, steps, NEVER)
    return leapfrog.u


def drive_implicitly(one, dt, steps, frequency, rho=1.0):
    """Return the displacement after so many implicit steps dt (s) of spectral radius rho, from the
    exact start; frequency : rad/s, that velocity and inertia of the motion are taken with."""
    motion, start = one.motion, one.motion.displacement(one.body.x).ravel()
    load = Load(one, dt, lambda t: -(frequency**2) * motion.history(t))
    own = Implicit(free(one)._replace(forces=load), dt, 1, rho, energy=False)
    own.now.u[:] = motion.history(0.0) * start
    own.now.v[:] = frequency * np.cos(motion.start) * start
    own.take(0, steps + 1, NEVER)
    return own.u


def trapezoids_own(motion, dt):
    """Return the frequency (rad/s) that the trapezoidal rule sees a sine with: under it, its steps
    make no error."""
    return 2 / dt * np.tan(motion.omega * dt / 2)


def leapfrogs_own(motion, dt):
    """Return g'' as leapfrog takes it, by differences: under it, its steps make no error."""
    g = motion.history
    return lambda t: (g(t + dt) - 2 * g(t) + g(t - dt)) / dt**2


def steps_of(one):
    """Return how many equal steps of 0.9 of the critical one reach the end."""
    return int(np.ceil(END / (0.9 * free(one).critical_step())))


@pytest.mark.parametrize("kind, order, count", MESHES)
def test_order_of_the_elements(kind, order, count):
    """The displacement converges at p + 1 in the L2 norm, with steps that make no error."""
    errors = []
    for cells in (count, 2 * count):
        one = moved(kind, order, cells)
        dt = END / steps_of(one)
        u = drive(one, dt, steps_of(one), leapfrogs_own(one.motion, dt))
        errors.append(one.error(u))
    rate = np.log2(errors[0] / errors[1])
    assert order + 1 - 0.2 < rate < order + 1 + 0.5


@pytest.mark.parametrize("kind, order, count", [mesh for mesh in MESHES if mesh[0] in SIMPLICES])
def test_order_of_simplices_of_consistent_mass(kind, order, count):
    """p + 1, too, by implicit steps, which make no error at any length."""
    errors, dt = [], END / 10
    for cells in (count, 2 * count):
        one = moved(kind, order, cells, consistent=True)
        u = drive_implicitly(one, dt, 10, trapezoids_own(one.motion, dt))
        errors.append(one.error(u))
    rate = np.log2(errors[0] / errors[1])
    assert order + 1 - 0.2 < rate < order + 1 + 0.5


@pytest.mark.parametrize("kind", ["quadrilateral", "hexahedron"])
def test_order_of_the_step(kind):
    """Two: the distance from the steps under leapfrog's own inertia, which make no error."""
    one, errors = moved(kind, 4, 1), []
    for steps in (steps_of(one), 2 * steps_of(one), 4 * steps_of(one)):
        dt = END / steps
        u = drive(one, dt, steps, one.motion.acceleration)
        errors.append(np.linalg.norm(u - drive(one, dt, steps, leapfrogs_own(one.motion, dt))))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.02)


@pytest.mark.parametrize("rho", [1.0, 0.5, 0.0])
def test_order_of_the_implicit_step(rho):
    """Two for every spectral radius: the distance from steps that make no error."""
    one, errors = moved("quadrilateral", 4, 1), []
    for steps in (60, 120, 240):
        dt = END / steps
        u = drive_implicitly(one, dt, steps, one.motion.omega, rho)
        exact = drive_implicitly(one, dt, steps, trapezoids_own(one.motion, dt))
        errors.append(np.linalg.norm(u - exact))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.05)
