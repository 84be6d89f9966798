"""A row that runs away is stopped within its steps, and the line says when, where and why."""

import pytest

import dem
from cases.errors import StoppedError


def test_a_couple_on_three_blocks_runs_away(row, plain):
    """Its fastest mode swings the outer blocks across, and turns the inner one: the fastest block
    is the one that moves by the most m/s. Speeds are looked at after 64 steps, of which the first
    sample alone is sound."""
    scene = row(
        pillar__length=1.5,
        load={"shape": "step", "amplitude": 1e3, "direction": [1, 0, 0], "arm": 0.1},
        record={"stress": [0.5], "velocity": [0.25, 0.75], "interval": 1e-3},
        time__duration=0.1,
        numerics__dem={"step_fraction": 2.3, "allow_unstable": True},
    )
    with pytest.raises(StoppedError, match=r"ran away .* step 64 .* at y = 0\.25 m") as error:
        dem.simulate(scene)
    assert error.value.samples == 1
    assert not error.value.result.displacement.values.any()
