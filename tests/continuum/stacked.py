"""Stacks of equal boxes with joints between them: bodies for tests of steps."""

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.cut import cut, planes_of
from jointwave.cases.geometry.measure import facet_moments
from jointwave.continuum.mesh.boxes import box_mesh, boxes_of
from jointwave.continuum.mesh.conforming import Marks
from jointwave.continuum.space.build import Elements
from jointwave.continuum.space.rock import elastic, isotropic
from jointwave.continuum.stepping.problem import Problem, Readings
from jointwave.joints.law import law

NORMAL, SHEAR = 3.0, 2.0  # stiffness of joints


def stack(dim, count, cells, across=1, order=2, modulus=2.0, poisson=0.25):
    """Return `count` boxes 1 wide and high on top of one another along the last axis, each high in
    `cells` elements and wide in `across`: rock of density 1, a bar in one dimension."""
    low, high = np.zeros(dim), np.append(np.ones(dim - 1), count)
    up, levels = np.eye(dim)[-1], np.arange(1.0, count)
    body = cut(box(low, high), planes_of(up, np.zeros(1, int), [levels], joint_set=0), 1e-9).body
    boxes, middle = boxes_of(body), facet_moments(body).centroid
    corners = body.vertices[boxes.corners]
    arms = corners[:, 1 << np.arange(dim)] - corners[:, :1]
    mesh = box_mesh(body, boxes, np.where(arms @ up > 0.5, cells, across))
    column = np.where(body.inner, body.sides.min(axis=1), -1)
    side = np.where(middle[:, -1] < 1e-9, 0, np.where(middle[:, -1] > count - 1e-9, 1, 2))
    marks = Marks(column, np.where(body.inner, -1, side), ("bottom", "top", "beside"))
    shear = modulus / 2 / (1 + poisson)
    lame = 2 * shear * poisson / (1 - 2 * poisson)

    elements = Elements(mesh, marks, order)
    if dim == 1:
        return elements.body(elastic(elements.space, 1.0, lambda slope: modulus * slope, None))
    return elements.body(isotropic(elements.space, 1.0, lame, shear))


def readings(body, nodes=()):
    """Return readings of the motion of nodes."""
    dim = body.components
    points = len(body.joints.weight)
    freedom = (dim * np.array(nodes, int)[:, None] + np.arange(dim)).ravel()
    rows = np.arange(freedom.size)
    motion = csr_matrix((np.ones(freedom.size), (rows, freedom)), (rows.size, dim * len(body.x)))
    none, of_points = csr_matrix((0, dim * len(body.x))), csr_matrix((0, dim * points))
    return Readings(motion, none, np.zeros(0), of_points, np.zeros(0), of_points, none)


def joined(count, shear=True, eta=None, **strengths):
    """Return the law of this number of joints."""
    every = np.ones(count)
    return law(
        NORMAL * every,
        None if eta is None else eta * every,
        strengths.pop("tension", every == 1),
        shear_stiffness=SHEAR * every if shear else None,
        **{name: value * every for name, value in strengths.items()},
    )


def problem(body, own=None, nodes=(), **acts):
    return Problem(body, readings(body, nodes), own, own, **acts)


class Force:
    """A force on freedoms by a function of time."""

    def __init__(self, freedom, share, value, dt):
        self.freedom, self.share, self.value, self.dt = freedom, share, value, dt

    def at(self, first, last):
        return np.outer(self.value(self.dt * np.arange(first, last)), self.share)
