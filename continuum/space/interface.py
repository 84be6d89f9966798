"""Joints as interfaces: the jumps across them, at the quadrature points of their facets.

With the jump operators B (freedoms to gap and slip at the points), the weights W and the traction
t (normal compression positive), the joints' internal force is B^T W t(B u). Dimension, order and
kind of element show in B alone. On quadrilaterals and hexahedra the points are the nodes of the
facets (Gauss-Lobatto-Legendre), so that a joint does not couple its own nodes.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.body import Body, along
from jointwave.continuum.space.evaluation import matrix_of, places_in
from jointwave.continuum.space.stencils import distinct

FACETS = {
    "interval": "point",
    "triangle": "interval",
    "quadrilateral": "interval",
    "tetrahedron": "triangle",
    "hexahedron": "quadrilateral",
}


class Facets(NamedTuple):
    """Quadrature points of facets [facets * points of each].

    facet : int array, which of the facets. x : [q, dim], m. weight : share of the area, m2.
    """

    facet: np.ndarray
    x: np.ndarray
    weight: np.ndarray


class Jumps(NamedTuple):
    """The jumps at the quadrature points of the joints.

    matrices : B [q, freedoms] along the normal from the near to the far side, the gap, then along
        x and z where the motion has these components; far side less near side.
    weight : W [q], m2. joint : int array [q], which of the mesh's joints.
    x : [q, dim], m. flat : bool array [q], whether the joint is square to the axis there.
    of_facet : int array [facets, points of each], which of the points a facet has.
    """

    matrices: list[csr_matrix]
    weight: np.ndarray
    joint: np.ndarray
    x: np.ndarray
    flat: np.ndarray
    of_facet: np.ndarray


def facet_points(body: Body, corners: np.ndarray, degree: int | None = None) -> Facets:
    """Return the quadrature points of facets with these corners [facets, corners, dim].

    degree : to which they are exact; absent: the points of a joint, as its elements have them.
    """
    count, _, dim = corners.shape
    if dim == 1:
        return Facets(np.arange(count), corners[:, 0], np.full(count, body.section.extent))
    facet = FACETS[body.mesh.cell]
    if degree is None:
        at, weight = _rule(facet, body.mesh.cell, body.order)
    else:
        at, weight = basix_versions.quadrature(facet, degree)
    basis, gradient = basix_versions.tabulate(facet, 1, at)
    x = np.einsum("qv,fvd->fqd", basis, corners)
    tangents = np.einsum("qvt,fvd->fqtd", gradient, corners)
    if dim == 2:
        area = np.linalg.norm(tangents[:, :, 0], axis=2)
    else:
        area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2)
    weight = body.section.extent * area * weight
    return Facets(np.repeat(np.arange(count), len(at)), x.reshape(-1, dim), weight.ravel())


def _rule(facet: str, cell: str, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the points and weights on a reference facet."""
    if cell in ("quadrilateral", "hexahedron") or facet == "interval":
        return basix_versions.quadrature(facet, max(2 * order - 1, 1), lobatto=True)
    if order == 1:  # the corners, so that linear tetrahedra do not couple their own nodes either
        return np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.full(3, 1 / 6)
    return basix_versions.quadrature(facet, 2 * order)


def jumps(body: Body) -> Jumps:
    """Return the jump operators of all joints of a mesh; points on the same nodes are one."""
    joints = body.mesh.joints
    points = facet_points(body, joints.corners)
    left, right = joints.left[points.facet], joints.right[points.facet]
    beyond = points.x if joints.shift is None else points.x - joints.shift[points.facet]
    near, far = places_in(body, left, points.x), places_in(body, right, beyond)
    frames = _frames(body)[points.facet]
    count, rows = points.weight.size, np.arange(points.weight.size)

    def side(cell: np.ndarray, basis: np.ndarray, direction: int) -> csr_matrix:
        weights = np.einsum("qk,qc->qkc", basis, frames[:, direction])
        return matrix_of(body, rows, cell, weights[None], count)

    matrices = [
        side(right, far.basis, d) - side(left, near.basis, d) for d in range(frames.shape[1])
    ]
    kept, group = distinct(matrices)
    return Jumps(
        matrices=[matrix[kept] for matrix in matrices],
        weight=np.bincount(group, points.weight, kept.size),
        joint=joints.joint[points.facet[kept]],
        x=points.x[kept],
        flat=np.abs(frames[kept, 0, along(body.section)] - 1) < 1e-9,
        of_facet=group.reshape(len(joints.joint), -1),
    )


def _frames(body: Body) -> np.ndarray:
    """Return unit vectors [facets, directions, components]: the normal to the far side, then what
    is nearest to x and z in the facet; on a joint square to the axis y, x and z themselves."""
    joints, components = body.mesh.joints, body.section.components
    if body.dim == 1:
        alike = [[1.0]] if components == 1 else [[0, 1.0, 0], [1.0, 0, 0], [0, 0, 1.0]]
        return np.tile(np.array(alike), (len(joints.joint), 1, 1))
    edges = joints.corners[:, 1:] - joints.corners[:, :1]
    if body.dim == 2:
        normal = edges[:, 0] @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    else:
        normal = np.cross(edges[:, 0], edges[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    centre = body.corners.mean(axis=1)
    across = centre[joints.right] - centre[joints.left]
    across = across if joints.shift is None else across + joints.shift
    outward = (across * normal).sum(axis=1)
    normal *= np.sign(outward)[:, None]
    if body.dim == 2:
        return np.stack([normal, normal @ np.array([[0.0, -1.0], [1.0, 0.0]])], axis=1)
    x = np.array([1.0, 0.0, 0.0]) - normal * normal[:, :1]
    steep = np.linalg.norm(x, axis=1) < 1e-6
    x[steep] = np.array([0.0, -1.0, 0.0])
    x /= np.linalg.norm(x, axis=1)[:, None]
    return np.stack([normal, x, np.cross(x, normal)], axis=1)
