"""Snapshots of rigid blocks: their polygons, or the faces of their polyhedra, in triangles that
move with the blocks."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.measure import Outlines
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.boundaries import freedoms
from jointwave.results.snapshots import (
    SnapshotRecorder,
    in_space,
    snapshots,
    with_slip,
    with_snapshots,
)


class BlockFrame(NamedTuple):
    """All blocks at one instant: displacement and velocity [N, F], m and m/s, rad and rad/s, mean
    stress [N, components], Pa, and the slip of contacts, m."""

    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray
    slip: np.ndarray


class BlockRecorder(SnapshotRecorder):
    """The blocks at every snapshot of a scene; raises SceneError for too many.

    pieces : of planes, with the block of each [n]: in the plane the blocks, in space their faces.
    """

    def __init__(
        self,
        scene: RockMass,
        blocks: Blocks,
        pieces: Outlines,
        owner: np.ndarray,
        capture: Callable[[int], BlockFrame],
    ) -> None:
        super().__init__(scene, len(pieces.corners), capture)
        self.blocks, self.points = blocks, pieces.corners
        self.joints = np.flatnonzero(blocks.contacts.of_joints(len(scene.joint_sets)))
        self.owner = np.repeat(owner, np.diff(pieces.first))
        self.cells, piece = triangles(pieces)
        self.block = owner[piece]

    def add_to(self, result: xr.Dataset) -> xr.Dataset:
        """Return the run's result with its snapshots; displacement and slip count from the first.

        The slip of joints is shown in the plane alone."""
        time = result["time"].values[:: self.every]
        u, v, stress, slip = (np.stack(x) for x in zip(*self.frames[: len(time)], strict=True))
        arms = self.points - self.blocks.centroid[self.owner]
        moved, moving = (corner_motion(x, self.owner, arms) for x in (u - u[0], v))
        own = stress[:, self.block]
        cells = self.points, "triangle", self.cells, self.block
        found = with_snapshots(result, snapshots(time, *cells, moved, moving, own))
        if arms.shape[1] > 2:
            return found
        corners = self.blocks.contacts.outlines.corners.reshape(-1, 2, 2)
        return with_slip(found, in_space(corners[self.joints]), (slip - slip[0])[:, self.joints])


def triangles(pieces: Outlines) -> tuple[np.ndarray, np.ndarray]:
    """Return triangles between the first corner of each piece and each of its edges that are not at
    it [cells, 3], and the piece of each [cells]."""
    first = pieces.first
    piece = np.repeat(np.arange(len(first) - 1), np.diff(first))
    corner = np.arange(len(piece))
    at = corner[(corner > first[piece]) & (corner < first[piece + 1] - 1)]
    return np.stack([first[piece[at]], at, at + 1], axis=1), piece[at]


def corner_motion(motion: np.ndarray, owner: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Return the motion of corners [..., k, d] of that of blocks [..., N, F].

    owner : the block of each corner [k]. arms : from its centroid [k, d], m.
    """
    dim = arms.shape[1]
    moved = motion @ freedoms(dim, motion.shape[-1] - dim)
    gradient = moved[..., owner, dim:].reshape(*moved.shape[:-2], len(owner), dim, dim)
    return moved[..., owner, :dim] + np.einsum("ki,...kij->...kj", arms, gradient)
