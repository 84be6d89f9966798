"""Stacks of equal boxes with joints between them, made by hand: bodies for tests of steps."""

import itertools

import basix
import numpy as np
import ufl
from dolfinx import fem
from scipy.sparse import csr_matrix, diags

from jointwave.continuum.space import compat
from jointwave.continuum.space.model import Body, Facets, JumpOperator
from jointwave.continuum.stepping.problem import Readings

KINDS = {1: "interval", 2: "quadrilateral", 3: "hexahedron"}
SIDES = {1: ("bottom", "top"), 2: ("left", "right", "bottom", "top")}
SIDES[3] = ("left", "right", "front", "back", "bottom", "top")


def stack(dim, count, cells, across=1, order=2, size=1.0, width=1.0, modulus=2.0, poisson=0.25,
          density=1.0):  # fmt: skip
    """Return `count` boxes on top of one another along the last axis, each `size` high in `cells`
    elements and `width` wide in `across`: linear elastic, a bar in one dimension."""
    numbers = [across] * (dim - 1) + [cells]
    lengths = np.array([width] * (dim - 1) + [size])
    grid = np.array(list(itertools.product(*(range(n + 1) for n in numbers))))
    strides = np.array([int(np.prod([n + 1 for n in numbers[k + 1 :]])) for k in range(dim)])
    corner = np.array(list(itertools.product(*([range(2)] * dim))))[:, ::-1]
    first = np.array(list(itertools.product(*(range(n) for n in numbers))))
    table = (first[:, None] + corner) @ strides
    x = grid * lengths / numbers
    lift = np.eye(dim)[-1] * size
    every = np.concatenate([x + b * lift for b in range(count)])
    tables = np.concatenate([table + b * len(x) for b in range(count)])
    mesh = compat.make_mesh(KINDS[dim], every, tables)
    space = compat.lagrange(mesh, order, dim)
    block = np.arange(len(tables)) // len(table)
    block = block[compat.input_cells(mesh)]

    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    shear = modulus / 2 / (1 + poisson)
    lame = 2 * shear * poisson / (1 - 2 * poisson)

    def strain(w):
        return ufl.sym(ufl.grad(w))

    nodes = {"quadrature_rule": "GLL", "quadrature_degree": max(2 * order - 1, 1)}
    at_nodes = ufl.dx(metadata=nodes)
    stress = modulus * strain(u)
    if dim > 1:
        stress = 2 * shear * strain(u) + lame * ufl.tr(strain(u)) * ufl.Identity(dim)
    mass = compat.matrix(density * ufl.inner(u, v) * at_nodes).diagonal()
    stiffness = compat.matrix(ufl.inner(stress, strain(v)) * ufl.dx)

    at = fem.Function(space, dtype=np.float64)
    at.interpolate(lambda x: x[:dim])
    places = at.x.array.reshape(-1, dim).copy()
    cell_nodes = compat.cell_nodes(space)
    node_block = np.empty(len(places), dtype=int)
    node_block[cell_nodes] = block[:, None]
    area = facet_weights(places, node_block, numbers, lengths, order)
    sides = {}
    for k, name in enumerate(SIDES[dim]):
        axis, end = (k // 2, k % 2) if dim > 1 else (0, k)
        reach = (lengths + (count - 1) * lift)[axis]
        on = np.flatnonzero(np.isclose(places[:, axis], end * reach))
        normal = np.zeros((len(on), dim))
        normal[:, axis] = 2 * end - 1
        sides[name] = Facets(on, area(on, axis), normal, places[on], node_block[on])
    joints = jump_operator(places, node_block, count, size, area) if count > 1 else None
    return Body(mesh, space, None, places, block, mass, None, stiffness, None, joints, sides)


def facet_weights(places, block, numbers, lengths, order):
    """Return the function of the areas that nodes stand for on facets normal to an axis."""
    degree, gll = max(2 * order - 1, 1), basix.QuadratureType.gll
    try:
        at, weight = basix.make_quadrature(basix.CellType.interval, degree, rule=gll)
    except TypeError:  # older: the rule comes first, and nothing has a name
        at, weight = basix.make_quadrature(gll, basix.CellType.interval, degree)

    def along(axis):
        h = lengths[axis] / numbers[axis]
        local = places[:, axis] / h % 1
        local[np.isclose(local, 1)] = 0
        found = np.zeros(len(places))
        for one, share in zip(at[:, 0], weight, strict=True):
            found[np.isclose(local, round(one, 9) % 1)] += h * share
        end = np.isclose(places[:, axis] % lengths[axis], 0) | np.isclose(
            places[:, axis] % lengths[axis], lengths[axis]
        )
        return np.where(end, found / 2, found)

    def area(nodes, axis):
        found = np.ones(len(nodes))
        for other in range(len(lengths)):
            if other != axis:
                found *= along(other)[nodes]
        return found

    return area


def jump_operator(places, block, count, size, area):
    """Return the joints between boxes, points at the nodes."""
    dim, axis = places.shape[1], places.shape[1] - 1
    rows, columns, values, weights, points, number = [], [], [], [], [], []
    frame = np.roll(np.eye(dim), 1, axis=0)  # the last axis is normal
    if dim == 2:
        frame = np.array([[0.0, 1.0], [-1.0, 0.0]])
    for b in range(count - 1):
        height = (b + 1) * size
        below = np.flatnonzero((block == b) & np.isclose(places[:, axis], height))
        above = np.flatnonzero((block == b + 1) & np.isclose(places[:, axis], height))
        keys = [np.lexsort(places[one].round(9).T) for one in (below, above)]
        for i, j in zip(below[keys[0]], above[keys[1]], strict=True):
            q = len(points)
            for a in range(dim):
                for c in range(dim):
                    rows += [dim * q + a] * 2
                    columns += [dim * i + c, dim * j + c]
                    values += [-frame[a, c], frame[a, c]]
            points.append(places[i])
            weights.append(area(np.array([i]), axis)[0])
            number.append(b)
    matrix = csr_matrix((values, (rows, columns)), (dim * len(points), dim * len(places)))
    matrix.eliminate_zeros()
    frames = np.tile(frame, (len(points), 1, 1))
    return JumpOperator(matrix, np.array(weights), np.array(number), frames, np.array(points))


def stiff_joints(body, normal, shear):
    """Return B^T W k B of the joints of a body."""
    dim = body.components
    k = np.array([normal] + [shear] * (dim - 1))
    weights = (body.joints.weight[:, None] * k).ravel()
    return csr_matrix(body.joints.matrix.T @ diags(weights) @ body.joints.matrix)


def readings(body, nodes=(), points=()):
    """Return readings of the motion of nodes, and of traction and jump at points of joints."""
    dim = body.components
    count = 0 if body.joints is None else len(body.joints.weight)

    def rows(numbers, size, values=None):
        column = (dim * np.array(numbers, int)[:, None] + np.arange(dim)).ravel()
        value = np.ones(column.size) if values is None else np.repeat(values, dim)
        return csr_matrix((value, (np.arange(column.size), column)), (column.size, dim * size))

    area = None if not len(points) else 1 / body.joints.weight[list(points)]
    return Readings(
        motion=rows(nodes, len(body.x)),
        stress=csr_matrix((0, dim * len(body.x))),
        constant=np.zeros(0),
        traction=rows(points, count, area),
        carried=np.zeros(dim * len(points)),
        jump=rows(points, count),
    )


class Force:
    """A force on freedoms by a function of time."""

    def __init__(self, freedom, share, value, dt):
        self.freedom, self.share, self.value, self.dt = freedom, share, value, dt

    def at(self, first, last):
        return np.outer(self.value(self.dt * np.arange(first, last)), self.share)
