"""The joints of a body: from pairs of facets to the jump operator."""

import numpy as np

from jointwave.cases.geometry.measure import frames_of
from jointwave.continuum.space.model import JumpOperator, in_motion
from jointwave.continuum.space.traces import Trace

ROUND_OFF = 1e-14  # of components of unit vectors


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
