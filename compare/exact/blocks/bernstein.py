"""All roots of a polynomial on [0, 1], by its Bernstein coefficients.

A polynomial has no more roots in (0, 1) than its Bernstein coefficients have changes of sign; the
numbers differ by an even number (Descartes' rule in this basis; Farouki, Computer Aided Geometric
Design 29, 2012). If there are several changes the interval is halved by de Casteljau's scheme.
"""

from functools import cache
from math import comb

import numpy as np

NARROWEST = 2.0**-40  # below it, a pair of roots counts as a tangency without a change of sign


def of_powers(degree: int) -> np.ndarray:
    """Return the matrix [degree + 1, degree + 1] from power to Bernstein coefficients."""
    n = degree + 1
    return np.array([[comb(i, k) / comb(degree, k) for k in range(n)] for i in range(n)])


@cache
def _halves(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices from the coefficients on an interval to those on its two halves."""
    n = degree + 1
    left = np.array([[comb(i, k) / 2**i for k in range(n)] for i in range(n)])
    return left, left[::-1, ::-1].copy()


def sign_changes(bernstein: np.ndarray, powers: list[float], up_to: float = 1.0) -> list[float]:
    """Return the points in (0, 1) at which a polynomial changes sign, in order, to round-off.

    bernstein, powers : its coefficients in both bases. up_to : upper limit of the search.
    """
    halves, roots = _halves(len(bernstein) - 1), []
    parts = [(0.0, 1.0, bernstein)]
    while parts:
        a, b, c = parts.pop()
        if a >= up_to:
            break
        signs = np.sign(c[c != 0])
        changes = int((signs[1:] != signs[:-1]).sum())
        if changes == 1:
            roots.append(_root(powers, a, b, bool(signs[-1] > 0)))
        elif changes and b - a > NARROWEST:
            middle = (a + b) / 2
            left, right = (half @ c for half in halves)
            if right[0] == 0 and _sign(left[::-1]) != _sign(right):
                roots.append(middle)
            parts += [(middle, b, right), (a, middle, left)]
    return sorted(roots)


def _sign(c: np.ndarray) -> float:
    """Return the sign of the first coefficient that is not zero; 0 where all are."""
    signs = np.sign(c[c != 0])
    return float(signs[0]) if len(signs) else 0.0


def _root(powers: list[float], a: float, b: float, rises: bool) -> float:
    """Return the only root between a and b, by Newton steps, or bisection where they leave it."""
    x = (a + b) / 2
    for _ in range(200):
        value = slope = 0.0
        for c in reversed(powers):
            slope = slope * x + value
            value = value * x + c
        if (value > 0) == rises:
            b = x
        else:
            a = x
        newton = x - value / slope if slope else a
        new = newton if a < newton < b else (a + b) / 2
        x, moved = new, abs(new - x)
        if moved <= 1e-16:
            break
    return x
