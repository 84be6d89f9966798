"""The constants of a jointed elastic body, in one, two or three dimensions.

Component c of node n is freedom d n + c, as in dolfinx's blocked spaces; d is the number of
components, one or three in a mesh of one dimension, which then runs along the second of three.
Mass, stiffness and forces are per metre of thickness in the plane, and per square metre of section
in one dimension.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.geometry.measure import frames_of
from jointwave.continuum.space.traces import Reference, Trace

ROUND_OFF = 1e-14  # of components of unit vectors


class Forms(NamedTuple):
    """Rock, as bilinear forms of UFL on a vector space.

    mass : kg. stiffness : N/m. damping : N s/m; None without. Integrals that state no quadrature
    take that of the body, at the nodes where this makes the mass diagonal; those of functions of
    `ufl.SpatialCoordinate` UFL's own, and row sums of the mass.
    """

    mass: Any
    stiffness: Any
    damping: Any = None


class JumpOperator(NamedTuple):
    """The joints at their points: the jump is B u, and forces are B^T (weights times the tractions
    on block j), with block j on the side that the normal points to.

    A jump is the displacement of block j less that of block i: positive along the normal where the
    joint opens.

    node : int array [points, 2], of block i and of block j. weight : float array [points], m^(d-1).
    column : int array [points], of the law: the contact between blocks, those across periodic sides
    last; of a pillar the joint. frame : float array [points, d, d], unit vectors in rows: the
    normal, then those along the joint. place : float array [points, dimensions], m, on block i.
    """

    node: np.ndarray
    weight: np.ndarray
    column: np.ndarray
    frame: np.ndarray
    place: np.ndarray

    def jumps(self, u: np.ndarray) -> np.ndarray:
        """Return the jumps of displacements [freedoms] along the frames [points, d], m."""
        one, other = u.reshape(-1, self.frame.shape[1])[self.node.T]
        return np.einsum("qac,qc->qa", self.frame, other - one)

    def matrix(self, freedoms: int) -> csr_matrix:
        """Return B [points * d, freedoms]."""
        dim = self.frame.shape[1]
        row = np.arange(self.frame[..., 0].size)
        column = dim * self.node[:, None, :, None] + np.arange(dim)
        value = self.frame[:, :, None] * np.array([-1.0, 1.0])[:, None]
        column = np.broadcast_to(column, value.shape).ravel()
        at = np.repeat(row, 2 * dim), column
        found = csr_matrix((value.ravel(), at), (row.size, freedoms))
        found.eliminate_zeros()
        return found

    def carried(self, stress: np.ndarray) -> np.ndarray:
        """Return the tractions of a stress [d, d] on the points [points * d], Pa."""
        return np.einsum("qac,cd,qd->qa", self.frame, stress, self.frame[:, 0]).ravel()


class Facets(NamedTuple):
    """Facets of one side of the boundary, at their nodes; a node stands once for each facet.

    node : int array [n]. weight : float array [n], m^(d-1): integral of a facet's function that is
    1 at the node and 0 at others. normal : float array [n, components], unit vectors out of the
    rock. place : float array [n, d], m.
    """

    node: np.ndarray
    weight: np.ndarray
    normal: np.ndarray
    place: np.ndarray


class Body(NamedTuple):
    """A jointed elastic body.

    mesh : dolfinx.mesh.Mesh, in which the two sides of a joint share no node. space : dolfinx.fem's
    vector space of displacements. cell : of the mesh, with its element. tied : int array [nodes of
    the space], the node of the body that each is; None where these are the same, but for rock that
    is whole across periodic sides.
    x : float array [nodes, d], m. block : int array [cells], of the partition. mass : float array
    [freedoms], the diagonal, kg. stiffness : N/m, and damping, N s/m (without entries where there
    is none) : [freedoms, freedoms]. joints : of no points where none is resolved. sides : by name.

    A process's share of a body (`continuum.processes.share`) has the rows of its freedoms, which
    are the first, and columns of those of others that these need; `block` is of its nodes, and
    there is no mesh and no space.
    """

    mesh: Any
    space: Any
    cell: Reference
    tied: np.ndarray | None
    x: np.ndarray
    block: np.ndarray
    mass: np.ndarray
    stiffness: csr_matrix
    damping: csr_matrix
    joints: JumpOperator
    sides: dict[str, Facets]

    @property
    def components(self) -> int:
        """Components of displacements at a node."""
        return self.stiffness.shape[0] // len(self.x)


def in_motion(vectors: np.ndarray, components: int) -> np.ndarray:
    """Return vectors in a mesh [n, d] by the components of the motion; a mesh of one dimension runs
    along y where it has three."""
    return vectors if vectors.shape[1] == components else vectors * [0.0, 1.0, 0.0]


def jump_operator(one: Trace, other: Trace, column: np.ndarray, components: int) -> JumpOperator:
    """Return the jump operator of facets of block i and those of block j at the same places.

    column : of the law, int array [facets]. components : of displacements. In the plane the tangent
    is the normal rotated to the left, in space they are the strike and the line of dip. At the end
    of a joint in rock both sides have one node, and no jump.
    """
    count, points = one.node.size, one.node.shape[1]
    node = np.stack([one.node.ravel(), other.node.ravel()], axis=1)
    open_ = np.flatnonzero(node[:, 0] != node[:, 1])
    normal = np.repeat(one.normal[:, :1], points, axis=1).reshape(-1, one.normal.shape[2])
    frame = frames_of(in_motion(normal[open_], components))
    frame[np.abs(frame) < ROUND_OFF] = 0.0
    return JumpOperator(
        node=node[open_],
        weight=one.weight.ravel()[open_],
        column=np.repeat(column, points)[open_],
        frame=frame,
        place=one.place.reshape(count, -1)[open_],
    )


def at_nodes(node: np.ndarray, tensors: np.ndarray, size: int) -> csr_matrix:
    """Return the matrix [size, size] of tensors [n, d, d] at nodes, which add up there."""
    dim = tensors.shape[1]
    own = dim * node[:, None] + np.arange(dim)
    row, column = np.repeat(own, dim, axis=1), np.tile(own, dim)
    return csr_matrix((tensors.ravel(), (row.ravel(), column.ravel())), (size, size))


def forces_on(body: Body, facets: Facets, traction: np.ndarray) -> np.ndarray:
    """Return the force on every freedom of tractions [n, d] (Pa) on facets at their nodes, N."""
    dim, found = body.components, np.zeros(body.stiffness.shape[0])
    own = dim * facets.node[:, None] + np.arange(dim)
    np.add.at(found, own, facets.weight[:, None] * traction)
    return found


def directions(body: Body) -> list[int]:
    """Return the axes, x, y, z, of the components of the motion of a pillar or in space."""
    return [1] if body.components == 1 else [0, 1, 2][: body.components]
