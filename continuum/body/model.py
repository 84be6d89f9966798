"""The constants of a jointed elastic body, in one, two or three dimensions.

Freedoms are dolfinx's of a blocked space: component c of node n is d n + c. Mass, stiffness and
forces are per metre of thickness in the plane, and per square metre of section in one dimension.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix


class Forms(NamedTuple):
    """Rock, as bilinear forms of UFL on a vector space.

    mass : kg. stiffness : N/m. damping : N s/m; None without. Integrals that state no quadrature
    take that of the body: at the nodes where this makes the mass diagonal.
    """

    mass: Any
    stiffness: Any
    damping: Any = None


class JumpOperator(NamedTuple):
    """The joints at their points: jump = matrix @ u, force = -matrix.T @ (weights * tractions).

    A jump is the displacement of the side that the normal points to less that of the other: it is
    positive along the normal where the joint opens.

    matrix : [points * d, freedoms], B; d rows a point: along the normal, then along the joint.
    weight : float array [points], m^(d-1). column : int array [points], of the law.
    frame : float array [points, d, d], unit vectors in rows: the normal, then those along the
    joint. place : float array [points, d], m.
    """

    matrix: csr_matrix
    weight: np.ndarray
    column: np.ndarray
    frame: np.ndarray
    place: np.ndarray


class Facets(NamedTuple):
    """Facets of one side of the boundary, at their nodes; a node stands once for each facet.

    node : int array [n]. weight : float array [n], m^(d-1): integral of a facet's function that is
    1 at the node and 0 at others. normal : float array [n, d], unit vectors out of the rock.
    place : float array [n, d], m.
    """

    node: np.ndarray
    weight: np.ndarray
    normal: np.ndarray
    place: np.ndarray


class Body(NamedTuple):
    """A jointed elastic body.

    mesh : dolfinx.mesh.Mesh, in which the two sides of a joint share no node. space : dolfinx.fem's
    vector space of Lagrange elements. block : int array [cells], of the partition. mass : float
    array [freedoms], the diagonal, kg; None where only the consistent one is used. consistent :
    [freedoms, freedoms], kg; None where the mass is diagonal. stiffness : N/m, and damping, N s/m
    (None without) : [freedoms, freedoms]. joints : None where none is resolved. sides : by name.
    """

    mesh: Any
    space: Any
    block: np.ndarray
    mass: np.ndarray | None
    consistent: csr_matrix | None
    stiffness: csr_matrix
    damping: csr_matrix | None
    joints: JumpOperator | None
    sides: dict[str, Facets]

    @property
    def dim(self) -> int:
        """Number of dimensions."""
        return int(self.mesh.geometry.dim)
