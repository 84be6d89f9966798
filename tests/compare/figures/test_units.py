"""Units of drawn numbers."""

import pytest

from jointwave.compare.figures.style import unit_for


@pytest.mark.parametrize(
    ("largest", "name"), [(2.1e6, "MPa"), (999.0, "Pa"), (1.7e5, "kPa"), (1e-12, "Pa")]
)
def test_units_suit_the_largest_number(largest, name):
    assert unit_for("Pa", largest).name == name
