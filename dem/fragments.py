"""Fragments of a row of blocks whose joints broke, and the times of breaking."""

import json
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import Properties
from jointwave.results.labels import label


def fragments(p: Properties, broken: np.ndarray, velocity: np.ndarray) -> list[dict[str, Any]]:
    """Return the fragments of a row between its broken joints, from the start on.

    Parameters
    ----------
    broken : bool array [N - 1], the joints that have no tensile strength left.
    velocity : float array [N] along y, or [N, 3] along x, y, z, of every block, m/s.

    Each piece has `from_y` and `to_y` (m, in the unloaded pillar), `mass` (kg) and `velocity`
    (m/s), of its centre of mass: a number along y or three components.
    """
    edges = np.concatenate([[0], np.flatnonzero(broken) + 1, [p.block_count]])
    masses, y = p.masses, p.contact_y.tolist()
    weights = np.ones(p.block_count) if masses is None else masses
    sums = np.add.reduceat((weights * velocity.T).T, edges[:-1], axis=0)
    means = (sums.T / np.add.reduceat(weights, edges[:-1])).T
    return [
        {
            "from_y": y[first],
            "to_y": y[last],
            "mass": p.block_mass * (last - first) if masses is None else sum(masses[first:last]),
            "velocity": mean,
        }
        for first, last, mean in zip(
            edges[:-1].tolist(), edges[1:].tolist(), means.tolist(), strict=True
        )
    ]


def with_fragments(
    result: xr.Dataset,
    p: Properties,
    broken: np.ndarray,
    velocity: np.ndarray,
    break_time: np.ndarray | None = None,
) -> xr.Dataset:
    """Return a result with its `fragments`, as JSON in an attribute, and `break_time`.

    break_time : float array [N - 1], s, nan where a joint holds; None where it is not known.
    """
    found = result.assign_attrs(fragments=json.dumps(fragments(p, broken, velocity)))
    if break_time is None:
        return found
    found = found.assign_coords(joint_y=("joint_y", p.joint_y, label("joint_y")))
    return found.assign(break_time=("joint_y", break_time, label("break_time")))
