"""Blocks ready to run."""

from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.sampling import Clock
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import Model, Samples, State, samples_for
from jointwave.dem.sides.loads import Loads
from jointwave.dem.sides.shaking import Shaking
from jointwave.results.arrays import copied


class BlockSystem(NamedTuple):
    """Blocks ready to run.

    loads : forces on held blocks. resistance : of the dashpots on sides and ends
    [h, d + d^2, d + d^2], see `boundaries.dashpots`. bearing : the same for the springs by which
    sides bear the weight until it is at rest. shaking : motion of walls; None where none moves.
    threads : their number.
    """

    blocks: Any
    time: Clock
    model: Model
    loads: Loads
    resistance: np.ndarray
    bearing: np.ndarray
    shaking: Shaking | None
    threads: int

    def sampled(
        self, state: State, sample: int, places: np.ndarray, watched: np.ndarray
    ) -> Samples:
        """Return one sample of blocks [r] and contacts [w], by a step with a copy of the state."""
        model, step = self.model._replace(places=places, watched=watched), sample * self.time.stride
        found, steps = samples_for(model, 1), np.array([step])
        drive = None if model.held is None else self.loads.drive(steps)
        shake = None if self.shaking is None else self.shaking(steps)
        march(model, copied(state), found, 1, (0, 1), drive, shake)
        return found
