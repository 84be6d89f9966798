"""Interactive figures' parts: numbers, dashes, axes."""

import numpy as np
import pytest

from compare.engines import names
from compare.figures.charts import interactive
from compare.figures.charts.chart import Subplot
from compare.figures.style import Style, style
from compare.figures.units import FINE, unit_for


def test_packed_numbers_come_back():
    values = np.arange(-6.0, 6.0).reshape(3, 4)
    packed = interactive.packed(values)
    assert packed["shape"] == "3,4" and packed["dtype"] == "f4"
    np.testing.assert_array_equal(interactive.unpacked(packed), values)


@pytest.mark.parametrize("bits", [8, 14, 22])
@pytest.mark.parametrize("size", [1e-30, 1.0, 1e30])
def test_numbers_are_rounded_to_so_many_bits_of_the_mantissa(bits, size):
    noise = size * np.random.default_rng(7).standard_normal(1000)
    found = interactive.unpacked(interactive.packed(noise, bits))
    np.testing.assert_allclose(found, noise, rtol=2.0 ** -(bits + 1) + 2.0**-23)
    assert not (found.view("<u4") & ((1 << (23 - bits)) - 1)).any()


def test_what_is_no_number_stays_so():
    found = interactive.unpacked(interactive.packed(np.array([np.nan, np.inf, -1.0])))
    assert np.isnan(found[0]) and np.isinf(found[1]) and found[2] == -1


def test_even_places_are_two_numbers_and_others_all():
    assert interactive.places("x", np.array([1.0, 1.5, 2.0])) == {"x0": 1.0, "dx": 0.5}
    uneven = interactive.places("y", np.array([0.0, 1.0, 3.0]))
    np.testing.assert_array_equal(interactive.unpacked(uneven["y"]), [0, 1, 3])


@pytest.mark.parametrize(("samples", "most"), [(241, 240), (242, 240), (2401, 240), (3, 240)])
def test_thinned_keeps_the_first_and_at_most_so_many(samples, most):
    kept = np.arange(samples)[interactive.thinned(samples, most)]
    assert kept[0] == 0 and len(kept) <= most + 1
    assert len(kept) > min(samples, most) / 2


def painted(lengths, places):
    """Return whether each place along a line is painted by dashes, as SVG defines them."""
    edges = np.cumsum(lengths)
    return np.searchsorted(edges, places % edges[-1], side="right") % 2 == 0


@pytest.mark.parametrize("name", [n for n in names() if style(n).dashes != "-"])
def test_dashes_begin_where_they_begin_in_print(name):
    """matplotlib begins `offset` into a pattern; SVG's own pattern must be turned by that."""
    drawn = style(name)
    offset, lengths = drawn.dashes
    turned = [float(x.removesuffix("px")) for x in interactive.line_style(drawn)["dash"].split(",")]
    assert len(turned) % 2 == 0  # SVG repeats an odd pattern with dashes and gaps exchanged
    places = drawn.width * (np.arange(0, 40, 0.25) + 0.1)
    expected = painted(drawn.width * np.array(lengths), places + drawn.width * offset)
    np.testing.assert_array_equal(painted(turned, places), expected)


def test_a_solid_line_has_no_dashes():
    assert "dash" not in interactive.line_style(Style("#000000", 1.0, "-", 1))


def test_panels_stand_apart_under_each_other():
    subplots = [
        Subplot("a", "m", [], 2.0),
        Subplot("a phone has no room for all of " * 2, "m", [], 0.8),
    ]
    layout = interactive.layout(subplots, {})
    low, high = layout["yaxis"]["domain"], layout["yaxis2"]["domain"]
    assert low[1] == 1 and low[0] > high[1] and high[0] == pytest.approx(0, abs=1e-12)
    inner = layout["height"] - layout["margin"]["t"] - layout["margin"]["b"]
    assert (low[1] - low[0]) * inner == pytest.approx(190)
    assert (high[1] - high[0]) * inner == pytest.approx(76)
    gap = (low[0] - high[1]) * inner
    assert gap == pytest.approx(interactive.GAP + 2 * interactive.LINE)  # room for two lines
    assert layout["xaxis"]["anchor"] == "y2"


@pytest.mark.parametrize(
    ("largest", "name"), [(2.1e6, "MPa"), (999.0, "Pa"), (1.7e5, "kPa"), (1e-12, "Pa")]
)
def test_units_suit_the_largest_number(largest, name):
    assert unit_for("Pa", largest).name == name


@pytest.mark.parametrize("largest", [1.234e6, 999.0, 1.0, 3e-15, 7e13])
def test_images_are_as_fine_as_eyes_and_no_finer(largest):
    """Half a last place from what is meant; from 300 to 3000 last places on either side of zero."""
    values = np.linspace(-largest, largest, 100_001)
    unit = unit_for("Pa", largest)
    drawn = unit.drawn(values)
    assert np.abs(drawn * unit.size - values).max() <= 1.001 * largest / FINE / 2
    assert 2 * FINE <= len(np.unique(drawn)) <= 20 * FINE + 1


def test_of_nothing_nothing_is_drawn():
    assert not unit_for("Pa", 0.0).drawn(np.zeros(3)).any()
