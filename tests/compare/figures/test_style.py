"""Units of drawn numbers; colours as readers with colour blindness see them (Machado, Oliveira &
Fernandes 2009)."""

from itertools import combinations, product

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from jointwave.compare.engines import ENGINES, EXACT
from jointwave.compare.figures.charts.waveforms import variant_styles
from jointwave.compare.figures.style import DIFFERENCE, FIELD, TERMS, style, unit_for

#: Of linear RGB, at full severity, row by row; normal sight first.
SIGHTS = {
    "normal": [1, 0, 0, 0, 1, 0, 0, 0, 1],
    "protanopia": [
        *(0.152286, 1.052583, -0.204868),
        *(0.114503, 0.786281, 0.099216),
        *(-0.003882, -0.048116, 1.051998),
    ],
    "deuteranopia": [
        *(0.367322, 0.860646, -0.227968),
        *(0.280085, 0.672501, 0.047413),
        *(-0.011820, 0.042940, 0.968881),
    ],
    "tritanopia": [
        *(1.255528, -0.076749, -0.178779),
        *(-0.078411, 0.930809, 0.147602),
        *(0.004733, 0.691367, 0.303900),
    ],
}
XYZ = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)  # of linear sRGB
WHITE = XYZ.sum(axis=1)

ENGINE_COLOURS, EXACT_COLOURS = ([style(name).colour for name in some] for some in (ENGINES, EXACT))
VARIANTS = {count: [one.colour for one in variant_styles(count)] for count in range(2, 7)}
#: By name pairs of colours that are told apart, and the least distance of each.
APART = {
    "engines": ([*combinations(ENGINE_COLOURS, 2)], 15),
    "an engine and an exact solution": ([*product(ENGINE_COLOURS, EXACT_COLOURS)], 15),
    "terms of energy": ([*combinations(TERMS.values(), 2)], 9),
    **{f"{n} variants": ([*combinations(some, 2)], 15) for n, some in VARIANTS.items()},
}


def seen(colour, sight):
    """Return a colour in CIELAB as it is seen."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    x = XYZ @ np.clip(np.reshape(SIGHTS[sight], (3, 3)) @ linear, 0, 1) / WHITE
    f = np.where(x > (6 / 29) ** 3, np.cbrt(x), x / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def distance(one, other, sight):
    """Return the distance of two colours in CIELAB; 2.3 is just noticeable."""
    return np.linalg.norm(seen(one, sight) - seen(other, sight))


def test_distances_are_those_that_are_known():
    """White is 100 from black; red and green of one lightness meet in deuteranopia, so that the
    simulation detects colours that are too close."""
    assert distance("#000000", "#ffffff", "normal") == pytest.approx(100, abs=0.1)
    assert distance("#c0392b", "#6f7b1e", "normal") > 40
    assert distance("#c0392b", "#6f7b1e", "deuteranopia") < 15


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("name", APART)
def test_colours_stay_apart(name, sight):
    pairs, least = APART[name]
    assert pairs and min(distance(*pair, sight) for pair in pairs) > least


@pytest.mark.parametrize("sight", SIGHTS)
@pytest.mark.parametrize("name", [FIELD, DIFFERENCE])
def test_diverging_colours_darken_evenly_to_ends_that_stay_apart(name, sight):
    colours = matplotlib.colormaps[name](np.linspace(0, 1, 21))[:, :3]
    lightness = np.array([seen(colour, sight)[0] for colour in colours])
    assert lightness.argmax() == 10 and lightness[10] > 95
    assert (np.diff(lightness[:11]) > 0).all() and (np.diff(lightness[10:]) < 0).all()
    for near in (0, 3, 6):  # equal sizes of either sign
        assert distance(colours[near], colours[-1 - near], sight) > 15


@pytest.mark.parametrize(
    ("largest", "name"), [(2.1e6, "MPa"), (999.0, "Pa"), (1.7e5, "kPa"), (1e-12, "Pa")]
)
def test_units_suit_the_largest_number(largest, name):
    assert unit_for("Pa", largest).name == name
