"""A line force in plane strain in unbounded rock (Achenbach, Wave Propagation in Elastic Solids,
1973; Kausel, Fundamental Solutions in Elastodynamics, 2006).

With gamma = x/r, s_c = sqrt(t^2 - r^2/c^2) from the arrival r/c on and 0 before, an impulse of
1 N s per m of the line in direction j displaces along i

    2 pi rho G_ij = gamma_i gamma_j / (a^2 s_a) + (delta_ij - gamma_i gamma_j) / (b^2 s_b)
                    + (2 gamma_i gamma_j - delta_ij) (s_a - s_b) / r^2

and a force f(t) displaces by the convolution of both. Substituting the delays (r/a) cosh(eta) up to
the arrival of the S wave and (r/b) cosh(eta) after it removes the singular roots, and
s_a - s_b = (1/b^2 - 1/a^2) r^2 / (s_a + s_b) avoids cancellation; the integrals use Gauss-Legendre
points between the breaks of f, and the difference from half as many bounds the error. G is
homogeneous of degree -1 in r and t, so that r dG/dr convolved with f is -(tau G) convolved with f',
which gives strains and stresses. Valid at every place off the line; stress tension positive.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.waves import PlaneMotion

POINTS = 64  # of integration between two breaks
SAFETY = 2.0  # factor on the difference from half of them
FLOOR = 1e-13  # of the largest value

Signal = Callable[[np.ndarray], np.ndarray]


def motion(
    rock: ElasticRock,
    direction: np.ndarray,
    force: Signal,
    rate: Signal,
    breaks: Sequence[float],
    offsets: np.ndarray,
    times: np.ndarray,
) -> PlaneMotion:
    """Return the motion caused by a force per length of line, with bounds at any time.

    Parameters
    ----------
    direction : of the force, unit vector [2].
    force, rate : f (N/m), continuous, and its rate (N/m/s), at times (s).
    breaks : ascending, s: f is 0 up to the first and from the last on (which may be inf), and
        smooth between them, about one cycle at most; a longer signal needs more of them.
    offsets : of the places from the line, off it, [m, 2], m.
    times : s, in any order.
    """
    x, t = np.atleast_2d(offsets), np.asarray(times)
    d = np.asarray(direction, dtype=float)
    found, rough = (
        np.array([_motion(rock, d, force, rate, breaks, place, t, points) for place in x])
        for points in (POINTS, POINTS // 2)
    )
    parts = [found[:, rows] for rows in (slice(0, 2), slice(2, 4), slice(4, 7))]
    off = np.split(SAFETY * np.abs(found - rough).max(axis=-1), [2, 4], axis=1)
    errors = [e + FLOOR * np.abs(part).max() for e, part in zip(off, parts, strict=True)]
    return PlaneMotion(*parts, *errors)


def _motion(rock, d, force, rate, breaks, x, t, points) -> np.ndarray:
    """Return displacement, velocity and stress [2 + 2 + 3, n] at one place."""
    r = float(np.hypot(*x))
    f, v, slope = (np.zeros((2, len(t))) for _ in range(3))
    for at, tau, weights in _pieces(rock, r, breaks, t, points):
        moved = weights * rate(t[at, None] - tau)
        f[:, at] += (weights * force(t[at, None] - tau)).sum(axis=-1)
        v[:, at] += moved.sum(axis=-1)
        slope[:, at] -= (moved * tau).sum(axis=-1) / r
    g, scale = x / r, 2 * np.pi * rock.density
    moves = [(np.outer(g * (g @ d), P) + np.outer(d, Q)) / scale for P, Q in (f, v)]
    gradient = _gradient(g, d, r, f, slope) / scale  # [i, k, n], of u_i along k
    dilation = rock.lame * np.trace(gradient)
    (xx, xy), (yx, yy) = rock.shear_modulus * gradient
    return np.concatenate([*moves, [dilation + 2 * xx, dilation + 2 * yy, xy + yx]])


def _gradient(g, d, r, values, slopes) -> np.ndarray:
    """Return the gradient of P g (g.d) + Q d, from the values and slopes over r of (P, Q)."""
    (P, _), (P_r, Q_r) = values, slopes
    along, across = g @ d, np.eye(2) - np.outer(g, g)
    turned = along * across + np.outer(g, across @ d)
    return (
        np.multiply.outer(along * np.outer(g, g), P_r)
        + np.multiply.outer(turned, P / r)
        + np.multiply.outer(np.outer(d, g), Q_r)
    )


def _pieces(rock: ElasticRock, r: float, breaks, t: np.ndarray, points: int) -> Iterator[tuple]:
    """Yield the indices [k] of times that have delays tau, these [k, points], and the weights
    [(P, Q), k, points] of f(t - tau) there."""
    nodes, weights = leggauss(points)
    fast, slow = r / rock.p_speed, r / rock.s_speed
    for near, far in pairwise(breaks):
        for region, (first, last) in enumerate(((fast, slow), (slow, np.inf))):
            ends = (np.clip(t - end, first, last) / first for end in (far, near))
            low, high = (np.arccosh(np.maximum(end, 1)) for end in ends)
            at = np.flatnonzero(high > low)
            half = (high - low)[at, None] / 2
            eta = low[at, None] + half * (nodes + 1)
            yield at, first * np.cosh(eta), half * weights * _kernel(rock, np.sinh(eta), region)


def _kernel(rock: ElasticRock, sinh: np.ndarray, region: int) -> np.ndarray:
    """Return the densities of P and Q over eta, between the arrivals (0) and after both (1)."""
    fast, slow = 1 / rock.p_speed**2, 1 / rock.s_speed**2
    if region == 0:
        return fast * np.array([1 + 2 * sinh**2, -(sinh**2)])
    root = np.sqrt(sinh**2 + 1 - fast / slow)
    near = (slow - fast) * sinh / (sinh + root)
    return np.array([fast * sinh / root - slow + 2 * near, slow - near])
