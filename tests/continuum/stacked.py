"""Stacks of equal boxes with joints between them: bodies for tests of steps."""

import numpy as np
from scipy.sparse import csr_matrix, diags

from jointwave.cases.geometry.cell_complex import box
from jointwave.cases.geometry.cut import cut, planes_of
from jointwave.cases.geometry.measure import facet_moments
from jointwave.continuum.mesh.boxes import box_mesh, boxes_of
from jointwave.continuum.mesh.conforming import Marks
from jointwave.continuum.space.build import Elements
from jointwave.continuum.space.rock import elastic, isotropic
from jointwave.continuum.stepping.problem import Readings


def stack(dim, count, cells, across=1, order=2, modulus=2.0, poisson=0.25):
    """Return `count` boxes 1 wide and high on top of one another along the last axis, each high in
    `cells` elements and wide in `across`: rock of density 1, a bar in one dimension."""
    low, high = np.zeros(dim), np.append(np.ones(dim - 1), count)
    up, levels = np.eye(dim)[-1], np.arange(1.0, count)
    body = cut(box(low, high), planes_of(up, np.zeros(1, int), [levels], joint_set=0), 1e-9).body
    boxes, middle = boxes_of(body), facet_moments(body).centroid
    arms = (
        body.vertices[boxes.corners[:, 1 << np.arange(dim)]] - body.vertices[boxes.corners[:, :1]]
    )
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
