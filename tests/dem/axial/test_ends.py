"""What ends give back: tan(kh/4) for a dashpot on a full-mass block, tan^2(kh/4) when matched."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.material.calibrate import calibrate

RAMP, STEADY = 40, 60  # periods: a slow start excites nothing near the cut-off of the chain


def write_harmonic(path, period):
    """Write a sine that grows smoothly over RAMP periods and stays."""
    t = np.arange(0, (RAMP + STEADY) * period, period / 200)
    ramp = np.sin(np.pi / 2 * np.clip(t / (RAMP * period), 0, 1)) ** 2
    np.savetxt(path, np.c_[t, 1e6 * ramp * np.sin(2 * np.pi * t / period)], delimiter=",")


def reflection(result, period: float, wavenumber: float) -> float:
    """Return |R|: two opposite waves fitted to the last periods' Fourier component."""
    time, y = result.time.values, result.velocity_y.values
    last = time > time[-1] - 10 * period + 1e-12
    phasor = np.exp(-2j * np.pi * time[last] / period)
    component = result.velocity.values[:, last, 0] @ phasor
    waves = np.exp(np.outer(y, [-1j * wavenumber, 1j * wavenumber]))
    incident, reflected = np.linalg.lstsq(waves, component, rcond=None)[0]
    return float(abs(reflected / incident))


@pytest.mark.parametrize("blocks_per_wavelength", [10, 20])
@pytest.mark.parametrize("end, power", [("quiet", 1), ("matched", 2)])
def test_reflection_of_an_absorbing_end(pillar, tmp_path, end, power, blocks_per_wavelength):
    """Within 1 % of tan(kh/4) and tan^2(kh/4), kh the lattice's own: 15.8, 7.9, 2.5 and 0.6 %."""
    p = calibrate(pillar())
    kh = 2 * np.pi / blocks_per_wavelength
    period = np.pi * p.spacing / (p.bar_speed * np.sin(kh / 2))
    write_harmonic(tmp_path / "sine.csv", period)
    scene = pillar(
        load={"shape": "table", "amplitude": 1.0, "file": str(tmp_path / "sine.csv")},
        ends={"start": "matched", "end": end},
        time__duration=(RAMP + STEADY) * period,
        record={
            "velocity": (p.spacing * (np.arange(60, 90) + 0.5)).tolist(),
            "interval": period / 40,
        },
        numerics__dem__step_fraction=0.02,
    )
    expected = np.tan(kh / 4) ** power
    assert reflection(dem.simulate(scene), period, kh / p.spacing) == pytest.approx(
        expected, rel=0.01
    )
