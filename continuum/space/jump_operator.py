"""The joints of a body: from pairs of facets to the jump operator."""

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix, identity, kron

from jointwave.cases.geometry.measure import frames_of
from jointwave.continuum.space.model import JumpOperator, in_motion
from jointwave.continuum.space.traces import Trace

ROUND_OFF = 1e-14  # of entries, which are of the order of 1


def jump_operator(
    one: Trace, other: Trace, column: np.ndarray, shape: tuple[int, int]
) -> JumpOperator:
    """Return the jump operator of facets of block i and those of block j at the same places.

    column : of the law, int array [facets]. shape : nodes of the body, and components. In the plane
    the tangent is the normal rotated to the left, in space they are the strike and the line of dip.
    At the end of a joint in rock both sides have one node, and no jump.
    """
    count, points, (nodes, components) = one.node.size, one.node.shape[1], shape
    row, ones = np.tile(np.arange(count), 2), np.ones(count)
    at = row, np.append(one.node.ravel(), other.node.ravel())
    jump = csr_matrix((np.append(-ones, ones), at), (count, nodes))
    jump.eliminate_zeros()
    open_ = np.flatnonzero(np.diff(jump.indptr))
    normal = np.repeat(one.normal[:, :1], points, axis=1).reshape(-1, one.normal.shape[2])
    frame, each = frames_of(in_motion(normal[open_], components)), np.arange(len(open_) + 1)
    size = len(open_) * components
    turned = bsr_matrix((frame, each[:-1], each), shape=(size, size))
    matrix = csr_matrix(turned @ kron(jump[open_], identity(components), format="csr"))
    matrix.data[np.abs(matrix.data) < ROUND_OFF] = 0.0
    matrix.eliminate_zeros()
    return JumpOperator(
        matrix=matrix,
        weight=one.weight.ravel()[open_],
        column=np.repeat(column, points)[open_],
        frame=frame,
        place=one.place.reshape(count, -1)[open_],
    )
