"""Velocities, rotations and external forces of recorded blocks, from their samples."""

import numpy as np

from jointwave.dem.blocks.rigid import RigidBlocks
from jointwave.dem.kernel.model import Samples
from jointwave.dem.system import BlockSystem


def acting(system: BlockSystem, places: np.ndarray, samples: Samples, first: int = 0) -> np.ndarray:
    """Return the resultants of sides, ends and loads on recorded blocks [r, d + d^2, n], N and N m
    (see `dem.sides.boundaries`); those of end springs have the force only.

    places : the recorded blocks [r]. first : number of the first sample.
    """
    loads, count = system.loads, samples.velocity.shape[-1]
    found = np.zeros((len(places), loads.onto.shape[1], count))
    acted = np.flatnonzero(np.isin(places, loads.rows))
    if not len(acted):
        return found
    row = np.searchsorted(loads.rows, places[acted])
    steps = system.time.stride * (first + np.arange(count))
    sums = np.moveaxis(loads.resultants(steps, row), 0, -1)
    velocity = velocity_of(system.blocks, samples, places)[acted]
    sums -= system.resistance[row] @ loads.onto.T @ velocity
    if samples.closure is not None:
        dim, pushed = system.blocks.dim, system.model.held.springs[row, 2] @ samples.closure[row]
        sums[:, :dim] -= pushed[:, :dim]
    found[acted] = sums
    return found


def turning(quaternion: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Return R r - r for unit quaternions, scalar part last [..., 4], and vectors r [..., 3].

    R r - r = 2 q x (q x r + w r), which keeps the digits of small rotations.
    """
    q, w = quaternion[..., :3], quaternion[..., 3:]
    return 2 * np.cross(q, np.cross(q, r) + w * r)


def velocity_of(
    blocks: RigidBlocks, samples: Samples, places: np.ndarray | slice = slice(None)
) -> np.ndarray:
    """Return velocities of recorded blocks [r, F, n], m/s and rad/s, with finite rotations from the
    sampled angular momenta; places : the blocks [r]."""
    if not blocks.finite:
        return samples.velocity
    turn = samples.displacement[:, 3:].swapaxes(1, 2)
    momentum, back = samples.velocity[:, 3:].swapaxes(1, 2), turn * [-1, -1, -1, 1]
    own = (momentum + turning(back, momentum)) / blocks.inertia[places, None, 3:]
    spin = own + turning(turn, own)
    return np.concatenate([samples.velocity[:, :3], spin.swapaxes(1, 2)], axis=1)


def rotation_vectors(quaternions: np.ndarray) -> np.ndarray:
    """Return rotation vectors [..., 3] (rad, up to pi) from quaternions, scalar last [..., 4]."""
    from scipy.spatial.transform import Rotation  # slow to import

    if not quaternions.size:
        return quaternions[..., :3]
    lengths = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    turns = Rotation.from_quat((quaternions / lengths).reshape(-1, 4))
    return turns.as_rotvec().reshape(*quaternions.shape[:-1], 3)
