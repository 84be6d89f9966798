"""Blocks ready to run."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.sampling import Clock
from jointwave.dem.loads import Loads
from jointwave.dem.model import Model
from jointwave.dem.shaking import Shaking


class Static(NamedTuple):
    """How a static state is sought.

    placed : displacement [N, F] under the weight if all joints were elastic; None where that is not
    known beforehand. pressed : the largest force of the prestress, N. steps : at most.
    """

    placed: np.ndarray | None
    pressed: float
    steps: int


class BlockSystem(NamedTuple):
    """Blocks ready to run.

    blocks : `build.RigidBlocks` of a rock mass or of a pillar. receivers : what is recorded. loads
    : what acts on held blocks. resistance : of the quiet sides of a rock mass, as
    `boundaries.dashpots` has it [h, d + d^2, d + d^2]. bearing : the same of unit dashpots where
    sides that waves pass bear the weight. shaking : the motion of walls; None where none moves.
    threads : that share each step.
    """

    blocks: Any
    time: Clock
    critical: float
    model: Model
    receivers: Any
    loads: Loads
    resistance: Any
    bearing: np.ndarray
    shaking: Shaking | None
    threads: int
    static: Static
