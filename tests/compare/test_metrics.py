"""Every metric on waveforms whose difference is known."""

import numpy as np
import pytest

from compare.metrics import delay, distance, envelope_phase_misfit, mean_period, relative_l2

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
