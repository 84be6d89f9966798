"""Spectra; transfer function, apparent Q and speed of a wave between two receivers.

Use records of a single passage: `result.sel(time=slice(0, 0.02))` leaves out later reflections.
"""

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.units import UNITS
from jointwave.compare.misfit.metrics import delay, motion
from jointwave.compare.readings.recordings import Recording, recording, sampling, variables
from jointwave.results.labels import RECEIVERS

WAYS = "way_1", "way_2", "way_3"  # offsets from the first receiver along the axes
HEARD = 0.01  # least amplitude of a frequency that is read, over the first record's largest


def waveforms(
    result: Recording, quantity: str = "velocity", axis: str | None = None
) -> xr.DataArray:
    """Return one component of a quantity minus its static state [receiver, time], with the
    `distance` (m) and the offsets along the axes from the first receiver, NaN if unknown.

    result : see `recording`. axis : component, "x", "y", "xy" ...; None: that of the largest
    motion.
    """
    result = recording(result, quantity)
    if quantity not in result:
        where, receivers = str(result.attrs.get("title", "result")), set(RECEIVERS)
        known = [str(n) for n, x in result.items() if "time" in x.dims and receivers & set(x.dims)]
        raise SceneError(where, "quantity", quantity, f"must be one of {', '.join(known)}")
    found = result[quantity].copy(data=motion(result[[quantity]])[quantity].values)
    receiver, places = next((d, RECEIVERS[str(d)]) for d in found.dims if d in RECEIVERS)
    for components in set(found.dims) - {receiver, "time"}:
        named = list(found[components].values)
        loudest = abs(found).max([receiver, "time"]).values.argmax()
        if axis and axis not in named:
            raise SceneError("result", "axis", axis, f"must be one of {', '.join(named)}")
        found = found.isel({components: named.index(axis) if axis else int(loudest)})
    along = np.array([result[n].values - result[n].values[0] for n in places if n in result])
    found = found.transpose(receiver, "time").rename({receiver: "receiver"})
    ways = dict(zip(WAYS, along, strict=False)) | {"distance": np.hypot.reduce(along, axis=0)}
    return found.assign_coords({name: ("receiver", way) for name, way in ways.items()})


def spectra(result: Recording, quantity: str = "velocity", axis: str | None = None) -> xr.DataArray:
    """Return the Fourier spectrum of one component at every receiver, per Hz: the integral of x
    e^{-i omega t} dt by the trapezium rule, complex [receiver, frequency].

    result, quantity, axis : see `waveforms`. The amplitude spectrum is its `abs`.
    """
    row = waveforms(result, quantity, axis)
    frequency, x = _frequencies(row), row.values.copy()
    x[:, [0, -1]] /= 2
    turned = np.exp(-2j * np.pi * frequency.values * float(row["time"][0]))
    found = xr.Variable(("receiver", "frequency"), sampling(row) * np.fft.rfft(x) * turned)
    unit = next(iter(UNITS[quantity]))
    attrs = {"long_name": f"spectrum of the {quantity}", "units": f"{unit}/Hz"}
    coords = {"frequency": frequency, "distance": row["distance"]}
    return xr.DataArray(found, coords, name="spectrum", attrs=attrs)


def wave_speed(
    result: Recording,
    one: int = 0,
    other: int = -1,
    quantity: str = "velocity",
    axis: str | None = None,
) -> float:
    """Return the speed of a wave from one receiver to another, m/s: their distance over the delay
    of best correlation; negative if the wave reaches the other one first, infinite without delay.

    one, other : receivers by number. quantity, axis : of the waveforms, see `waveforms`.
    """
    way, late = _passage(waveforms(result, quantity, axis), one, other)
    return way / late if late else np.inf


