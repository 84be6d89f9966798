"""Every metric on waveforms whose difference is known."""

import numpy as np
import pytest
import xarray as xr

from compare.metrics import (
    delay,
    distance,
    envelope_phase_misfit,
    mean_period,
    misfit,
    relative_l2,
)

DT = 1e-4
T = np.arange(0, 0.12, DT)


def pulse(at=0.03, period=0.01):
    """Return a Ricker wavelet, smooth and zero at both ends."""
    a = (np.pi * (T - at) / period) ** 2
    return (1 - 2 * a) * np.exp(-a)


def test_relative_l2_is_relative_to_the_second():
    """Twice the reference is 100 % off; the reference is not off; nothing against nothing is 0."""
    assert relative_l2(2 * pulse(), pulse()) == pytest.approx(1)
    assert relative_l2(pulse(), pulse()) == 0
    assert relative_l2(0 * T, 0 * T) == 0
    assert relative_l2(pulse(), 0 * T) == np.inf


@pytest.mark.parametrize("shift", [-2.37e-3, 0.4e-4, 5e-3])
def test_delay_resolves_a_fraction_of_a_sample(shift):
    """A shifted pulse is late by its shift, to 2 % of a sample (parabola on a smooth peak)."""
    assert delay(pulse(0.03 + shift), pulse(), DT) == pytest.approx(shift, abs=0.02 * DT)


def test_mean_period_of_a_sine_and_of_a_stretched_pulse():
    """A sine has its own period; a pulse stretched by 1.3 has 1.3 times the period.

    The finite difference is off by (omega dt)^2 / 6.
    """
    cycles = np.sin(2 * np.pi * T[:-1][: int(0.1 / DT)] / 0.01)
    assert mean_period(cycles, DT) == pytest.approx(0.01, rel=2e-3)
    ratio = mean_period(pulse(period=0.013), DT) / mean_period(pulse(), DT)
    assert ratio == pytest.approx(1.3, rel=5e-3)


def test_envelope_sees_amplitude_and_phase_sees_delay():
    """10 % more amplitude is 10 % of envelope and no phase; a delay d is 2 d / period of phase."""
    envelope, phase = envelope_phase_misfit(1.1 * pulse(), pulse(), DT)
    assert envelope == pytest.approx(0.1, rel=1e-6)
    assert phase == pytest.approx(0, abs=1e-9)
    late = np.sin(2 * np.pi * (T - 2e-4) / 0.01)
    envelope, phase = envelope_phase_misfit(late, np.sin(2 * np.pi * T / 0.01), DT)
    assert phase == pytest.approx(2 * 2e-4 / 0.01, rel=0.05)


def test_distance_of_silence_is_not_a_number_but_no_warning(recwarn):
    """A receiver that the wave never reaches breaks nothing."""
    found = distance(0 * T, 0 * T, DT, spectral=True)
    assert found.misfit == 0 and np.isnan(found.delay) and np.isnan(found.peak_ratio)
    assert not recwarn.list


def test_constant_reference_has_neither_envelope_nor_phase(recwarn):
    """A static stress holds no wave."""
    found = distance(1 + pulse(), 1 + 0 * T, DT, spectral=True)
    assert found.misfit > 0 and np.isnan(found.envelope) and np.isnan(found.phase)
    assert not recwarn.list


def result(**fields):
    """Return a result with these recorded fields: [place, time] or [place, time, component]."""
    dims = ("place", "time", "component")
    own = {k: [f"{k} {dim}" for dim in dims[: v.ndim]] for k, v in fields.items()}
    return xr.Dataset({k: (own[k], v) for k, v in fields.items()})


def test_misfit_takes_normal_and_shear_stress_together():
    """Both 1 % off: 1 %; only the shear, which is 3/5 of the whole: 0.6 %."""
    stress, shear = 4 * np.ones((1, 9)), 3 * np.ones((1, 9, 1))
    other = result(stress=stress, shear=shear, velocity=0 * shear)
    assert misfit(result(stress=1.01 * stress, shear=1.01 * shear), other) == pytest.approx(0.01)
    assert misfit(result(stress=stress, shear=1.01 * shear), other) == pytest.approx(0.006)
    assert misfit(result(stress=1.01 * stress), other) == pytest.approx(0.01)


def test_misfit_goes_on_to_what_moves():
    """Velocity without stress, rotation without either; nothing at all is no misfit."""
    still, moved = np.zeros((1, 9, 3)), np.ones((1, 9, 3))
    other = result(stress=still[:0, :, 0], velocity=moved, rotation=moved)
    assert misfit(other * 1.02, other) == pytest.approx(0.02)
    other = result(stress=still[..., 0], velocity=still, rotation=moved)
    assert misfit(other * 1.03, other) == pytest.approx(0.03)
    assert misfit(0 * other, 0 * other) == 0


def test_misfit_from_a_reference_that_stands_still_is_infinite():
    """Motion where there should be none is not passed over."""
    other = result(stress=np.zeros((1, 9)), velocity=np.ones((1, 9, 1)))
    assert misfit(other + 1e-6, other) == np.inf
