"""The constants of a jointed elastic body, in one, two or three dimensions.

Component c of node n is freedom d n + c, as in dolfinx's blocked spaces; d is the number of
components. A one-dimensional mesh has one or three; of three, the second is along the mesh. Mass,
stiffness and forces are per metre of thickness in the plane, per area of section in one dimension.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.geometry.measure import frames_of
from jointwave.continuum.space.traces import Reference, Trace

ROUND_OFF = 1e-14  # of components of unit vectors


class Forms(NamedTuple):
    """Rock, as bilinear UFL forms on a vector space.

    mass : kg. stiffness : N/m. damping : N s/m; None without. Integrals that state no quadrature
    use the body's rule, nodal where this makes the mass diagonal. Integrals with
    `ufl.SpatialCoordinate` use UFL's default, and the mass its row sums.
    """

    mass: Any
    stiffness: Any
    damping: Any = None


class JumpOperator(NamedTuple):
    """The joints at their points: the jump is B u, forces are B^T (weights times tractions on block
    j), and the normal points from block i to block j.

    The jump is the displacement of block j less that of block i: its normal part is the opening.

    node : of block i and of block j [points, 2]. weight : area [points], m^(d-1). column : of the
    law [points], the contact between blocks, those across periodic sides last; in a pillar the
    joint. frame : rows are normal and tangents [points, d, d]. place : on block i [points, dim], m.
    """

    node: np.ndarray
    weight: np.ndarray
    column: np.ndarray
    frame: np.ndarray
    place: np.ndarray

    def jumps(self, u: np.ndarray) -> np.ndarray:
        """Return the jumps of displacements [freedoms] in the frames [points, d], m."""
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
        """Return the tractions of a stress [d, d] at the points [points * d], Pa."""
        return np.einsum("qac,cd,qd->qa", self.frame, stress, self.frame[:, 0]).ravel()


class Facets(NamedTuple):
    """Facets of one side of the boundary, at their nodes; a node appears once for each facet.

    node : [n]. weight : integral of the node's shape function over the facet [n], m^(d-1).
    normal : unit vectors out of the rock [n, components]. place : [n, d], m.
    """

    node: np.ndarray
    weight: np.ndarray
    normal: np.ndarray
    place: np.ndarray


class Body(NamedTuple):
    """A jointed elastic body.

    mesh : dolfinx.mesh.Mesh, in which the two sides of a joint share no node. space : dolfinx.fem's
    vector space of displacements. cell : of the mesh, with its element. tied : the body's node of
    each node of the space, where several move as one; else None. x : nodes [nodes, d], m. block :
    of the partition [cells]. mass : diagonal [freedoms], kg. stiffness, damping : [freedoms,
    freedoms], N/m and N s/m, without entries if absent. joints : may have no points. sides : by
    name.

    A process's share of a body (`continuum.processes.share`) has rows for its own freedoms, which
    come first, and columns for the halo, too; `block` is of its nodes, mesh and space are None.
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
    """Return vectors of a mesh [n, d] in the components of the motion [n, components]; a
    one-dimensional mesh with three components runs along y."""
    return vectors if vectors.shape[1] == components else vectors * [0.0, 1.0, 0.0]


def jump_operator(one: Trace, other: Trace, column: np.ndarray, components: int) -> JumpOperator:
    """Return the jump operator of facets of block i and of block j at the same places.

    column : of the law [facets]. components : of displacements. In the plane the tangent is the
    normal rotated to the left, in space the tangents are the strike and the line of dip. At the tip
    of a joint both sides have one common node, which is left out.
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
    """Return the matrix [size, size] that sums tensors [n, d, d] at nodes [n]."""
    dim = tensors.shape[1]
    own = dim * node[:, None] + np.arange(dim)
    row, column = np.repeat(own, dim, axis=1), np.tile(own, dim)
    return csr_matrix((tensors.ravel(), (row.ravel(), column.ravel())), (size, size))


def forces_on(body: Body, facets: Facets, traction: np.ndarray) -> np.ndarray:
    """Return the force on every freedom, N, from tractions [n, d], Pa, at the nodes of facets."""
    dim, found = body.components, np.zeros(body.stiffness.shape[0])
    own = dim * facets.node[:, None] + np.arange(dim)
    np.add.at(found, own, facets.weight[:, None] * traction)
    return found


def directions(body: Body) -> list[int]:
    """Return the axis, 0 to 2 for x to z, of each component of the motion."""
    return [1] if body.components == 1 else [0, 1, 2][: body.components]
