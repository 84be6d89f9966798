"""Snapshots of rigid blocks in the plane: polygons, in triangles, that move with their blocks."""

from __future__ import annotations

import numpy as np
import xarray as xr

from jointwave.cases.partition.blocks import Partition
from jointwave.dem.blocks.leapfrog import march, samples_for
from jointwave.dem.blocks.model import PlaneState
from jointwave.dem.blocks.receivers import BlockReceivers
from jointwave.dem.blocks.record import across_joint, mean_stress, tractions
from jointwave.dem.blocks.system import PlaneSystem
from jointwave.results.arrays import copied
from jointwave.results.snapshots import (
    SnapshotRecorder,
    in_space,
    snapshots,
    with_slip,
    with_snapshots,
)


class PlaneRecorder(SnapshotRecorder):
    """The blocks at every snapshot of a scene; raises SceneError for too many."""

    def __init__(self, system: PlaneSystem, state: PlaneState) -> None:
        self.system, self.partition = system, system.blocks.partition
        everywhere = _everywhere(system)
        model = system.model._replace(places=everywhere.places, watched=everywhere.watched)

        def capture(sample: int) -> tuple[np.ndarray, ...]:
            """Return displacement and velocity of all blocks [N, 3], m and m/s, rad and rad/s,
            their stress [N, 3], Pa, and the slip of contacts, m, by a sample with the step that it
            needs, on a copy of the state."""
            step = sample * system.time.stride
            drive = None if model.held is None else system.sources.drive(step, step + 1)
            shake = None if system.shaking is None else system.shaking(np.array([step]))
            found = samples_for(model, 1)
            march(model, copied(state), found, 1, (0, 1), drive, shake)
            stress = mean_stress(system, everywhere, found.velocity, found.contact, sample)
            traction = tractions(system.blocks.links, everywhere, found.contact)
            slip = across_joint(system, everywhere, found.contact, traction, 1)
            return found.displacement[..., 0], found.velocity[..., 0], stress[:, 0], slip[:, 0]

        super().__init__(system.blocks.scene, len(self.partition.corners), capture)

    def add_to(self, result: xr.Dataset) -> xr.Dataset:
        """Return the run's result with its snapshots; displacement counts from the first."""
        time = result["time"].values[:: self.every]
        u, v, stress, slip = (np.stack(x) for x in zip(*self.frames[: len(time)], strict=True))
        cells, block = triangles(self.partition)
        moved, moving = (corner_motion(self.partition, x) for x in (u - u[0], v))
        corners = self.partition.corners
        found = snapshots(time, corners, "triangle", cells, block, moved, moving, stress[:, block])
        contacts = self.partition.contacts
        joints = np.flatnonzero(contacts.of_joints(len(self.partition.joint_sets)))
        ends = in_space(np.stack([contacts.start, contacts.end], axis=1)[joints])
        return with_slip(with_snapshots(result, found), ends, (slip - slip[0])[:, joints])


def _everywhere(system: PlaneSystem) -> BlockReceivers:
    """Return receivers of all blocks, without points."""
    blocks, count = system.blocks.links.blocks, system.blocks.partition.count
    contact, side = np.nonzero(blocks < count)  # others are walls
    touching = np.stack([contact, blocks[contact, side], side], axis=1)
    places, none = np.arange(count), np.zeros((0, 0))
    return BlockReceivers(places, none, none, touching, np.arange(len(blocks)), none)


def triangles(partition: Partition) -> tuple[np.ndarray, np.ndarray]:
    """Return triangles between the first corner of each block and each of its sides that are not
    at it [cells, 3], and the block of each [cells]."""
    first, whose = partition.first, partition.owner
    corner = np.arange(len(whose))
    inner = (corner > first[whose]) & (corner < first[whose + 1] - 1)
    at = corner[inner]
    return np.stack([first[whose[at]], at, at + 1], axis=1), whose[at]


def corner_motion(partition: Partition, motion: np.ndarray) -> np.ndarray:
    """Return the motion of all corners [..., k, 2] of that of the blocks [..., N, 3]."""
    whose = partition.owner
    arm = partition.corners - partition.centroid[whose]
    own = motion[..., whose, :]
    return own[..., :2] + own[..., 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
