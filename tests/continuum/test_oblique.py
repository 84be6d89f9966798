"""Jumps across joints that lie in any direction: a vector, seen in a frame of its own."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jointwave.continuum.space.interface import jumps


def sheared(slopes):
    """Return what moves vertices along y by these slopes of x and z."""

    def bent(x):
        moved = x.copy()
        others = np.delete(x, 1, axis=-1)
        moved[..., 1] += others @ np.array(slopes)[: others.shape[-1]]
        return moved

    return bent


def rotated(vector):
    """Return what turns vertices by a rotation vector; in the plane about z alone."""
    turn = Rotation.from_rotvec(vector).as_matrix()
    return lambda x: x @ turn[: x.shape[-1], : x.shape[-1]].T


BENT = {
    "sheared along x": (2, sheared([0.7])),
    "turned in the plane": (2, rotated([0.0, 0.0, 2.3])),
    "sheared along x and z": (3, sheared([0.7, -0.4])),
    "turned": (3, rotated([0.4, -1.1, 0.8])),
    "square to x": (3, rotated([0.0, 0.0, -np.pi / 2])),
    "square to -x": (3, rotated([0.0, 0.0, np.pi / 2])),
}


@pytest.mark.parametrize("cell", ["hexahedron", "simplex"])
@pytest.mark.parametrize("dim, bent", BENT.values(), ids=BENT)
def test_a_block_moved_off_jumps_by_its_motion(dim, bent, cell, body):
    """Of the far block by a unit vector: the gap is its part along the normal out of the near one,
    the slips are the rest, along directions square to it and to each other: in space the first is
    along x as far as x lies in the joint, in the plane it is the normal turned to the right. The
    areas are those of the joint itself."""
    found = body(dim, cell, 1, blocks=2, bent=bent)
    at, far = jumps(found), np.unique(found.cells[found.piece == 1])
    frames = np.zeros((at.weight.size, dim, dim))
    for c in range(dim):
        u = np.zeros(found.mass.size)
        u[found.freedom(far, c)] = 1.0
        frames[:, :, c] = np.stack([b @ u for b in at.matrices], axis=1)
    np.testing.assert_allclose(
        frames @ frames.swapaxes(1, 2), np.broadcast_to(np.eye(dim), frames.shape), atol=1e-12
    )
    # The face between the blocks, as it was and as it lies now.
    flat = np.insert(0.5 * np.eye(dim - 1), 1, 0.0, axis=1) if dim == 3 else np.array([[0.5, 0.0]])
    origin = np.zeros(dim)
    edges = bent(flat) - bent(origin)
    along = bent(np.eye(dim)[1]) - bent(origin)
    normal = np.cross(edges[1], edges[0]) if dim == 3 else np.array([-edges[0, 1], edges[0, 0]])
    area = np.linalg.norm(normal) * (1.0 if dim == 3 else 0.5)
    normal = normal / np.linalg.norm(normal) * np.sign(normal @ along)
    np.testing.assert_allclose(
        frames[:, 0], np.broadcast_to(normal, frames[:, 0].shape), atol=1e-12
    )
    assert at.weight.sum() == pytest.approx(area, rel=1e-12)
    x = np.eye(dim)[0] - normal * normal[0]
    if dim == 2:
        x = normal @ [[0.0, -1.0], [1.0, 0.0]]
    if np.linalg.norm(x) > 1e-6:
        expected = np.broadcast_to(x / np.linalg.norm(x), frames[:, 1].shape)
        np.testing.assert_allclose(frames[:, 1], expected, atol=1e-12)
    assert np.linalg.det(frames) == pytest.approx(-1.0, abs=1e-12)


@pytest.mark.parametrize(
    "dim, cell, order",
    [(2, "simplex", 1), (3, "simplex", 1), (2, "hexahedron", 3), (3, "hexahedron", 2)],
)
def test_points_of_a_joint_are_its_nodes(dim, cell, order, body):
    """So that a joint couples no two nodes of one side: a row takes one value from either side."""
    found = body(dim, cell, order, blocks=2)
    at = jumps(found)
    for matrix in at.matrices:
        assert (np.diff(matrix.indptr) == 2).all()
        assert np.sort(matrix.data.reshape(-1, 2)) == pytest.approx(
            np.tile([-1.0, 1.0], (len(at.x), 1))
        )
    on_joint = found.x[np.abs(found.y - 0.5) < 1e-9]
    apart = np.linalg.norm(at.x[:, None] - on_joint, axis=2).min(axis=1)
    assert apart.max() < 1e-12
