"""Snapshots of rigid blocks: bodies whose corners move with the blocks."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.measure import Outlines
from jointwave.dem.kernel.model import State
from jointwave.dem.readings.samples import turning, velocity_of
from jointwave.dem.sides.boundaries import freedoms
from jointwave.dem.system import BlockSystem
from jointwave.results.snapshots import Frame, SnapshotRecorder, in_space


class Bodies(NamedTuple):
    """Bodies of blocks for snapshots.

    corners : [k, d], m, of a pillar always in space. kind, cells, block : as in
    `results.snapshots`. owner : the block of each corner [k]. arms : corners from the block's
    centroid [k, d], m. joints : lines of slip, ends [j, 2, 2], m, and contacts [j]; None without.
    """

    corners: np.ndarray
    kind: str
    cells: np.ndarray
    block: np.ndarray
    owner: np.ndarray
    arms: np.ndarray
    joints: tuple[np.ndarray, np.ndarray] | None

    def frame(self, u: np.ndarray, v: np.ndarray, stress: np.ndarray, slip: np.ndarray) -> Frame:
        """Return a snapshot.

        u, v : displacement and velocity of blocks [N, F]; with finite rotations u [N, 7] ends with
        unit quaternions, scalar last. stress : [N] or [N, components], Pa. slip : of contacts, m.
        """
        moved = corner_motion(u, self.owner, self.arms)
        moving = corner_velocity(u, v, self.owner, self.arms)
        shown = np.zeros(0) if self.joints is None else slip[self.joints[1]]
        return moved, moving, stress[self.block], shown


def recorder(system: BlockSystem, state: State) -> SnapshotRecorder | None:
    """Return the recorder of snapshots, or None; raises SceneError for too many."""
    blocks = system.blocks
    if blocks.scene.record.fields is None:
        return None
    reads, bodies = blocks.receivers.of_all(blocks), blocks.bodies

    def capture(sample: int) -> Frame:
        found = system.sampled(state, sample, reads.places, reads.watched)
        moved, moving = found.displacement[..., 0], velocity_of(blocks, found)[..., 0]
        return bodies.frame(moved, moving, *reads.shown(system, found, sample))

    joints = None if bodies.joints is None else bodies.joints[0]
    return SnapshotRecorder(blocks.scene, len(bodies.corners), bodies[:4], capture, joints)


def triangles(pieces: Outlines) -> tuple[np.ndarray, np.ndarray]:
    """Return polygons as fans of triangles about their first corners [cells, 3], and the polygon of
    each triangle [cells]."""
    first = pieces.first
    piece = np.repeat(np.arange(len(first) - 1), np.diff(first))
    corner = np.arange(len(piece))
    at = corner[(corner > first[piece]) & (corner < first[piece + 1] - 1)]
    return np.stack([first[piece[at]], at, at + 1], axis=1), piece[at]


def corner_motion(motion: np.ndarray, owner: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Return corner displacements [..., k, d] from block displacements [..., N, F], m, or
    velocities from velocities; owner, arms : as in `Bodies`."""
    dim = arms.shape[1]
    if motion.shape[-1] == 1:
        motion = in_space(motion)
    if motion.shape[-1] == 7:
        return motion[..., owner, :3] + turning(motion[..., owner, 3:], arms)
    moved = motion @ freedoms(dim, motion.shape[-1] - dim)
    gradient = moved[..., owner, dim:].reshape(*moved.shape[:-2], len(owner), dim, dim)
    return moved[..., owner, :dim] + np.einsum("ki,...kij->...kj", arms, gradient)


def corner_velocity(
    moved: np.ndarray, velocity: np.ndarray, owner: np.ndarray, arms: np.ndarray
) -> np.ndarray:
    """Return corner velocities [..., k, d] from block displacements and velocities."""
    if moved.shape[-1] < 7:
        return corner_motion(velocity, owner, arms)
    turned = arms + turning(moved[..., owner, 3:], arms)
    return velocity[..., owner, :3] + np.cross(velocity[..., owner, 3:], turned)
