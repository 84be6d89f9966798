"""Peaks and response spectra against closed forms of known pulses; for intensities see
`tests/test_jointwave.py` and `field_cases/test_response_spectra.py`."""

import numpy as np
import pytest
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.compare.readings.ground_motion import ppv, ppv_map, response_spectrum


def sine(cycles, dt):
    """Return a result of one receiver that moves so many seconds along y, at 0.2 m/s and 1 Hz."""
    time = dt * np.arange(round(cycles / dt) + 1)
    velocity = ("velocity_y", "time", "axis"), 0.2 * np.sin(2 * np.pi * time)[None, :, None]
    return xr.Dataset({"velocity": velocity}, {"time": time, "velocity_y": [3.0], "axis": ["y"]})


def test_peak_velocity_is_that_of_the_vector():
    time = np.linspace(0, 1, 101)
    swing = np.outer(np.sin(2 * np.pi * time), [3.0, 4.0])
    turn = np.stack([np.cos(2 * np.pi * time), np.sin(2 * np.pi * time)], axis=1)
    dims = ("point", "time", "axis")
    result = xr.Dataset({"velocity": (dims, np.stack([swing, turn]))}, {"time": time})
    assert ppv(result).values == pytest.approx([5.0, 1.0], rel=1e-12)
    assert ppv(result).units == "m/s"


def test_the_map_is_the_peak_of_every_node_at_its_place():
    velocity = np.zeros((3, 2, 3))
    velocity[1, 0], velocity[2, 1] = [0.0, -2.0, 0.0], [3.0, 4.0, 0.0]
    result = xr.Dataset(
        {
            "field_velocity": (("field_time", "node", "component"), velocity),
            "field_points": (("node", "component"), [[0.0, 1.0, 0.0], [2.0, 3.0, 0.0]]),
        }
    )
    found = ppv_map(result)
    assert found.values.tolist() == [2.0, 5.0]
    assert (found.x.values.tolist(), found.y.values.tolist()) == ([0.0, 2.0], [1.0, 3.0])
    with pytest.raises(SceneError, match=r"record\.fields: is needed"):
        ppv_map(result.drop_vars("field_velocity"))


def displacement_of_sine(t, omega, damping, speed=0.2, drive=2 * np.pi, stop=4.0):
    """Return x(t) of x'' + 2 zeta w x' + w^2 x = -v', v a sine up to `stop`, at rest before."""
    damped = omega * np.sqrt(1 - damping**2)
    X = -speed * drive / (omega**2 - drive**2 + 2j * damping * omega * drive)

    def free(a, b, s):
        c = (b + damping * omega * a) / damped
        return np.exp(-damping * omega * s) * (a * np.cos(damped * s) + c * np.sin(damped * s))

    def during(s):
        return (X * np.exp(1j * drive * s)).real + free(-X.real, -(1j * drive * X).real, s)

    h = 1e-6
    end, slope = during(stop), (during(stop + h) - during(stop - h)) / (2 * h)
    return np.where(t < stop, during(t), free(end, slope, np.maximum(t - stop, 0.0)))


def test_response_spectrum_of_a_sine():
    """Off by the straight lines of the velocity, (drive dt)^2 / 12, and peaks between samples."""
    periods, dt = np.array([0.25, 0.7, 1.0, 1.4, 3.0]), 0.002
    found = response_spectrum(sine(4, dt), periods, damping=0.05)
    one = response_spectrum(sine(4, dt), periods[0], damping=0.05)
    assert one.equals(found.isel(period=[0]))
    t = np.linspace(0, 7, 70001)
    exact = [np.abs(displacement_of_sine(t, 2 * np.pi / T, 0.05)).max() for T in periods]
    assert found.displacement.values.ravel() == pytest.approx(exact, rel=4e-4)
    omega = 2 * np.pi / periods
    pseudo = found.pseudo_velocity.values.ravel(), found.pseudo_acceleration.values.ravel()
    assert pseudo[0] == pytest.approx(omega * exact, rel=4e-4)
    assert pseudo[1] == pytest.approx(omega**2 * exact, rel=4e-4)
    assert found.displacement.dims == ("velocity_y", "axis", "period")
