"""A force at a point of unbounded rock: in plane strain a line force per length (Achenbach, Wave
Propagation in Elastic Solids, 1973; Kausel, Fundamental Solutions in Elastodynamics, 2006), in
space Stokes' solution (Aki & Richards, Quantitative Seismology, 2002, chapter 4).

With gamma = x/r, an impulse of 1 N s per m in direction j displaces along i in the plane, with s_c
= sqrt(t^2 - r^2/c^2) from the arrival r/c on and 0 before,

    2 pi rho G_ij = gamma_i gamma_j / (a^2 s_a) + (delta_ij - gamma_i gamma_j) / (b^2 s_b)
                    + (2 gamma_i gamma_j - delta_ij) (s_a - s_b) / r^2

and an impulse of 1 N s in space, with H_c = 1 from the arrival on and 0 before,

    4 pi rho G_ij = gamma_i gamma_j delta(t - r/a) / (a^2 r)
                    + (delta_ij - gamma_i gamma_j) delta(t - r/b) / (b^2 r)
                    + (3 gamma_i gamma_j - delta_ij) t (H_a - H_b) / r^3

The displacement by a force f(t) is the convolution of both. In the plane, substituting the delays
(r/a) cosh(eta) up to the arrival of the S wave and (r/b) cosh(eta) after it removes the singular
roots, and s_a - s_b = (1/b^2 - 1/a^2) r^2 / (s_a + s_b) avoids cancellation. The integrals use
Gauss-Legendre points between the breaks of f; the difference from half as many points bounds the
error. G is homogeneous of degree 1 - d in r and t, so that r dG/dr convolved with f is -(tau G)
convolved with f' - (d - 2) G convolved with f, which gives strains and stresses. Valid everywhere
except at the force; stress tension positive.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss

from jointwave.cases.incident import in_components
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.waves import PlaneMotion

POINTS = 64  # integration points between two breaks
SAFETY = 2.0  # factor on the difference from half as many points
FLOOR = 1e-13  # round-off, over the largest value

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
    """Return the motion caused by a force, with error bounds that hold at any time.

    direction : of the force, unit vector [d], d = 2 for a line and 3 for a point.
    force, rate : f (N/m or N), continuous, and its rate (per s), at times (s).
    breaks : ascending, s: f is 0 up to the first and from the last on (which may be inf), and
        smooth between them, about one cycle at most; a longer signal needs more breaks.
    offsets : of the places from the force, not zero, [m, d], m.
    times : s, in any order.
    """
    x, t = np.atleast_2d(offsets), np.asarray(times)
    d = np.asarray(direction, dtype=float)
    found, rough = (
        np.array([_motion(rock, d, force, rate, breaks, place, t, points) for place in x])
        for points in (POINTS, POINTS // 2)
    )
    dim = x.shape[1]
    parts = np.split(found, [dim, 2 * dim], axis=1)
    off = np.split(SAFETY * np.abs(found - rough).max(axis=-1), [dim, 2 * dim], axis=1)
    errors = [e + FLOOR * np.abs(part).max() for e, part in zip(off, parts, strict=True)]
    return PlaneMotion(*parts, *errors)


def _motion(rock, d, force, rate, breaks, x, t, points) -> np.ndarray:
    """Return displacement, velocity and stress components [2 d + 3 or 6, n] at one place."""
    dim, r = len(x), float(np.linalg.norm(x))
    f, v, slope = (np.zeros((2, len(t))) for _ in range(3))
    for at, tau, weights in (_pieces if dim == 2 else _pieces_in_space)(rock, r, breaks, t, points):
        moved = weights * rate(t[at, None] - tau)
        f[:, at] += (weights * force(t[at, None] - tau)).sum(axis=-1)
        v[:, at] += moved.sum(axis=-1)
        slope[:, at] -= (moved * tau).sum(axis=-1) / r
    slope -= (dim - 2) * f / r
    g, scale = x / r, 2 * (dim - 1) * np.pi * rock.density
    moves = [(np.outer(g * (g @ d), P) + np.outer(d, Q)) / scale for P, Q in (f, v)]
    gradient = np.moveaxis(_gradient(g, d, r, f, slope) / scale, 2, 0)  # [n, i, k], of u_i along k
    dilation = rock.lame * np.trace(gradient, axis1=1, axis2=2)
    stress = dilation[:, None, None] * np.eye(dim)
    stress += rock.shear_modulus * (gradient + gradient.swapaxes(1, 2))
    return np.concatenate([*moves, in_components(stress).T])


def _gradient(g, d, r, values, slopes) -> np.ndarray:
    """Return the gradient of P g (g.d) + Q d, from the values and radial slopes of (P, Q)."""
    (P, _), (P_r, Q_r) = values, slopes
    along, across = g @ d, np.eye(len(g)) - np.outer(g, g)
    turned = along * across + np.outer(g, across @ d)
    return (
        np.multiply.outer(along * np.outer(g, g), P_r)
        + np.multiply.outer(turned, P / r)
        + np.multiply.outer(np.outer(d, g), Q_r)
    )


def _pieces(rock: ElasticRock, r: float, breaks, t: np.ndarray, points: int) -> Iterator[tuple]:
    """Yield, for a line force, the indices [k] of times, the delays tau [k, points] that
    contribute, and the weights [(P, Q), k, points] of f(t - tau)."""
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


def _pieces_in_space(
    rock: ElasticRock, r: float, breaks, t: np.ndarray, points: int
) -> Iterator[tuple]:
    """Yield the same for a point force: both arrivals, and the near field between them."""
    arrivals = r / rock.p_speed, r / rock.s_speed
    for arrival, shares in zip(arrivals, ([1.0, 0.0], [-1.0, 1.0]), strict=True):
        at = np.flatnonzero((t - arrival > breaks[0]) & (t - arrival < breaks[-1]))
        weight = arrival**2 / r**3 * np.array(shares)
        yield at, np.full((len(at), 1), arrival), np.tile(weight[:, None, None], (len(at), 1))
    nodes, weights = leggauss(points)
    for near, far in pairwise(breaks):
        low, high = (np.clip(t - end, *arrivals) for end in (far, near))
        at = np.flatnonzero(high > low)
        half = (high - low)[at, None] / 2
        tau = low[at, None] + half * (nodes + 1)
        yield at, tau, np.multiply.outer([3.0, -1.0], half * weights * tau / r**3)
