"""A look at all blocks of a row in space at once."""

from collections.abc import Callable

import numpy as np

from cases.material.calibrate import Properties
from cases.sampling import Interpolation
from dem.snapshots import Shot
from dem.spatial.build import build_receivers, room_for, samples_for
from dem.spatial.model import Model, State
from dem.spatial.threads import marcher
from results.arrays import copied


def shooter(p: Properties, model: Model, state: State, threads: int) -> Callable[[int], Shot]:
    """Return what takes a sample of all contacts and blocks, on a copy of the state.

    A velocity at a whole step needs the step, as it does at the receivers.
    """
    receivers = build_receivers(_all(p.block_count + 1), _all(p.block_count))

    def shoot(sample: int) -> Shot:
        n = sample * model.stride
        # Samples are the steps that the stride divides: step 0, and step n as number 1.
        everywhere = model._replace(receivers=receivers, stride=max(n, 1))
        twin, found = copied(state), samples_for(everywhere, 2)
        marcher(everywhere, twin, room_for(everywhere, threads), found)(n, n + 1)
        force, velocity, displacement = (x[..., min(n, 1)] for x in found[:3])
        return Shot(force[:, 1] / p.area, displacement, velocity)

    return shoot


def _all(count: int) -> Interpolation:
    """Return how every place is read by itself."""
    return Interpolation(np.arange(count), np.arange(0), np.zeros(count))
