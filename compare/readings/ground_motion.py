"""The severity of a motion: peak particle velocity, Arias intensity, response spectra.

All take the recorded velocity as straight lines between its samples, for which they are exact.
"""

from collections.abc import Sequence
from math import ceil, pi

import numpy as np
import xarray as xr

from cases.errors import SceneError
from compare.readings.attenuation import sampling

GRAVITY = 9.81  # m/s2


def peak_velocity(result: xr.Dataset) -> xr.DataArray:
    """Return the peak particle velocity at every receiver, m/s: of the vector's length."""
    return _peak(result["velocity"], "axis", "time")


def peak_velocity_map(result: xr.Dataset) -> xr.DataArray:
    """Return the peak particle velocity over all snapshots of a result [node], m/s, with the nodes'
    x, y and z (m) as coordinates.

    A peak between two snapshots is not seen. Raises SceneError without `record.fields`.
    """
    if "field_velocity" not in result:
        raise SceneError(result.attrs.get("title", "result"), "record.fields", None, "is needed")
    places = result["field_points"].values.T
    found = _peak(result["field_velocity"], "component", "field_time")
    return found.assign_coords({axis: ("node", at) for axis, at in zip("xyz", places, strict=True)})


def _peak(velocity: xr.DataArray, components: str, time: str) -> xr.DataArray:
    found = ((velocity**2).sum(components) ** 0.5).max(time)
    return found.rename("peak_velocity").assign_attrs(
        long_name="peak particle velocity", units="m/s"
    )


def arias_intensity(result: xr.Dataset, gravity: float = GRAVITY) -> xr.DataArray:
    """Return the Arias intensity pi / (2 g) times the integral of the squared acceleration at every
    receiver in each direction, m/s (Arias, in: Seismic Design for Nuclear Power Plants, 1970).

    gravity : g, m/s2.
    """
    velocity, dt = result["velocity"], sampling(result)
    found = pi / (2 * gravity) * (velocity.diff("time") ** 2).sum("time") / dt
    return found.rename("arias_intensity").assign_attrs(long_name="Arias intensity", units="m/s")


def response_spectrum(
    result: xr.Dataset, periods: Sequence[float] | np.ndarray, damping: float = 0.05
) -> xr.Dataset:
    """Return the response spectra of the motion at every receiver in each direction.

    displacement (m) is the largest |x| of x'' + 2 zeta w x' + w^2 x = -v', up to one longest period
    after the record, over which the ground goes on as fast as at its end; pseudo_velocity (m/s) and
    pseudo_acceleration (m/s2) are w and w^2 times it. Stepped by the recurrence that is exact for
    straight lines (Nigam & Jennings, Bull. Seism. Soc. Am. 59, 1969), here of the velocity v.

    periods : of the oscillator, s. damping : zeta, of the critical one, below 1.
    """
    from scipy.signal import cont2discrete, lfilter

    velocity, dt = result["velocity"].transpose(..., "time"), sampling(result)
    later = ceil(max(periods) / dt)
    ground = np.pad(velocity.values, [(0, 0)] * (velocity.ndim - 1) + [(0, later)], mode="edge")
    peaks = []
    for omega in 2 * pi / np.asarray(periods, dtype=float):
        oscillator = [-1.0, 0.0], [1.0, 2 * damping * omega, omega**2]
        (rise,), fall, _ = cont2discrete(oscillator, dt, method="foh")
        peaks.append(np.abs(lfilter(rise, fall, ground)).max(axis=-1))
    of = velocity.isel(time=0, drop=True)
    period = xr.Variable("period", periods, {"long_name": "period of the oscillator", "units": "s"})
    displacement = of.expand_dims(period=period, axis=-1).copy(data=np.stack(peaks, axis=-1))
    omega = 2 * pi / displacement["period"]
    named = {
        "displacement": (displacement, "m"),
        "pseudo_velocity": (displacement * omega, "m/s"),
        "pseudo_acceleration": (displacement * omega**2, "m/s2"),
    }
    return xr.Dataset(
        {
            name: values.assign_attrs(long_name=f"spectral {name.replace('_', '-')}", units=unit)
            for name, (values, unit) in named.items()
        },
        attrs={"damping": damping},
    )
