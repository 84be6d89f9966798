"""The severity of a motion: peak particle velocity, Arias intensity, response spectra.

All are exact for linear interpolation between the recorded samples of velocity or acceleration,
except that spectra of a velocity use its slopes between samples as accelerations at the midpoints,
linear between these, and the peak velocity of an acceleration is that at its samples.
"""

import logging
from collections.abc import Sequence
from math import ceil, pi, sqrt

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError, require
from jointwave.compare.readings.recordings import Recording, recording, sampling, variables
from jointwave.results.dataset import A_RESULT

log = logging.getLogger("jointwave")

GRAVITY = 9.81  # m/s2
MOVES_ON = 0.5  # of the peak: velocity at the end of an acceleration that is doubted
POINTS = 1024  # per period of an oscillator, at which its displacement is evaluated


def ppv(result: Recording, quantity: str = "velocity") -> xr.DataArray:
    """Return the peak particle velocity (length of the vector) at every receiver, m/s.

    An acceleration is integrated, from rest at its first sample; a warning names what it leaves.
    quantity : of a recording that does not name its own.
    """
    found = recording(result, quantity)
    if "velocity" not in found:
        velocity = _of(found, "acceleration").cumulative_integrate("time")
        left, peak = (abs(one).max().item() for one in (velocity[..., -1], velocity))
        if left > MOVES_ON * peak:
            log.warning(
                "warning: acceleration: its integral ends at %.3g m/s: an offset of %.3g m/s2, or a"
                " record that ends within the motion; subtract its mean before",
                *(left, left / np.ptp(velocity["time"].values)),
            )
        found = velocity.to_dataset(name="velocity")
    return _peak(found["velocity"], "axis", "time")


def _of(result: xr.Dataset, quantity: str) -> xr.DataArray:
    if quantity not in result:
        where = str(result.attrs.get("title", "recording"))
        raise SceneError(where, "velocity", None, "or acceleration must be recorded")
    return result[quantity].transpose(..., "time")


def ppv_map(result: xr.Dataset) -> xr.DataArray:
    """Return the peak particle velocity over all snapshots of a result [node], m/s, with the nodes'
    x, y and z (m) as coordinates.

    Peaks between snapshots are missed. Raises SceneError without `record.fields`.
    """
    require(result, xr.Dataset, "ppv_map", "type", A_RESULT)
    if "field_velocity" not in result:
        raise SceneError(result.attrs.get("title", "result"), "record.fields", None, "is needed")
    places = result["field_points"].values.T
    found = _peak(result["field_velocity"], "component", "field_time")
    return found.assign_coords({axis: ("node", at) for axis, at in zip("xyz", places, strict=True)})


def _peak(velocity: xr.DataArray, components: str, time: str) -> xr.DataArray:
    found = ((velocity**2).sum(components) ** 0.5).max(time)
    return found.rename("ppv").assign_attrs(long_name="peak particle velocity", units="m/s")


def arias(result: Recording, gravity: float = GRAVITY, quantity: str = "velocity") -> xr.DataArray:
    """Return the Arias intensity pi / (2 g) times the integral of the squared acceleration at every
    receiver in each direction, m/s (Arias, in: Seismic Design for Nuclear Power Plants, 1970).

    gravity : g, m/s2. quantity : of a recording that does not name its own.
    """
    if not gravity > 0:
        raise SceneError("arias", "gravity", gravity, "must be positive, m/s2")
    found = recording(result, quantity)
    dt = sampling(found)
    if "velocity" in found:
        squares = (found["velocity"].diff("time") / dt) ** 2
    else:
        after = _of(found, "acceleration")
        before = after.shift(time=1)
        squares = (before**2 + before * after + after**2) / 3
    intensity = pi / (2 * gravity) * dt * squares.sum("time")
    return intensity.rename("arias").assign_attrs(long_name="Arias intensity", units="m/s")


