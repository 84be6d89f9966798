"""Newton's method."""

from collections.abc import Callable
from math import inf, isfinite
from typing import NamedTuple

import numpy as np

from jointwave.continuum.implicit.vectors import largest
from jointwave.continuum.parallel.serial import SERIAL, Serial

MOST_ITERATIONS = 12


class Outcome(NamedTuple):
    """x : the last iterate. converged : whether it is a solution. errors : largest residual of
    every iterate, the start first; tolerance : that of the last one."""

    x: np.ndarray
    converged: bool
    errors: list[float]
    tolerance: float


def newton(
    residual: Callable[[np.ndarray], tuple[np.ndarray, float]],
    correction: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    communicator: Serial = SERIAL,
) -> Outcome:
    """Return the solution by Newton's method from a start, after at least one correction.

    Without any motion no correction is made.

    Parameters
    ----------
    residual : function of x that returns the residual and what of it may be left.
    correction : function of a residual that returns by what to move the last x.
    communicator : the processes that each have a part of x; all come to the same end.
    """
    x, errors, tolerance = start.copy(), [], 0.0
    for _ in range(MOST_ITERATIONS + 1):
        rest, left = residual(x)
        errors.append(communicator.largest(_size(rest)))
        tolerance = communicator.largest(left)
        if not isfinite(errors[-1]):
            break
        if errors[-1] == 0 or (len(errors) > 1 and errors[-1] <= tolerance):
            return Outcome(x, True, errors, tolerance)
        if len(errors) > MOST_ITERATIONS:
            break
        x += correction(rest)
    return Outcome(x, False, errors, tolerance)


def _size(values: np.ndarray) -> float:
    """Return the largest magnitude; infinite if any is NaN."""
    found = largest(values)
    return found if isfinite(found) else inf
