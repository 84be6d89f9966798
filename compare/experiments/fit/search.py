"""The search of a fit: nonlinear least squares, each waveform weighted by its own noise."""

from operator import attrgetter
from typing import Any

import numpy as np

from cases.errors import StoppedError
from compare.engines import Progress
from compare.experiments.fit.keys import Free
from compare.experiments.fit.problem import Measured, Problem
from compare.experiments.fit.statistics import deviations

MOST = 60  # steps of a search, each with its derivatives
TOLERANCE = 1e-12  # of the squares, the unknowns and the gradient
POOR = 0.2  # misfit above which other starts are tried
FACTORS = 10.0 ** np.arange(-2.0, 2.1, 0.5)  # on a start, for other starts
OTHERS = 2  # number of best other starts used
LEAST_WEIGHT = 0.01  # of the largest relative noise: lower limit of a waveform's noise


class FitSearch:
    """A least-squares search in the unknowns of some keys, with weights by waveform."""

    def __init__(self, problem: Problem, keys: list[Free], progress: Progress | None) -> None:
        self.problem, self.keys, self.progress = problem, keys, progress
        self.trials = self.refused = 0
        self._known: dict[bytes, list[np.ndarray] | None] = {}
        self.weights = [1 / m.size / np.sqrt(len(m.time)) for m in problem.measured]
        self.low = np.array([-np.inf if k.low == -np.inf else k.unknown(k.low) for k in keys])
        self.high = np.array([np.inf if k.high == np.inf else k.unknown(k.high) for k in keys])
        self.start = np.zeros(len(keys))
        begun = self.residuals(self.start)
        assert begun is not None  # it was solved before
        self.begun = begun

    def values(self, x: np.ndarray) -> list[float]:
        """Return the keys' values for unknowns [p]."""
        return [key.value(u) for key, u in zip(self.keys, x, strict=True)]

    def residuals(self, x: np.ndarray) -> list[np.ndarray] | None:
        """Return solution minus measurement of each waveform [n], SI; None without a solution.

        A search begins and ends where others and the statistics need the same solutions: each is
        found once.
        """
        self.trials += 1
        if (at := x.tobytes()) not in self._known:
            values = {k.key: v for k, v in zip(self.keys, self.values(x), strict=True)}
            self._known[at] = self.problem.residual(values)
        found = self._known[at]
        self.refused += found is None
        if self.progress:
            self.progress(1 - 0.97**self.trials)  # the number of trials is unknown
        return found

    def jacobians(self, x: np.ndarray) -> list[np.ndarray]:
        """Return the derivatives of each waveform [n, p]: central, or one-sided at a limit."""
        columns = [self._derivative(x, i) for i in range(len(x))]
        return [np.stack(parts, axis=1) for parts in zip(*columns, strict=True)]

    def _derivative(self, x: np.ndarray, i: int) -> list[np.ndarray]:
        ends: list[tuple[float, list[np.ndarray] | None]] = []
        for sign in (-1, 1):
            there = x.copy()
            there[i] = np.clip(x[i] + sign * self.problem.step, self.low[i], self.high[i])
            found = self.residuals(there) if there[i] != x[i] else None
            ends.append((x[i], None) if found is None else (there[i], found))
        if ends[0][1] is None or ends[1][1] is None:
            here = self.residuals(x)
            ends = [(u, here if r is None else r) for u, r in ends]
        (a, low), (b, high) = ends
        if low is None or high is None or a == b:
            raise StoppedError("fit: no solution near the current values")
        return [(after - before) / (b - a) for before, after in zip(low, high, strict=True)]

    def _weighed(self, parts: list[np.ndarray]) -> np.ndarray:
        return np.concatenate([w * part for w, part in zip(self.weights, parts, strict=True)])

    def run(self, start: np.ndarray) -> Any:
        """Return the result of `scipy.optimize.least_squares` from a start."""
        from scipy.optimize import least_squares

        def squares(x: np.ndarray) -> np.ndarray:
            found = self.residuals(x)
            missing = sum(len(m.time) for m in self.problem.measured)
            return np.full(missing, np.inf) if found is None else self._weighed(found)

        return least_squares(
            squares,
            start,
            jac=lambda x: self._weighed(self.jacobians(x)),
            bounds=(self.low, self.high),
            method="trf",
            x_scale="jac",
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=MOST,
        )

    def best(self) -> np.ndarray:
        """Return the best unknowns, also from other starts if the fit is poor; raises StoppedError
        if no search has converged."""
        found = [self.run(self.start)]
        if self._misfit(found[0].x) > POOR:
            found += [self.run(start) for start in self._other_starts()]
        converged = [one for one in found if one.success]
        if not converged:
            values = self.values(min(found, key=attrgetter("cost")).x)
            at = ", ".join(f"{k.key} = {v:.6g}" for k, v in zip(self.keys, values, strict=True))
            raise StoppedError(
                f"fit: not converged after {self.trials} solutions, at {at}: start closer "
                "(--free KEY=START), bound the keys, or free fewer"
            )
        best = min(converged, key=attrgetter("cost")).x
        if len(self.weights) == 1:
            return best
        self._weigh_by_noise(best)
        again = self.run(best)
        return again.x if again.success else best

    def _weigh_by_noise(self, x: np.ndarray) -> None:
        """Weight each waveform by its residual, as the noise of its gauge."""
        found = self.residuals(x)
        assert found is not None
        sizes = [m.size for m in self.problem.measured]
        noise = [d / s for d, s in zip(deviations(found, len(x)), sizes, strict=True)]
        least = LEAST_WEIGHT * max(noise)
        if least > 0:
            relative = [max(n, least) / max(noise) for n in noise]
            self.weights = [w / r for w, r in zip(self.weights, relative, strict=True)]

    def _misfit(self, x: np.ndarray) -> float:
        found = self.residuals(x)
        return np.inf if found is None else max(misfits(found, self.problem.measured))

    def _other_starts(self) -> list[np.ndarray]:
        """Return the best starts among those with one key multiplied by a factor."""
        starts: list[tuple[float, int, np.ndarray]] = []
        for i, key in enumerate(self.keys):
            for factor in FACTORS if key.logarithmic else ():
                x = self.start.copy()
                x[i] = np.clip(np.log(factor), self.low[i], self.high[i])
                starts.append((self._misfit(x), len(starts), x))
        return [x for misfit, _, x in sorted(starts)[:OTHERS] if np.isfinite(misfit)]


def misfits(residuals: list[np.ndarray], measured: list[Measured]) -> list[float]:
    """Return the relative L2 misfit of each waveform, of the measured motion."""
    return [
        float(np.sqrt(np.mean(r**2))) / m.size for r, m in zip(residuals, measured, strict=True)
    ]
