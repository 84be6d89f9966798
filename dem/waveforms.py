"""Receivers of a rock mass, at points and on joints, in the form of results."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from jointwave.dem.model import Samples, State
from jointwave.dem.outside import acting
from jointwave.dem.receivers import Receivers, everywhere
from jointwave.dem.stress import jumps, mean_stress, quantities
from jointwave.dem.system import BlockSystem
from jointwave.results.rock_mass import rock_mass_dataset


class PointsAndJoints(Receivers):
    """Receivers of a rock mass."""

    def of_all(self, blocks: Any) -> PointsAndJoints:
        """Return receivers of all blocks and contacts."""
        return PointsAndJoints(*everywhere(blocks.cut.volume, blocks.faces))

    def shown(
        self, system: BlockSystem, samples: Samples, sample: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the mean stress of each block in a snapshot, Pa [N, components], and the slip of
        each contact, m."""
        stress = mean_stress(self, samples.contact, moments(self, system, samples, 1, sample))
        return stress[:, 0], jumps(self, samples.contact)[:, 0, 1]

    def dataset(
        self, system: BlockSystem, state: State, samples: Samples, count: int, **attributes: Any
    ) -> xr.Dataset:
        """Return the result of the first `count` samples of a run."""
        displacement, velocity, contact = (x[..., :count] for x in samples[:3])
        outside = moments(self, system, samples, count)
        return rock_mass_dataset(
            system.blocks.scene,
            "dem",
            system.time.times[:count],
            quantities(self, displacement, velocity, contact, outside),
            None if samples.energy is None else samples.energy[:, :count],
            scheme="leapfrog",
            left_over=system.blocks.joints.left_over,
            **attributes,
        )


def moments(
    receivers: Receivers, system: BlockSystem, samples: Samples, count: int, first: int = 0
) -> np.ndarray:
    """Return the sums of arm times force of sides and loads on the places [r, d, d, n], N m."""
    dim, places = system.blocks.dim, receivers.places
    found = acting(system, places, samples, count, first)[:, dim:]
    return found.reshape(len(places), dim, dim, count)
