"""Snapshots of rigid blocks: bodies whose corners move with the blocks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.geometry.measure import Outlines
from jointwave.dem.kernel.model import State
from jointwave.dem.readings.samples import turning, velocity_of
from jointwave.dem.sides.boundaries import freedoms
from jointwave.dem.system import BlockSystem
from jointwave.results.snapshots import (
    SnapshotRecorder,
    in_space,
    snapshots,
    with_slip,
    with_snapshots,
)

if TYPE_CHECKING:
    from jointwave.cases.scene_type import AnyScene


class BlockFrame(NamedTuple):
    """All blocks at one instant: displacement and velocity [N, F], m and m/s, rad and rad/s, with
    finite rotations unit quaternions, scalar last, in the displacement [N, 7]; stress of each, Pa
    [N] or [N, components], and the slip of contacts, m."""

    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray
    slip: np.ndarray


class Bodies(NamedTuple):
    """Bodies of blocks, as snapshots show them.

    corners : float array [k, d], m, of a pillar always in space. arms : from the centroids [k, d],
    m. owner : the block of each [k]. kind, cells, block : as in `results.snapshots`. joints : lines
    whose slip is shown, ends [j, 2, 2], m, and contacts [j]; None without. from_start : whether
    displacement and slip count from the first snapshot.
    """

    corners: np.ndarray
    arms: np.ndarray
    owner: np.ndarray
    kind: str
    cells: np.ndarray
    block: np.ndarray
    joints: tuple[np.ndarray, np.ndarray] | None
    from_start: bool


class BlockRecorder(SnapshotRecorder):
    """The blocks at every snapshot of a scene; raises SceneError for too many."""

    def __init__(
        self, scene: AnyScene, bodies: Bodies, capture: Callable[[int], BlockFrame]
    ) -> None:
        super().__init__(scene, len(bodies.corners), capture)
        self.bodies = bodies

    def add_to(self, result: xr.Dataset) -> xr.Dataset:
        """Return the run's result with its snapshots."""
        time, own = result["time"].values[:: self.every], self.bodies
        u, v, stress, slip = (np.stack(x) for x in zip(*self.frames[: len(time)], strict=True))
        if own.from_start:
            u, slip = u - u[0], slip - slip[0]
        cells = own.corners, own.kind, own.cells, own.block
        moved = corner_motion(u, own.owner, own.arms)
        moving = corner_velocity(u, v, own.owner, own.arms)
        found = with_snapshots(result, snapshots(time, *cells, moved, moving, stress[:, own.block]))
        if own.joints is None:
            return found
        ends, contacts = own.joints
        return with_slip(found, in_space(ends), slip[:, contacts])


def recorder(system: BlockSystem, state: State) -> BlockRecorder | None:
    """Return the recorder of snapshots; None without."""
    blocks = system.blocks
    if blocks.scene.record.fields is None:
        return None
    reads = blocks.receivers.of_all(blocks)

    def capture(sample: int) -> BlockFrame:
        """Return all blocks at a sample."""
        found = system.sampled(state, sample, reads.places, reads.watched)
        stress, slip = reads.shown(system, found, sample)
        moved, moving = found.displacement[..., 0], velocity_of(blocks, found)[..., 0]
        return BlockFrame(moved, moving, stress, slip)

    return BlockRecorder(blocks.scene, blocks.bodies, capture)


def triangles(pieces: Outlines) -> tuple[np.ndarray, np.ndarray]:
    """Return triangles between the first corner of each piece and each of its edges that are not at
    it [cells, 3], and the piece of each [cells]."""
    first = pieces.first
    piece = np.repeat(np.arange(len(first) - 1), np.diff(first))
    corner = np.arange(len(piece))
    at = corner[(corner > first[piece]) & (corner < first[piece + 1] - 1)]
    return np.stack([first[piece[at]], at, at + 1], axis=1), piece[at]


def corner_motion(motion: np.ndarray, owner: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Return the displacement of corners [..., k, d] of that of blocks [..., N, F], or their
    velocity.

    owner : the block of each corner [k]. arms : from its centroid [k, d], m.
    """
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
    """Return the velocity of corners [..., k, d] of displacement and velocity of blocks."""
    if moved.shape[-1] < 7:
        return corner_motion(velocity, owner, arms)
    turned = arms + turning(moved[..., owner, 3:], arms)
    return velocity[..., owner, :3] + np.cross(velocity[..., owner, 3:], turned)
