"""A row that runs away is stopped within its steps, and the line says when, where and why."""

import pytest

from jointwave import dem
from jointwave.cases.errors import StoppedError


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
    with pytest.raises(StoppedError, match=r"diverged .* step 64 .* at y = 0\.25 m") as error:
        dem.simulate(scene)
    assert error.value.samples == 1
    assert not error.value.result.displacement.values.any()


def test_a_run_that_ends_before_the_speeds_are_looked_at(row, plain):
    """What diverged in 44 steps is found behind the last of them, samples two steps apart."""
    scene = row(
        pillar__length=1.5,
        load={"shape": "step", "amplitude": 1e3, "direction": [0, 1, 0], "at": [0.1, 0.0]},
        record={"stress": [0.5], "velocity": [0.25], "interval": 1.2e-3, "energy": False},
        time__duration=1.2e-3 * 21,
        numerics__dem={"step_fraction": 1.3, "allow_unstable": True},
    )
    with pytest.raises(StoppedError, match=r"diverged at t = 0\.0264 s, step 44 of 0\.0006 s"):
        dem.simulate(scene)


def test_energy_from_nowhere_is_found_at_a_sample(row, plain):
    """Rotations carry the couple's little motion over into the modes that grow."""
    scene = row(
        pillar__length=1.5,
        motion__rotation="finite",
        load={"shape": "step", "amplitude": 1e3, "direction": [1, 0, 0], "arm": 0.1},
        record={"stress": [0.5], "velocity": [0.25], "interval": 1e-3},
        time__duration=0.1,
        numerics__dem={"step_fraction": 1.3, "allow_unstable": True},
    )
    with pytest.raises(StoppedError, match=r"gained energy at t = .* s, step \d+ of 0\.0005 s"):
        dem.simulate(scene)
