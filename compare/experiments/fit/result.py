"""The result of a fit: keys with their intervals, and waveforms as measured and as fitted."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cases.kinds import AnyScene
from compare.experiments.fit.keys import CLOCK


class Estimate(NamedTuple):
    """A fitted key: its value, its 95 % interval (infinite if the waveforms do not bound it), and
    its starting value; unit "" for a ratio; at_bound : whether it is at a bound."""

    key: str
    value: float
    low: float
    high: float
    start: float
    unit: str
    at_bound: bool


class Fitted(NamedTuple):
    """One measured waveform [n] and the fitted one at the same times, s on the scene's clock, SI.

    before, after : relative L2 misfit of the motion at the start and at the end. independent :
    number of samples that are independent by the residual's autocorrelation.
    """

    name: str
    place: object
    time: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray
    before: float
    after: float
    independent: float


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    scene : with the fitted keys, else as given. solver : the engine or exact solution.
    estimates : one per key. correlation : [p, p] of the keys. waveforms : both measured and fitted.
    trials : number of solutions of the scene. notes : warnings, one sentence each.
    """

    scene: AnyScene
    solver: str
    estimates: list[Estimate]
    correlation: np.ndarray
    waveforms: list[Fitted]
    trials: int
    notes: list[str]

    @property
    def settings(self) -> list[str]:
        """The fitted keys of the scene as arguments of `--set`."""
        return [f"{e.key}={e.value:.12g}" for e in self.estimates if e.key != CLOCK]

    @property
    def before(self) -> float:
        """Misfit of the worst waveform at the start."""
        return max(one.before for one in self.waveforms)

    @property
    def after(self) -> float:
        """Misfit of the worst waveform at the end."""
        return max(one.after for one in self.waveforms)
