"""The critical step of leapfrog with dashpots at extrapolated rates.

The rate at step n is (3 r[n-1/2] - r[n-3/2]) / 2: second order and explicit. The first mode to grow
alternates its sign at each step, where that rate is 4 u[n] / dt. So the step is critical when the
largest eigenvalue of M^-1 (dt^2 K + 4 dt C) is 4: dt = sqrt(4 eta^2 + 4 / omega^2) - 2 eta for one
mode. By the Jury conditions of the cubic characteristic polynomial it is the first to grow.
"""

from collections.abc import Callable
from math import sqrt


def critical_step(largest: Callable[[float, float], float], damped: bool) -> float:
    """Return the critical step, s.

    largest : function of (a, b) that returns the largest eigenvalue of M^-1 (a K + b C).
    damped : whether C is present; without it one eigenvalue suffices.
    """
    undamped = 2 / sqrt(largest(1.0, 0.0))
    if not damped:
        return undamped

    from scipy.optimize import brentq  # slow to import: only for chains that need it

    def excess(dt: float) -> float:
        return largest(dt * dt, 4 * dt) - 4

    if excess(undamped) <= 1e-12:  # dashpots of zero, except for round-off
        return undamped
    lower = undamped
    while excess(lower) > 0:
        lower /= 4
    return brentq(excess, lower, undamped, xtol=1e-14 * undamped, rtol=1e-12)
