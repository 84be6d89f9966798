"""Spectra against Fourier's theory, and the frequencies that a scene is known by."""

from math import pi, sqrt

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.figures.charts import spectra as charts
from jointwave.compare.figures.charts.spectra import spectra
from jointwave.compare.figures.receivers import panels

LAYER = {"y": 20.0, "spacing_stiffness": 4.375e8}


def test_a_gaussian_is_a_gaussian():
    dt, width = 1e-4, 2e-3
    time = dt * np.arange(2000) - 0.05
    found, amplitude = charts.spectrum(np.exp(-0.5 * (time / width) ** 2), dt)
    expected = sqrt(2 * pi) * width * np.exp(-0.5 * (2 * pi * found * width) ** 2)
    np.testing.assert_allclose(amplitude, expected, atol=1e-9 * expected[0])


def test_taper_leaves_nine_tenths_and_ends_in_zero():
    window = charts.tapered(np.ones(1000))
    assert (window[:900] == 1).all()
    assert (np.diff(window[899:]) < 0).all() and window[-1] == pytest.approx(0, abs=1e-15)


def test_nothing_passes_above_the_cut_off_of_the_chain(pillar, compared):
    """The homogenised bar transmits frequencies that the blocks do not."""
    (comparison,) = compared(pillar(load__period=0.002), by=("dem", "lattice", "equivalent-bar"))
    panel = panels([comparison])[0][0]
    shown, cut_off = charts.spectra_of(panel), dict(charts.marks_of(panel))["chain cut-off"]
    p = calibrate(comparison.scene)
    expected = sqrt(p.regular_stiffness * p.area / p.block_mass) / pi
    assert cut_off == pytest.approx(expected, rel=1e-12)

    above, below = (
        shown[(shown.index > low * cut_off) & (shown.index < high * cut_off)].mean()
        for low, high in ((1.15, 1.6), (0.4, 0.85))
    )
    passed = above / below
    assert (passed[["dem", "lattice"]] < 2e-3).all() and passed["equivalent-bar"] > 0.1


def test_curves_hold_the_numbers_of_the_table(pillar, compared, ink):
    """In logarithmic axes, each panel with the marks of the load and of the cut-off."""
    keys = {"time.duration": 0.04, "record.velocity": [30.25]}
    scenes = [pillar(soft_layers=layers, **keys) for layers in ([], [LAYER])]
    (picture,) = spectra("fig", compared(*scenes))
    columns = iter(c for c in picture.table.columns if c != "frequency (Hz)")
    factors = {"Pa/Hz": 1e-6, "m/s/Hz": 1.0}
    for ax in picture.figure.axes:
        curves = [line for line in ax.lines if line.get_linestyle() != ":"]
        assert len(ax.lines) - len(curves) == 2
        assert ax.get_xscale() == ax.get_yscale() == "log"
        for line in curves:
            column = next(columns)
            kept = picture.table[["frequency (Hz)", column]].dropna()
            factor = factors[column.rpartition("(")[2].removesuffix(")")]
            np.testing.assert_allclose(line.get_xdata(), kept["frequency (Hz)"])
            np.testing.assert_allclose(line.get_ydata(), factor * kept[column])
    assert next(columns, None) is None
    assert "Dotted: 1/T of the load 100 Hz, cut-off of the chain" in picture.caption
    assert ink(picture.figure) > 0.01


def test_no_spectra_of_what_does_not_move(pillar, compared):
    assert spectra("fig", compared(pillar(load__amplitude=0.0), by=("lattice",))) == []
