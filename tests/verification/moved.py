"""Bodies of a unit square or cube under the forces by which they move as g(t) U(x)."""

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np

from closed_forms.manufactured import Manufactured
from jointwave.continuum.mesh.conforming import Conforming, Marks, facets_of
from jointwave.continuum.space import compat, evaluation
from jointwave.continuum.space.build import Elements
from jointwave.continuum.space.evaluation import nodes_of_cells
from jointwave.continuum.space.model import Body
from jointwave.continuum.space.rock import isotropic

DENSITY, LAME, SHEAR = 2400.0, 4e9, 3.8e9
SIMPLICES = {"triangle": [[0, 1, 3], [0, 2, 3]]}
SIMPLICES["tetrahedron"] = [[0, a, a + b, 7] for a in (1, 2, 4) for b in (1, 2, 4) if a != b]
WAVES = np.array([[1.9, 0.7, -0.4], [-0.6, 2.3, 0.5], [0.8, -0.5, 1.6]])  # 1/m
PHASES = np.array([0.3, -0.5, 0.8])
END = 1e-3  # s, 0.6 of a period


class Moved(NamedTuple):
    """A body that the force g'' inertia + g elastic (N) on its freedoms moves as g(t) U(x).

    at, x, volume : quadrature points in all cells, their places (m) and volumes (m2 or m3)."""

    body: Body
    motion: Manufactured
    at: evaluation.Places
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
def moved(kind, order, count) -> Moved:
    """Return a unit square or cube (m) of skewed cells, `count` a side, under that motion."""
    x, cells = unit_cube(kind, count)
    dim = x.shape[1]
    x = x + 0.08 * np.sin(np.pi * x) * np.roll(np.cos(2 * np.pi * x), 1, axis=1)
    block, on = np.zeros(len(cells), int), np.full((len(cells), len(facets_of(kind))), -1)
    none = Marks(np.zeros(0, int), np.zeros(0, int), ())
    mesh = Conforming(kind, x, cells, block, on)
    elements = Elements(mesh, none, order)
    body = elements.body(isotropic(elements.space, DENSITY, LAME, SHEAR))
    motion = Manufactured(WAVES[:dim, :dim], PHASES[:dim], 4000.0, 0.4)
    points, weights = compat.quadrature(kind, 2 * order + 4)
    cell, local = np.repeat(np.arange(len(cells)), len(points)), np.tile(points, (len(cells), 1))
    at = evaluation.at_reference(body, cell, cell, local)
    corners = compat.cell_corners(body.mesh)[cell]
    shapes = evaluation.tabulate(compat.reference(kind, 1), local)[0]
    places = np.einsum("nv,nvd->nd", shapes, corners)
    change = np.linalg.det(evaluation.jacobians(kind, corners, local))
    volume = np.abs(change) * np.tile(weights, len(cells))
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
