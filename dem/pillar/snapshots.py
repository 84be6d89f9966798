"""Snapshots of rigid blocks: hexahedra that move by the blocks' displacement and rotation."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.loads import with_load_itself
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.results.snapshots import SnapshotRecorder, in_space, snapshots, with_snapshots
from jointwave.results.subcells import CORNERS

CORNERS_OF_A_BLOCK = 8


class BlockFrame(NamedTuple):
    """All blocks and contacts at one instant, in the freedoms of the engine.

    stress : float array [N + 1], of contacts 0 .. N, Pa.
    displacement, velocity : float arrays [N, freedoms], m and m/s: 1, along y; 3, along x, y, z; 6,
        with rotation vectors (rad) and their rates; 7 and 6, with the quaternion, scalar last, and
        the angular momentum (kg m2/s).
    """

    stress: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray


class BlockRecorder(SnapshotRecorder):
    """The blocks at every snapshot of a scene; raises SceneError for too many.

    step : s, over which the load is a mean; None where it is not.
    """

    def __init__(
        self, scene: Scene, p: Properties, capture: Callable[[int], BlockFrame], step: float | None
    ) -> None:
        super().__init__(scene, CORNERS_OF_A_BLOCK * p.block_count, capture)
        self.scene, self.p, self.step = scene, p, step

    def add_to(self, result: xr.Dataset) -> xr.Dataset:
        """Return the run's result with its snapshots."""
        time, count = result["time"].values[:: self.every], self.p.block_count
        corners, centres = corners_of(self.p), np.zeros((count, 1, 3))
        centres[:, 0, 1] = self.p.centre_y
        frames = self.frames[: len(time)]
        motion = [corner_motion(frame, corners, self.p) for frame in frames]
        u, v = (np.stack(x) for x in zip(*motion, strict=True))
        u, v = (x.reshape(len(time), -1, 3) for x in (u, v))
        stress = np.stack([frame.stress for frame in frames])
        if self.step is not None:
            y = self.p.contact_y
            contacts = interpolation(y, y.tolist())
            stress = with_load_itself(stress.T, self.scene, contacts, time, self.step).T
        found = snapshots(
            time,
            (centres + corners).reshape(-1, 3),
            "hexahedron",
            np.arange(count * CORNERS_OF_A_BLOCK).reshape(count, -1),
            np.arange(count),
            u,
            v,
            (stress[:, :-1] + stress[:, 1:]) / 2,
        )
        return with_snapshots(result, found)


def corners_of(p: Properties) -> np.ndarray:
    """Return the corners of blocks from their centroids, m, in VTK's order: [8, 3] of all, or [N,
    8, 3] where they differ."""
    unit = np.array(CORNERS["hexahedron"]) - 0.5
    if p.masses is None:
        return unit * [p.side, p.spacing, p.side]
    sides = np.stack(np.broadcast_arrays(p.side, np.diff(p.contact_y), p.side), axis=-1)
    return unit * sides[:, None]


def corner_motion(
    frame: BlockFrame, corners: np.ndarray, p: Properties
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement (m) and velocity (m/s) of every block's corners, each [N, 8, 3]."""
    freedoms = frame.displacement.shape[1]
    along = slice(min(freedoms, 3))
    u, v = (in_space(x[:, along])[:, None] for x in (frame.displacement, frame.velocity))
    u, v = (np.broadcast_to(x, (len(x), *corners.shape[-2:])) for x in (u, v))
    if freedoms == 6:
        turn, spin = frame.displacement[:, None, 3:], frame.velocity[:, None, 3:]
        return u + np.cross(turn, corners), v + np.cross(spin, corners)
    if freedoms == 7:
        turn = frame.displacement[:, None, 3:]
        arms = corners + turning(turn, corners)
        return u + turning(turn, corners), v + np.cross(spin_of(turn, frame.velocity, p), arms)
    return u, v


def turning(quaternion: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Return what unit quaternions [..., 4], scalar last, add to vectors [..., 3] that they turn.

    Rr - r = 2 q x (q x r + w r), which keeps the digits of small turns.
    """
    q, w = quaternion[..., :3], quaternion[..., 3:]
    return 2 * np.cross(q, np.cross(q, r) + w * r)


def spin_of(turn: np.ndarray, velocity: np.ndarray, p: Properties) -> np.ndarray:
    """Return the angular velocities [N, 1, 3], rad/s, of angular momenta velocity[:, 3:]."""
    momentum, back = velocity[:, None, 3:], turn * [-1, -1, -1, 1]
    own = momentum + turning(back, momentum)
    own = own / [p.inertia_across, p.inertia_along, p.inertia_across]
    return own + turning(turn, own)