def transfer_function(
    result: Recording,
    one: int = 0,
    other: int = -1,
    quantity: str = "velocity",
    axis: str | None = None,
    water_level: float = 1e-3,
) -> xr.DataArray:
    """Return the spectrum at one receiver over that at another, complex [frequency], with e^{i
    omega t}: a later arrival has a falling phase.

    water_level : least value of the divisor, over its largest amplitude (Clayton & Wiggins,
    Geophys. J. R. Astr. Soc. 47, 1976).
    """
    row = waveforms(result, quantity, axis)
    first, last = np.fft.rfft(_pair(row, one, other))
    level = water_level * np.abs(first).max()
    ratio = last * first.conj() / np.maximum(np.abs(first), level) ** 2
    attrs = {"long_name": f"transfer function of the {quantity}", "units": "1"}
    return xr.DataArray(ratio, {"frequency": _frequencies(row)}, name="transfer", attrs=attrs)


def quality_factor(
    result: Recording,
    one: int = 0,
    other: int = -1,
    quantity: str = "velocity",
    axis: str | None = None,
) -> xr.Dataset:
    """Return attenuation (1/m), phase_speed (m/s) and apparent quality factor [frequency] of the
    wave between two receivers, where the first one's spectrum is above a hundredth of its largest.

    The ratio of both spectra is exp(-a x - i omega x / c) and Q = omega / (2 a c) (Aki & Richards,
    Quantitative Seismology, 2002, 5.5). Reflection from joints lowers Q as heat does, and so does a
    record that ends within the pulse: a Q of 20 reads 6 to 16.
    """
    row = waveforms(result, quantity, axis)
    (first, last), frequency = np.fft.rfft(_pair(row, one, other)), _frequencies(row)
    way, late = _passage(row, one, other)
    heard = np.abs(first) > HEARD * np.abs(first).max()
    heard[0] = False
    omega, ratio = 2 * np.pi * frequency.values[heard], last[heard] / first[heard]
    turned = np.unwrap(np.angle(ratio * np.exp(1j * omega * late)))
    loudest = turned[np.abs(first * last)[heard].argmax()] if heard.any() else 0.0
    lag = omega * late - turned + 2 * np.pi * np.round(loudest / (2 * np.pi))  # half a turn there
    loss = -np.log(np.abs(ratio))
    with np.errstate(divide="ignore"):  # without any loss
        quality = lag / (2 * loss)
    named = {
        "attenuation": (loss / way, "attenuation", "1/m"),
        "phase_speed": (omega * way / lag, "phase speed", "m/s"),
        "quality": (quality, "apparent quality factor", "1"),
    }
    return xr.Dataset(variables("frequency", named), {"frequency": frequency[heard]})


def known_places(row: xr.DataArray) -> np.ndarray:
    """Return the receivers' places [space, receiver], m. Raises SceneError if they are unknown."""
    found = np.array([row[name].values for name in WAYS if name in row.coords])
    if np.isnan(found).any():
        allowed = "are needed: columns named as velocity@20, or (time, values, distances)"
        raise SceneError("recording", "places of receivers", None, allowed)
    return found


def _frequencies(row: xr.DataArray) -> xr.Variable:
    frequency = np.fft.rfftfreq(row.sizes["time"], sampling(row))
    return xr.Variable("frequency", frequency, {"long_name": "frequency", "units": "Hz"})


def _pair(row: xr.DataArray, *receivers: int) -> np.ndarray:
    """Return the waveforms of some receivers by number [receiver, time]."""
    count = row.sizes["receiver"]
    for one in receivers:
        if not -count <= one < count:
            raise SceneError("result", "receiver", one, f"must be from {-count} to {count - 1}")
    return row.values[[*receivers]]


def _passage(row: xr.DataArray, one: int, other: int) -> tuple[float, float]:
    """Return the distance of two receivers, m, and the delay at the other one, s."""
    places, (first, last) = known_places(row), _pair(row, one, other)
    if not (way := float(np.linalg.norm(places[:, other] - places[:, one]))):
        raise SceneError("result", "receivers", f"{one} and {other}", "must be two places")
    return way, delay(last, first, sampling(row))
