"""What is recorded of rigid blocks, as `dem.receivers` and `dem.record` take it."""

from __future__ import annotations

import numpy as np

from jointwave.cases.geometry.measure import Outlines
from jointwave.cases.partition.shape import shape_of
from jointwave.dem.build import faces_of
from jointwave.dem.leapfrog import march
from jointwave.dem.model import Samples, State, samples_for
from jointwave.dem.receivers import Receivers, everywhere
from jointwave.dem.record import jumps, mean_stress, quantities
from jointwave.dem.snapshots import BlockFrame, BlockRecorder
from jointwave.dem.system import BlockSystem
from jointwave.results.arrays import copied


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
    receivers = everywhere(cut.volume, faces_of(system.blocks))
    model = system.model._replace(places=receivers.places, watched=receivers.watched)

    def capture(sample: int) -> BlockFrame:
        """Return all blocks by a sample with the step that it needs, on a copy of the state."""
        step = sample * system.time.stride
        drive = None if model.held is None else system.loads.drive(np.array([step]))
        shake = None if system.shaking is None else system.shaking(np.array([step]))
        found = samples_for(model, 1)
        march(model, copied(state), found, 1, (0, 1), drive, shake)
        outside = acting(system, receivers, found.velocity, sample)
        stress = mean_stress(receivers, found.contact, outside)
        slip = jumps(receivers, found.contact)
        moved, moving = found.displacement[..., 0], found.velocity[..., 0]
        return BlockFrame(moved, moving, stress[:, 0], slip[:, 0, 1])

    if system.blocks.dim == 2:
        partition = system.blocks.partition
        owner, pieces = receivers.places, Outlines(partition.corners, partition.first)
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
