"""The joints of a body: from pairs of facets to the jump operator."""

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.geometry.measure import frames
from jointwave.continuum.body.model import JumpOperator
from jointwave.continuum.body.traces import Trace


def jump_operator(
    one: Trace, other: Trace, column: np.ndarray, nodes: int, components: int
) -> JumpOperator:
    """Return the jump operator of facets of block i and those of block j at the same places.

    column : of the law, int array [facets]. nodes : of the body. At the end of a joint in rock both
    sides have one node, and no jump.
    """
    apart = one.node != other.node
    frame = frames_of(one.normal[apart], components)
    points, axes = len(frame), np.arange(components)
    row = components * np.arange(points)[:, None, None] + axes[:, None]
    entries = []
    for sign, side in ((-1.0, one), (1.0, other)):
        freedom = components * side.node[apart][:, None, None] + axes
        parts = np.broadcast_arrays(row, freedom, sign * frame)
        entries.append([part.ravel() for part in parts])
    row, freedom, value = np.concatenate(entries, axis=1)
    shape = points * components, nodes * components
    matrix = csr_matrix((value, (row.astype(int), freedom.astype(int))), shape)
    matrix.eliminate_zeros()
    return JumpOperator(
        matrix=matrix,
        weight=one.weight[apart],
        column=np.broadcast_to(column[:, None], apart.shape)[apart],
        frame=frame,
        place=one.place[apart],
    )


def frames_of(normal: np.ndarray, components: int) -> np.ndarray:
    """Return frames [n, c, c] of joints with normals [n, d]: in the plane the tangent is the normal
    rotated to the left, in space they are the strike and the line of dip. A mesh of one dimension
    runs along y where it has three components."""
    if normal.shape[1] < components:
        normal = normal * [0.0, 1.0, 0.0]
    tangents: tuple[np.ndarray, ...] = ()
    if components == 2:
        tangents = (np.stack([-normal[:, 1], normal[:, 0]], axis=1),)
    elif components == 3:
        tangents = frames(normal)
    return np.stack([normal, *tangents], axis=1)
