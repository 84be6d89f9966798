"""Spectra against Fourier's theory, and the frequencies that a scene is known by."""

from math import pi, sqrt

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.figures.charts.spectra import (
    TAPERED,
    marks_of,
    spectra,
    spectra_of,
    spectrum,
    tapered,
)
from jointwave.compare.figures.receivers import panels

LAYER = {"y": 20.0, "spacing_stiffness": 4.375e8}


def marks(comparison):
    """Return the marks of a comparison's first panel by name."""
    return dict(marks_of(panels([comparison])[0][0]))


@pytest.mark.parametrize("frequency", [37.0, 100.0, 612.5])
def test_a_sine_peaks_at_its_frequency_with_half_its_area(frequency):
    dt, count = 1e-4, 8000
    time = dt * np.arange(count)
    found, amplitude = spectrum(3.0 * np.sin(2 * pi * frequency * time), dt)
    peak = int(amplitude.argmax())
    assert abs(found[peak] - frequency) <= found[1]
    # The taper takes half of the tenth at the end; between two frequencies a tenth is lost at most.
    area = 3.0 / 2 * dt * count * (1 - TAPERED / 2)
    assert 0.9 * area < amplitude[peak] <= 1.001 * area


def test_a_gaussian_is_a_gaussian():
    dt, width = 1e-4, 2e-3
    time = dt * np.arange(2000) - 0.05
    found, amplitude = spectrum(np.exp(-0.5 * (time / width) ** 2), dt)
    expected = sqrt(2 * pi) * width * np.exp(-0.5 * (2 * pi * found * width) ** 2)
    np.testing.assert_allclose(amplitude, expected, atol=1e-9 * expected[0])


def test_energy_is_the_same_over_time_and_frequency():
    """Parseval."""
    values = np.random.default_rng(1).normal(size=777)
    dt = 2e-5
    found, amplitude = spectrum(values, dt)
    twice = np.full(len(found), 2.0)
    twice[[0, -1]] = 1.0
    over_frequency = found[1] * (twice * amplitude**2).sum()
    assert over_frequency == pytest.approx(dt * (tapered(values) ** 2).sum(), rel=1e-12)


def test_taper_leaves_nine_tenths_and_ends_in_zero():
    window = tapered(np.ones(1000))
    assert (window[:900] == 1).all()
    assert (np.diff(window[899:]) < 0).all() and window[-1] == pytest.approx(0, abs=1e-15)


def test_nothing_passes_above_the_cut_off_of_the_chain(pillar, compared):
    """The homogenised bar transmits frequencies that the blocks do not."""
    (comparison,) = compared(pillar(load__period=0.002), by=("dem", "lattice", "equivalent-bar"))
    shown = spectra_of(panels([comparison])[0][0])
    cut_off = marks(comparison)["chain cut-off"]
    p = calibrate(comparison.scene)
    assert cut_off == pytest.approx(
        sqrt(p.regular_stiffness * p.area / p.block_mass) / pi, rel=1e-12
    )

    def passed(name):
        curve = shown[name]
        above = (curve.index > 1.15 * cut_off) & (curve.index < 1.6 * cut_off)
        below = (curve.index > 0.4 * cut_off) & (curve.index < 0.85 * cut_off)
        return curve[above].mean() / curve[below].mean()

    assert passed("dem") < 2e-3 and passed("lattice") < 2e-3
    assert passed("equivalent-bar") > 0.1


@pytest.fixture(scope="module")
def picture(scene_with, compared):
    keys = {"time.duration": 0.04, "record.velocity": [30.25]}
    scenes = [scene_with(soft_layers=layers, **keys) for layers in ([], [LAYER])]
    (found,) = spectra("fig", compared(*scenes))
    return found


def test_curves_hold_the_numbers_of_the_table(picture):
    columns = iter(c for c in picture.table.columns if c != "frequency (Hz)")
    factors = {"Pa/Hz": 1e-6, "m/s/Hz": 1.0}
    for ax in picture.figure.axes:
        for line in (one for one in ax.lines if one.get_linestyle() != ":"):
            column = next(columns)
            kept = picture.table[["frequency (Hz)", column]].dropna()
            factor = factors[column[column.rindex("(") + 1 : -1]]
            np.testing.assert_allclose(line.get_xdata(), kept["frequency (Hz)"])
            np.testing.assert_allclose(line.get_ydata(), factor * kept[column])
    assert next(columns, None) is None


def test_every_panel_has_its_own_marks(picture):
    # Load and cut-off.
    lines = [sum(line.get_linestyle() == ":" for line in ax.lines) for ax in picture.figure.axes]
    assert lines == [2, 2, 2, 2]


def test_axes_are_logarithmic(picture, ink):
    assert all(ax.get_xscale() == ax.get_yscale() == "log" for ax in picture.figure.axes)
    assert ink(picture.figure) > 0.01


def test_no_spectra_of_what_does_not_move(pillar, compared):
    assert spectra("fig", compared(pillar(load__amplitude=0.0), by=("lattice",))) == []
