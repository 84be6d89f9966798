"""Receivers of rigid blocks, as `dem.receivers` and `dem.record` take them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.partition.shape import shape_of
from jointwave.dem.bounds import motion_of_contacts
from jointwave.dem.model import Samples, State
from jointwave.dem.rock_mass.receivers import Receivers, everywhere
from jointwave.dem.rock_mass.record import jumps, mean_stress, quantities
from jointwave.dem.rock_mass.snapshots import BlockFrame, BlockRecorder
from jointwave.dem.system import BlockSystem
from jointwave.numerics.small_motion import Moved, farthest, overlapping
from jointwave.results.rock_mass import rock_mass_dataset


def dataset_of(
    system: BlockSystem, state: State, samples: Samples, count: int, **attributes: Any
) -> xr.Dataset:
    """Return the result of the first `count` samples of a run."""
    return rock_mass_dataset(
        system.blocks.scene,
        "dem",
        system.time.times[:count],
        waveforms(system, samples, count),
        None if samples.energy is None else samples.energy[:, :count],
        scheme="leapfrog",
        left_over=system.blocks.joints.left_over,
        **attributes,
    )


def waveforms(system: BlockSystem, samples: Samples, count: int) -> dict[str, np.ndarray]:
    """Return the first `count` samples of a run by name."""
    displacement, velocity, contact = (x[..., :count] for x in samples[:3])
    receivers = system.receivers
    outside = acting(system, receivers, velocity)
    return quantities(receivers, displacement, velocity, contact, outside)


def recorder(system: BlockSystem, state: State) -> BlockRecorder | None:
    """Return the recorder of snapshots; None without."""
    scene, cut = system.blocks.scene, system.blocks.cut
    if scene.record.fields is None:
        return None
    receivers = everywhere(cut.volume, system.blocks.faces)

    def capture(sample: int) -> BlockFrame:
        """Return all blocks at a sample."""
        found = system.sampled(state, sample, receivers.places, receivers.watched)
        outside = acting(system, receivers, found.velocity, sample)
        stress = mean_stress(receivers, found.contact, outside)
        slip = jumps(receivers, found.contact)
        moved, moving = found.displacement[..., 0], found.velocity[..., 0]
        return BlockFrame(moved, moving, stress[:, 0], slip[:, 0, 1])

    if system.blocks.dim == 2:
        owner, pieces = receivers.places, cut.outlines
    else:
        owner, _, pieces = cut.faces(shape_of(scene.domain).tolerance)
    return BlockRecorder(scene, cut, pieces, owner, capture)


def acting(
    system: BlockSystem, receivers: Receivers, velocity: np.ndarray, first: int = 0
) -> np.ndarray:
    """Return the sums of arm times force of sides and loads on the places [r, d, d, n], N m.

    velocity : of the places [r, F, n]. first : number of the first sample.
    """
    places, loads, count = receivers.places, system.loads, velocity.shape[-1]
    dim, held = system.blocks.dim, np.flatnonzero(np.isin(places, loads.rows))
    found = np.zeros((len(places), dim, dim, count))
    if len(held):
        row = np.searchsorted(loads.rows, places[held])
        steps = system.time.stride * (first + np.arange(count))
        sums = np.moveaxis(loads.resultants(steps, row), 0, -1)
        sums -= system.resistance[row] @ loads.onto.T @ velocity[held]
        found[held] = sums[:, dim:].reshape(len(held), dim, dim, -1)
    return found


def moved_apart(system: BlockSystem, state: State) -> Moved | None:
    """Return the contact that has moved furthest over the size of its smaller block, or in the
    plane blocks that overlap without one; None in a single block."""
    blocks, met, dim = system.blocks, system.blocks.contacts, system.blocks.dim
    count = blocks.count
    if dim == 2 and (overlap := overlapping(blocks.cut, state.u[:count])) is not None:
        return overlap
    if not len(met.blocks):
        return None
    moved = motion_of_contacts(system, state)
    reach = np.sqrt(3 * np.trace(met.spread, axis1=1, axis2=2))  # of a rectangle's corners
    ends = reach * np.linalg.norm(moved[:, dim:], axis=1)
    by = np.hypot(np.abs(moved[:, 0]) + ends, np.linalg.norm(moved[:, 1:dim], axis=1))
    volume = np.append(blocks.cut.volume, np.full(len(met.walls), np.inf))
    size = volume[met.blocks].min(axis=1) ** (1 / dim)
    k = farthest(by, size)
    i, j = met.blocks[k].tolist()
    place = tuple(met.centre[k].tolist())
    return Moved(i, j if j < count else -1, float(by[k]), float(size[k]), place)


def refuse_large_rotation(system: BlockSystem, state: State, t: float) -> None:
    """Do nothing: `moved_apart` sees what rotations do to faces."""
