"""Fragments of a row of blocks whose joints broke, and the times of breaking."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from jointwave.dem.chunks import LANES
from jointwave.dem.model import State
from jointwave.dem.system import BlockSystem
from jointwave.results.labels import label


def with_breaks(result: xr.Dataset, system: BlockSystem, state: State) -> xr.Dataset:
    """Return a result with its `fragments`, as JSON in an attribute, and the `break_time` of each
    joint, s, nan where it holds, where joints soften."""
    if not system.model.form.parts.softening:
        return result
    blocks, times = system.blocks, break_times(system, state)
    found = fragments(blocks, ~np.isnan(times), state.v[: blocks.count, : blocks.dim])
    joints = ("joint_y", blocks.properties.joint_y, label("joint_y"))
    result = result.assign_attrs(fragments=json.dumps(found)).assign_coords(joint_y=joints)
    return result.assign(break_time=("joint_y", times, label("break_time")))


def break_times(system: BlockSystem, state: State) -> np.ndarray:
    """Return when the joints of a row broke [N - 1], s, nan where they hold. A joint is broken when
    all its contact points are."""
    form, chunks, time = system.model.form, system.model.chunks, system.time
    rows, place = form.history, chunks.place[: system.blocks.count - 1]
    points = rows.point + rows.point_rows * np.arange(form.points) + place[:, None] % LANES
    own = state.history[place // LANES]
    opening, whole = (
        np.take_along_axis(own, points + row, axis=1) for row in (rows.opening, rows.whole)
    )
    limit = np.broadcast_to(system.blocks.properties.critical_opening, place.shape)
    steps = np.where((opening >= limit[:, None]).all(axis=1), whole.max(axis=1), np.inf)
    return np.where(steps <= time.steps, time.dt * steps, np.nan)


def fragments(blocks: Any, broken: np.ndarray, velocity: np.ndarray) -> list[dict[str, Any]]:
    """Return the fragments of a row between its broken joints (bool array [N - 1]), from the start
    on; velocity : of every block [N, d], m/s.

    Each has `from_y` and `to_y` (m, in the unloaded pillar), `mass` (kg) and `velocity` (m/s), of
    its centre of mass: a number along y or three components.
    """
    first = np.concatenate([[0], np.flatnonzero(broken) + 1])
    edges = blocks.properties.contact_y[np.append(first, blocks.count)]
    masses = blocks.inertia[:, :1]
    mass, momentum = (np.add.reduceat(x, first) for x in (masses, masses * velocity))
    mean = (momentum / mass).squeeze(axis=1) if blocks.dim == 1 else momentum / mass
    values = edges[:-1].tolist(), edges[1:].tolist(), mass[:, 0].tolist(), mean.tolist()
    names = "from_y", "to_y", "mass", "velocity"
    return [dict(zip(names, one, strict=True)) for one in zip(*values, strict=True)]
