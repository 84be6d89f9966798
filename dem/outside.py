"""What sides, ends and loads do to recorded blocks."""

from __future__ import annotations

import numpy as np

from jointwave.dem.model import Samples
from jointwave.dem.spin import velocity_of
from jointwave.dem.system import BlockSystem


def acting(
    system: BlockSystem,
    places: np.ndarray,
    samples: Samples,
    count: int,
    first: int = 0,
    chosen: np.ndarray | None = None,
) -> np.ndarray:
    """Return the resultants of sides, ends and loads on recorded blocks [r, d + d^2, n], N and N m,
    as `dem.boundaries` has them, but of the springs of ends the force alone.

    places : the blocks that the samples are of. first : number of the first sample. chosen : which
    of the places; absent: all.
    """
    loads, blocks, model = system.loads, system.blocks, system.model
    chosen = np.arange(len(places)) if chosen is None else chosen
    found = np.zeros((len(chosen), loads.onto.shape[1], count))
    acted = np.flatnonzero(np.isin(places[chosen], loads.rows))
    if not len(acted):
        return found
    own = chosen[acted]
    row = np.searchsorted(loads.rows, places[own])
    steps = system.time.stride * (first + np.arange(count))
    read = Samples(samples.displacement[own], samples.velocity[own], samples.contact, None)
    velocity = velocity_of(blocks, read, places[own])[..., :count]
    sums = np.moveaxis(loads.resultants(steps, row), 0, -1)
    sums -= system.resistance[row] @ loads.onto.T @ velocity
    if samples.closure is not None:
        pushed = model.held.springs[row, 2] @ samples.closure[row, :, :count]
        sums[:, : blocks.dim] -= pushed[:, : blocks.dim]
    found[acted] = sums
    return found
