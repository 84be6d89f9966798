"""Uncertainty of fitted numbers: covariance, independent samples, indistinguishable unknowns.

Near the best fit a waveform is linear in the unknowns. With the Jacobian J there and a residual of
variance s2 the unknowns scatter with the covariance s2 (J^T J)^-1, and Student's t with n - p
degrees of freedom gives the interval (Bates & Watts, Nonlinear Regression Analysis and Its
Applications, 1988). Correlated neighbouring residuals add no information: n samples count
as n / tau, tau the residual's integrated autocorrelation, summed while pairs of it are positive
(Geyer, Statist. Sci. 7, 1992), and the covariance is tau times as large.
"""

from math import inf
from typing import NamedTuple

import numpy as np
from scipy.signal import correlate
from scipy.stats import t as student

CONFIDENCE = 0.95
ALIKE = 0.99  # correlation above which two unknowns are indistinguishable
SINGULAR = 1e-9  # of the largest eigenvalue: accuracy of derivatives by differences


class Known(NamedTuple):
    """The uncertainty of p unknowns: half width of the interval [p], inf if unbounded, the
    correlations [p, p], and the number of independent samples of each waveform."""

    reach: np.ndarray
    correlation: np.ndarray
    independent: list[float]


def autocorrelation_time(residual: np.ndarray) -> float:
    """Return the correlation length of a residual [n] in samples, at least 1."""
    power = float(residual @ residual)
    if power == 0:
        return 1.0
    rho = correlate(residual, residual, method="fft")[len(residual) - 1 :] / power
    pairs = rho[: len(rho) // 2 * 2].reshape(-1, 2).sum(axis=1)
    ends = np.flatnonzero(pairs <= 0)
    return max(1.0, float(2 * pairs[: ends[0] if len(ends) else None].sum() - 1))


def deviations(residuals: list[np.ndarray], unknowns: int) -> list[float]:
    """Return the standard deviation of each residual, corrected for degrees of freedom."""
    total = sum(map(len, residuals))
    return [
        float(np.sqrt(r @ r / max(len(r) * (1 - unknowns / total), 1e-300))) if len(r) else 0.0
        for r in residuals
    ]


def known(residuals: list[np.ndarray], jacobians: list[np.ndarray]) -> Known:
    """Return the uncertainty of unknowns from residuals [n] and Jacobians [n, p] at the fit."""
    p = jacobians[0].shape[1]
    times = [autocorrelation_time(r) for r in residuals]
    independent = [len(r) / time for r, time in zip(residuals, times, strict=True)]
    noise = deviations(residuals, p)
    least = 1e-150 + 1e-12 * max(noise)  # lower limit for a waveform that is fitted exactly
    information = np.zeros((p, p))
    for j, s, time in zip(jacobians, noise, times, strict=True):
        scaled = j / max(s, least)
        information += scaled.T @ scaled / time
    covariance, correlation = _inverted(information)
    freedom = sum(independent) - p
    quantile = float(student.ppf((1 + CONFIDENCE) / 2, freedom)) if freedom > 0 else inf
    variance = np.diag(covariance)
    reach = np.where(np.isfinite(variance), quantile * np.sqrt(np.maximum(variance, 0.0)), inf)
    return Known(reach, correlation, independent)


def _inverted(information: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return covariance [p, p], infinite for unbounded unknowns, and correlation [p, p]."""
    scale = np.sqrt(np.diag(information))
    seen = scale > 0
    safe = np.where(seen, scale, 1.0)
    values, vectors = np.linalg.eigh(information / np.outer(safe, safe))
    lost = (values < SINGULAR * values[-1]) if values[-1] > 0 else np.ones(len(values), bool)
    values = np.maximum(values, 1e-16)
    covariance = (vectors / values) @ vectors.T
    deviation = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(deviation, deviation)
    correlation[~np.outer(seen, seen)] = 0.0
    np.fill_diagonal(correlation, 1.0)
    unbounded = ~seen | (np.abs(vectors[:, lost]) > 0.01).any(axis=1)
    covariance = covariance / np.outer(safe, safe)
    covariance[unbounded, unbounded] = inf
    return covariance, correlation


def not_told_apart(correlation: np.ndarray, names: list[str]) -> list[str]:
    """Return in words which unknowns the waveforms cannot distinguish."""
    found = [
        f"{names[i]} and {names[j]} cannot be distinguished: correlation {correlation[i, j]:+.5f}"
        for i in range(len(names))
        for j in range(i)
        if abs(correlation[i, j]) > ALIKE
    ]
    values, vectors = np.linalg.eigh(correlation)
    if not found and values[0] < 1 - ALIKE:
        together = [n for n, v in zip(names, vectors[:, 0], strict=True) if abs(v) > 0.2]
        found = [f"{', '.join(together)} cannot be distinguished in combination"]
    return found
