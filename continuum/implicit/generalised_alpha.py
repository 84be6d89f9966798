"""The generalised-alpha method for structural dynamics: Chung & Hulbert (1993).

Newmark's formulas carry displacement u, velocity v and acceleration a over a step,

    u' = u + dt v + dt^2 ((1/2 - beta) a + beta a'),   v' = v + dt ((1 - gamma) a + gamma a'),

and the equation of motion holds between the two ends of it, with inertia and forces interpolated:

    M ((1 - alpha_m) a' + alpha_m a) + (1 - alpha_f) f' + alpha_f f = (1 - alpha_f) F' + alpha_f F.

J. Chung & G. M. Hulbert, A time integration algorithm for structural dynamics with improved
numerical dissipation: the generalized-alpha method, J. Appl. Mech. 60 (1993), 371-375.
"""

from typing import NamedTuple


class Scheme(NamedTuple):
    """The constants of the method; alpha_m and alpha_f are the shares of the step's beginning."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float


def scheme(rho: float) -> Scheme:
    """Return the second-order, unconditionally stable scheme of spectral radius `rho`, 0 .. 1.

    Every step multiplies the amplitude of infinite frequencies by rho; low ones lose as little as
    they can for this rho. rho = 1 is the trapezoidal rule, without dissipation; rho = 0 leaves
    nothing of infinite frequencies after one step.
    """
    if not 0.0 <= rho <= 1.0:
        raise ValueError(f"the spectral radius must be between 0 and 1, not {rho}")
    alpha_m = (2 * rho - 1) / (rho + 1)
    alpha_f = rho / (rho + 1)
    return Scheme(
        alpha_m, alpha_f, beta=(1 - alpha_m + alpha_f) ** 2 / 4, gamma=0.5 - alpha_m + alpha_f
    )
