"""Colours as readers with colour blindness see them: Machado, Oliveira & Fernandes (2009)."""

from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from jointwave.compare.engines import ENGINES, names
from jointwave.compare.figures.charts.waveforms import variant_styles
from jointwave.compare.figures.style import DIFFERENCE, FIELD, TERMS, style

#: Of linear RGB, at full severity; normal sight first.
SIGHTS = {
    "normal": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritanopia": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
XYZ = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)  # of linear sRGB
WHITE = XYZ.sum(axis=1)


def seen(colour, sight):
    """Return a colour in CIELAB as it is seen."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    x = XYZ @ np.clip(SIGHTS[sight] @ linear, 0, 1) / WHITE
    f = np.where(x > (6 / 29) ** 3, np.cbrt(x), x / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def least_distance(colours, sight):
    """Return the least distance of two colours in CIELAB; 2.3 is just noticeable."""
    labs = [seen(colour, sight) for colour in colours]
    return min(np.linalg.norm(a - b) for a, b in combinations(labs, 2))


def test_black_and_white_are_a_hundred_apart():
    assert least_distance(["#000000", "#ffffff"], "normal") == pytest.approx(100, abs=0.1)


def test_red_and_green_of_one_lightness_meet_in_deuteranopia():
    """The simulation can fail: it detects colours that are too close."""
    bad = ["#c0392b", "#6f7b1e"]
    assert least_distance(bad, "normal") > 40
    assert least_distance(bad, "deuteranopia") < 15


@pytest.mark.parametrize("sight", SIGHTS)
def test_engines_stay_apart(sight):
    engines = [style(name).colour for name in ENGINES]
    assert len(engines) == 3
    assert least_distance(engines, sight) > 15


@pytest.mark.parametrize("sight", SIGHTS)
def test_an_engine_and_an_exact_solution_stay_apart(sight):
    engines = [style(name).colour for name in ENGINES]
    exact = [style(name).colour for name in names() if name not in ENGINES]
    assert min(least_distance([a, b], sight) for a in engines for b in exact) > 15


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("count", range(2, 7))
def test_variants_stay_apart(count, sight):
    assert least_distance([one.colour for one in variant_styles(count)], sight) > 15


@pytest.mark.parametrize("sight", SIGHTS)
def test_terms_of_energy_stay_apart(sight):
    assert least_distance(TERMS.values(), sight) > 9


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("name", [FIELD, DIFFERENCE])
def test_diverging_colours_darken_evenly_to_ends_that_stay_apart(name, sight):
    colours = matplotlib.colormaps[name](np.linspace(0, 1, 21))
    lightness = np.array([seen(colour[:3], sight)[0] for colour in colours])
    assert lightness.argmax() == 10 and lightness[10] > 95
    assert (np.diff(lightness[:11]) > 0).all() and (np.diff(lightness[10:]) < 0).all()
    for near in (0, 3, 6):  # equal sizes of either sign
        assert least_distance([colours[near][:3], colours[-1 - near][:3]], sight) > 15
