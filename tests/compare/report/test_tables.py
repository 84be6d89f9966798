"""Tables of the page from synthetic results with known distances."""

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.misfit.pairs import Comparison, measure
from jointwave.compare.report.tables import misfit_table


def test_every_component_at_a_receiver_has_a_column_of_its_own(pillar):
    """Of motion in space; they are 1, 2 and 3 % off."""
    wave = np.sin(np.linspace(0, 9, 200))[None, :, None] * [1.0, 1.0, 1.0]
    results = {
        name: xr.Dataset(
            {"velocity": (("velocity_y", "time", "axis"), wave * off)},
            {"velocity_y": [20.0], "time": 1e-3 * np.arange(200.0), "axis": ["x", "y", "z"]},
        )
        for name, off in {"dem": [1.01, 1.02, 1.03], "continuum-jointed": 1.0}.items()
    }
    (row,) = misfit_table([Comparison(pillar(), results, {}, measure(results))]).to_dict("records")
    found = {name.rpartition(", ")[2]: misfit for name, misfit in row.items()}
    assert found == {
        f"velocity {axis} at 20 m (%)": pytest.approx(off)
        for axis, off in zip("xyz", (1, 2, 3), strict=True)
    }
