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

    loads : what acts on held blocks. resistance : of the dashpots on
    sides and ends, as `boundaries.dashpots` has it [h, d + d^2, d + d^2]. bearing : the same of
    unit dashpots where these bear the weight. shaking : the motion of walls; None where none moves.
    threads : that share each step.
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
        """Return one sample of blocks [r] and contacts [w], by the step that it needs, on a copy of
        the state."""
        model, step = self.model._replace(places=places, watched=watched), sample * self.time.stride
        found, steps = samples_for(model, 1), np.array([step])
        drive = None if model.held is None else self.loads.drive(steps)
        shake = None if self.shaking is None else self.shaking(steps)
        march(model, copied(state), found, 1, (0, 1), drive, shake)
        return found
