"""Snapshots of the whole body: their common form, recording, and storage in results."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.size import LARGEST_VARIABLE
from jointwave.results.arrays import copied
from jointwave.results.dataset import labelled
from jointwave.results.stress import stress_components

AXES = {1: [1], 2: [0, 1], 3: [0, 1, 2]}  # of x, y, z, by the number of components
DIMENSIONS = {
    "points": ("node", "component"),
    "cells": ("cell", "corner"),
    "block": ("cell",),
    "displacement": ("field_time", "node", "component"),
    "velocity": ("field_time", "node", "component"),
    "stress": ("field_time", "cell", "stress_component"),
}
OVER_TIME = tuple(name for name, dims in DIMENSIONS.items() if dims[0] == "field_time")


class Snapshots(NamedTuple):
    """The whole body at some instants, on linear cells; blocks share no nodes.

    time : [snapshots], s.
    points : x, y, z of the unloaded body [nodes, 3], m.
    kind : of the cells, in meshio's names: "line", "triangle", "quad", "tetra", "hexahedron".
    cells : int32 [cells, corners], nodes in VTK's order.
    block : int32 [cells], the block of each cell, 0 at the loaded end.
    displacement, velocity : [snapshots, nodes, 3], m and m/s.
    stress : axial [snapshots, cells], Pa, compression positive; of a rock mass the components of
    `stress_components` [snapshots, cells, components]; None if unknown.
    """

    time: np.ndarray
    points: np.ndarray
    kind: str
    cells: np.ndarray
    block: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    stress: np.ndarray | None

    def since(self, first: int) -> "Snapshots":
        """Return the snapshots from `first` on."""
        over_time = {name: getattr(self, name) for name in ("time", *OVER_TIME)}
        return self._replace(**{k: v[first:] for k, v in over_time.items() if v is not None})


#: A snapshot: displacement and velocity of nodes [nodes, d], m and m/s, stress of cells, Pa [cells]
#: or [cells, components], and slip of joints [joints], m.
Frame = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class SnapshotRecorder:
    """Records the body at every `every`-th sample of a run in `frames`."""

    def __init__(
        self,
        scene: AnyScene,
        nodes: int,
        body: tuple[np.ndarray, str, np.ndarray, np.ndarray],
        capture: Callable[[int], Frame],
        joints: np.ndarray | None = None,
    ) -> None:
        """nodes : of a snapshot. body : points [nodes, d], m, and kind, cells and block as in
        `Snapshots`. capture : returns the frame of a sample. joints : ends of joints that show slip
        [joints, 2, d], m; None without. Raises SceneError for too many snapshots."""
        refuse_beyond_room(scene, nodes)
        self.every, self.scene, self.body = samples_between(scene) or 1, scene, body
        self.capture, self.joints = capture, joints
        self.frames: list[Any] = []

    def record_if_due(self, sample: int) -> None:
        """Store a frame of this sample if it is due."""
        if sample % self.every == 0:
            self.frames.append(self.capture(sample))

    def allocate(self, samples: int) -> None:
        """Allocate the frames of this many samples, to be filled by the caller."""
        self.frames[:] = [copied(self.capture(0)) for _ in range(0, samples, self.every)]

    def add_to(self, result: xr.Dataset) -> xr.Dataset:
        """Return a result with its snapshots, of a rock mass with motion relative to the first."""
        time = result["time"].values[:: self.every]
        u, v, stress, slip = (np.stack(x) for x in zip(*self.frames[: len(time)], strict=True))
        if not self.scene.is_column:
            u, slip = u - u[0], slip - slip[0]
        found = with_snapshots(result, snapshots(time, *self.body, u, v, stress))
        if self.joints is None:
            return found
        ends, over_time = ("joint", "end", "component"), ("field_time", "joint")
        slips = {"field_joints": (ends, in_space(self.joints)), "field_slip": (over_time, slip)}
        return found.assign(labelled(slips))


def samples_between(scene: AnyScene) -> int | None:
    """Return the number of samples between snapshots; None if the scene requests none."""
    fields = scene.record.fields
    return None if fields is None else max(1, round(fields / scene.interval))


def snapshots(
    time: np.ndarray,
    points: np.ndarray,
    kind: str,
    cells: np.ndarray,
    block: np.ndarray,
    displacement: np.ndarray,
    velocity: np.ndarray,
    stress: np.ndarray | None = None,
) -> Snapshots:
    """Return snapshots from points and vectors [..., 1 to 3]: along y, along x and y, or all."""
    nodes, of_cells = (np.asarray(one, dtype=np.int32) for one in (cells, block))
    x, moved, moving = map(in_space, (points, displacement, velocity))
    return Snapshots(time, x, kind, nodes, of_cells, moved, moving, stress)


def in_space(values: np.ndarray) -> np.ndarray:
    """Return vectors [..., 3] from vectors [..., 1] along y or [..., 2] along x, y."""
    found = np.zeros((*values.shape[:-1], 3))
    found[..., AXES[values.shape[-1]]] = values
    return found


def refuse_beyond_room(scene: AnyScene, nodes: int) -> None:
    """Raise SceneError if the snapshots of this many nodes would exceed a file's size limit."""
    fields, most = scene.record.fields, LARGEST_VARIABLE // (3 * 8 * nodes)
    count = int(scene.time.duration / scene.interval + 1e-9) // (samples_between(scene) or 1) + 1
    if count > most:
        allowed = f"gives {count:,} snapshots of {nodes:,} nodes; at most {most:,} fit a file"
        raise SceneError(scene.where, "record.fields", fields, allowed)


def with_snapshots(result: xr.Dataset, s: Snapshots) -> xr.Dataset:
    """Return a result with snapshots as variables field_NAME."""
    variables = {
        f"field_{name}": (dimensions[: values.ndim], values)
        for name, dimensions in DIMENSIONS.items()
        if (values := getattr(s, name)) is not None
    }
    coords: dict[str, Any] = {"field_time": ("field_time", s.time)}
    coords["component"] = "component", list("xyz")
    if s.stress is not None and s.stress.ndim == 3:
        names = list(stress_components(2 if s.stress.shape[2] == 3 else 3))
        coords["stress_component"] = ("stress_component", names)
    found = result.assign(labelled(variables)).assign_coords(labelled(coords))
    found["field_cells"].attrs["kind"] = s.kind
    return found


def snapshots_of(result: xr.Dataset) -> Snapshots | None:
    """Return the snapshots of a result; None if it has none."""
    if "field_cells" not in result:
        return None
    held = (result.get(f"field_{name}") for name in Snapshots._fields)
    arrays: Any = [None if one is None else one.values for one in held]
    return Snapshots(*arrays)._replace(kind=result["field_cells"].attrs["kind"])
