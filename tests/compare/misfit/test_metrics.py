"""Every metric on waveforms whose difference is known."""

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.engines import ENGINES, applies, names, solve
from jointwave.compare.misfit import metrics
from jointwave.compare.misfit.metrics import Worst, mean_period, misfit, relative_l2, worst

DT = 1e-4
T = np.arange(0, 0.12, DT)


def pulse(at=0.03, period=0.01):
    a = (np.pi * (T - at) / period) ** 2
    return (1 - 2 * a) * np.exp(-a)


def test_relative_l2_is_relative_to_the_second():
    assert relative_l2(2 * pulse(), pulse()) == pytest.approx(1)
    assert relative_l2(pulse(), pulse()) == 0
    assert relative_l2(0 * T, 0 * T) == 0
    assert relative_l2(pulse(), 0 * T) == np.inf


@pytest.mark.parametrize("shift", [-2.37e-3, 0.4e-4, 5e-3])
def test_delay_resolves_a_fraction_of_a_sample(shift):
    """A shifted pulse is late by its shift, to 2 % of a sample (parabola on a smooth peak)."""
    assert metrics.delay(pulse(0.03 + shift), pulse(), DT) == pytest.approx(shift, abs=0.02 * DT)


@pytest.mark.parametrize("samples", [3.1, 8.0, 50.0])
def test_mean_period_of_a_coarse_sine(samples):
    """A Gaussian envelope of 12 periods adds 1 / (2 (2 pi 12)^2) = 9e-5 to the mean square of the
    frequency. Central differences gave 11 % more at 8 samples a period."""
    t = np.arange(-50.0, 50.0, 1 / samples)
    wave = np.exp(-0.5 * (t / 12) ** 2) * np.sin(2 * np.pi * t)
    assert mean_period(wave, 1 / samples) == pytest.approx(1.0, rel=2e-4)


def test_mean_period_of_a_sine_and_of_a_stretched_pulse():
    """A sine has its own period; a pulse stretched by 1.3 has 1.3 times the period."""
    cycles = np.sin(2 * np.pi * T[:-1][: int(0.1 / DT)] / 0.01)
    assert mean_period(cycles, DT) == pytest.approx(0.01, rel=2e-3)
    ratio = mean_period(pulse(period=0.013), DT) / mean_period(pulse(), DT)
    assert ratio == pytest.approx(1.3, rel=5e-3)


def test_envelope_sees_amplitude_and_phase_sees_delay():
    """10 % more amplitude is 10 % of envelope and no phase; a delay d is 2 d / period of phase."""
    envelope, phase = metrics.envelope_phase_misfit(1.1 * pulse(), pulse(), DT)
    assert envelope == pytest.approx(0.1, rel=1e-6)
    assert phase == pytest.approx(0, abs=1e-9)
    late = np.sin(2 * np.pi * (T - 2e-4) / 0.01)
    _, phase = metrics.envelope_phase_misfit(late, np.sin(2 * np.pi * T / 0.01), DT)
    assert phase == pytest.approx(2 * 2e-4 / 0.01, rel=0.05)
    long = (np.append(x, np.zeros(30 * len(T))) for x in (-pulse(), pulse()))  # underflows
    assert metrics.envelope_phase_misfit(*long, DT) == pytest.approx((0.0, 1.0))


@pytest.mark.parametrize("off, level", [(0.0, 0.0), (pulse(), 1.0)])
def test_a_reference_without_a_wave_has_no_spectra_but_no_warning(off, level, recwarn):
    found = metrics.distance(level + off + 0 * T, level + 0 * T, DT, spectral=True)
    assert (found.misfit > 0) == bool(level)
    assert np.isnan(found.envelope) and np.isnan(found.phase)
    assert np.isnan([found.delay, found.peak_ratio]).all() == (not level)
    assert not recwarn.list


def result(attrs=None, errors=None, **fields):
    dims = {"shear": ("stress_y", "time", "across"), "velocity": ("velocity_y", "time", "axis")}
    stress = ("stress_y", "time")
    data = {name: (dims.get(name, stress), values) for name, values in fields.items()}
    data |= {f"{name}_error": ("stress_y", values) for name, values in (errors or {}).items()}
    coords = {"time": T, "stress_y": [5.0, 15.0], "velocity_y": [5.25]}
    coords |= {"across": ["x", "z"], "axis": [*"xyz"]}
    used = {dim for name in fields for dim in dims.get(name, stress)}
    return xr.Dataset(data, {k: v for k, v in coords.items() if k in used}, attrs or {})


WAVE = pulse()[None] * np.ones((2, 1))


def test_motion_where_there_should_be_none_is_not_passed_over():
    still = result(stress=0 * WAVE)
    assert misfit(result(stress=WAVE), still) == np.inf
    assert worst(still, still) == Worst(0.0)


def test_a_reference_judges_nothing_below_ten_times_its_own_error():
    """A misfit of 1e-3 from a wave known to 5e-4 is at most 5e-3."""
    errors = {"stress": [5e-4 * metrics.rms(pulse())] * 2}
    found = worst(result(stress=1.001 * WAVE), result(errors=errors, stress=WAVE))
    assert found.misfit == pytest.approx(1e-3)
    assert found.floor == pytest.approx(5e-4) and found.judged == pytest.approx(5e-3)


def test_a_misfit_goes_as_far_as_its_reference_is_known():
    """Behind the time at which a reference turns chaotic nothing counts."""
    lost = result(stress=np.where(T > 0.06, 1.0, WAVE))
    assert misfit(lost, result(stress=WAVE)) > 1
    assert misfit(lost, result({"known_until": 0.06}, stress=WAVE)) == 0


def test_a_quantity_that_the_reference_leaves_out_decides_nothing_beside_one_that_moves():
    """A block that its reference holds still on a slope trembles on its springs."""
    wave, still = WAVE[..., None] * np.ones(2), np.zeros((1, len(T), 3))
    one = result(shear=1.02 * wave, velocity=1e-6 + still)
    assert misfit(one, result(shear=wave, velocity=still)) == pytest.approx(0.02)


SHORT = {
    "pillar__length": 15.0,
    "time__duration": 0.02,
    "record__stress": [5.0, 9.75],
    "record__velocity": [5.25],
}


@pytest.mark.parametrize("ends", ["free", "fixed", "matched"])
def test_every_solution_starts_from_the_prestress_and_moves_as_without_it(pillar, ends):
    """Linear, so the prestress is a constant beside the motion, however large it is."""
    pressed = {"prestress": {"normal": 1e7}}
    scene, free = (pillar(ends__end=ends, **SHORT, **more) for more in (pressed, {}))
    found = [name for name in names() if applies(name, scene)]
    assert {*ENGINES, "lattice", "jointed-bar", "equivalent-bar"} <= set(found)
    for name in found:
        result = solve(name, scene)
        np.testing.assert_allclose(result.stress.values[:, 0], 1e7, rtol=1e-10, err_msg=name)
        moved = np.abs(result.displacement.values)
        assert moved[:, 0].max() <= 1e-10 * moved.max(), name
        assert worst(result, solve(name, free)).misfit < 1e-6, name