def response_spectrum(
    result: Recording,
    periods: float | Sequence[float] | np.ndarray,
    damping: float = 0.05,
    quantity: str = "velocity",
) -> xr.Dataset:
    """Return the response spectra of the motion at every receiver in each direction.

    displacement (m) is the largest |x| of x'' + 2 zeta w x' + w^2 x = -a, also between samples and
    after the record, when the ground does not accelerate; pseudo_velocity (m/s) and
    pseudo_acceleration (m/s2) are w and w^2 times it; for short periods the latter is the largest
    |a|. With n samples in a period of the motion, spectra of a velocity are low by (2 pi / n)^2 /
    8, of an acceleration by two thirds of that.

    periods : of the oscillator, s. damping : zeta, of critical, below 1. quantity : of a recording
    that does not name its own.
    """
    T = np.atleast_1d(np.asarray(periods, dtype=float))
    if not 0 <= damping < 1:
        raise SceneError("response_spectrum", "damping", damping, "must be from 0 to below 1")
    if not (T > 0).all():
        raise SceneError("response_spectrum", "periods", T.min(), "must be positive")
    found = recording(result, quantity)
    dt, accelerated = sampling(found), "acceleration" in found
    motion = _of(found, "acceleration" if accelerated else "velocity")
    ground = motion.values
    if not accelerated:
        ground = np.diff(ground, prepend=ground[..., :1], append=ground[..., -1:]) / dt
    peaks = [_largest_displacement(ground, dt, w, damping) for w in 2 * pi / T]
    dims = (*map(str, motion.dims[:-1]), "period")
    units = {"displacement": "m", "pseudo_velocity": "m/s", "pseudo_acceleration": "m/s2"}
    largest, omega = np.stack(peaks, axis=-1), 2 * pi / T
    spectra = {
        name: (largest * omega**power, f"spectral {name.replace('_', '-')}", unit)
        for power, (name, unit) in enumerate(units.items())
    }
    at = variables("period", {"period": (T, "period of the oscillator", "s")})
    found = xr.Dataset(variables(dims, spectra), motion.isel(time=0, drop=True).coords)
    return found.assign_coords(at).assign_attrs(damping=damping)


def _largest_displacement(
    ground: np.ndarray, dt: float, omega: float, damping: float
) -> np.ndarray:
    """Return max |x| of an oscillator that is at rest at first [...], m, during and after the
    record, by the exact response (Nigam & Jennings, Bull. Seism. Soc. Am. 59, 1969).

    With l = omega (-zeta + i sqrt(1 - zeta^2)) and w = x' - conj(l) x, x = Im w / Im l, and the
    oscillator x'' + 2 zeta omega x' + omega^2 x = -(a + b s) is w' = l w - a - b s:

        w(s) = (w(0) - p) exp(l s) + p + q s,    q = b / l,    p = (a + q) / l.

    In an interval x is a straight line plus a decaying oscillation: the largest |x| lies in its
    first or last period, and is low by at most (2 pi / POINTS)^2 / 8 = 5e-6 of the oscillation.
    After the record the first extreme is the largest.

    ground : [..., n] its acceleration, m/s2, dt (s) apart, zero after the last. omega : rad/s.
    """
    from scipy.signal import lfilter

    rate = omega * complex(-damping, sqrt(1 - damping**2))
    q = np.diff(ground) / dt / rate
    p = (ground[..., :-1] + q) / rate
    decay = np.exp(rate * dt)
    w = lfilter([1.0], [1.0, -decay], p * (1 - decay) + q * dt)
    turning = np.concatenate([np.zeros_like(w[..., :1]), w[..., :-1]], axis=-1) - p
    part = min(dt, 2 * pi / rate.imag)
    count = ceil(POINTS * part * omega / (2 * pi))
    extreme, last = np.angle(-rate.conjugate()), w[..., -1]
    late = (extreme - np.angle(last)) % pi / rate.imag
    largest = np.abs(last) * np.exp(rate.real * late) * np.sin(extreme)
    for start in {0.0, dt - part}:
        for at in start + np.linspace(0, part, count + 1):
            x = np.abs((turning * np.exp(rate * at) + p + q * at).imag).max(axis=-1)
            largest = np.maximum(largest, x)
    return largest / rate.imag
