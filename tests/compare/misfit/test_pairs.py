"""Which rows a pair of results gives: every quantity that both have and that is not round-off."""

import numpy as np
import pytest

from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.pairs import measure

RECORD = {"record__stress": [5.0], "record__velocity": [5.25], "time__duration": 0.01}


def rows(result, name):
    off = result.copy(deep=True) * 1.01
    return measure({"dem": off, name: result})


def test_shear_is_measured_and_a_silent_stress_decides_nothing(pillar):
    result = row_of_blocks.solve(pillar(load__direction=[1.0, 0.0, 0.0], **RECORD))
    result["stress"] = result.stress + 1e-12
    found = [row for row in rows(result, "spatial-lattice") if not row.faint]
    places = [
        ("shear x", 5.0),
        *((f"{quantity} x", 5.25) for quantity in ("velocity", "displacement")),
        ("rotation z", 5.25),
    ]
    assert [(row.place.named, *row.place.at) for row in found] == places
    assert [row.distance.misfit for row in found] == pytest.approx([0.01] * 4)


def test_every_component_has_a_row_of_its_own(pillar):
    ends = {"ends__start": "matched", "ends__end": "matched"}
    load = {"load__direction": [0.6, 0.8, 0.0], "motion__rotation": "none"}
    result = row_of_blocks.solve(pillar(**load, **ends, **RECORD | {"time__duration": 0.03}))
    late = result.shift(time=3, fill_value=0.0)
    interval = float(result.time[1])
    found = measure({"dem": late, "spatial-lattice": result})
    assert {row.quantity for row in found} >= {"stress", "shear x", "velocity x", "velocity y"}
    for row in found:
        if not row.quantity.startswith("displacement"):  # which stays where the wave has left it
            assert row.distance.delay == pytest.approx(3 * interval, abs=0.2 * interval)


def test_displacement_is_measured(pillar):
    found = rows(row_of_blocks.solve(pillar(**RECORD)), "lattice")
    assert [row.quantity for row in found] == ["stress", "velocity", "displacement"]
    assert np.isfinite([row.distance.misfit for row in found]).all()
