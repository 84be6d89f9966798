"""Every engine shows its keeper all that changes: a run ended anywhere goes on to the same bits."""

import pytest

from jointwave.cases.errors import InterruptedRun
from jointwave.compare.engines import solve

SHORT = {
    "pillar__length": 10.0,
    "time__duration": 4e-3,
    "record": {"stress": [0.0, 5.0], "velocity": [0.25], "interval": 1e-4, "fields": 1e-3},
    "joints": {"damping_ratio": 0.02, "tension": False},
    "ends__end": "quiet",
    "numerics__continuum__elements_per_block": 2,
}
SLIPS = {"damping_ratio": 0.02, "friction_angle": 30.0, "cohesion": 1e5}

#: Who solves a scene, and what is changed.
RUNS = {
    "chain": ("dem", {}),
    "chain of fourth order": (
        "dem",
        {"joints": {}, "ends__end": "free", "numerics__dem__scheme": "fourth-order"},
    ),
    "row in space": (
        "dem",
        {"joints": SLIPS, "ends__end": "free", "load__direction": [0.6, 0.8, 0.0]},
    ),
    "explicit rock": ("continuum-jointed", {"numerics__continuum__scheme": "explicit"}),
    "rock of a quality factor": (
        "continuum-jointed",
        {"rock__quality_factor": 20.0, "numerics__continuum__scheme": "explicit"},
    ),
    "implicit rock": ("continuum-jointed", {"numerics__continuum__scheme": "implicit"}),
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_goes_on_to_the_same_bits(pillar, keeper_at, name):
    """With dashpots, joints that open or slip, ends, the ledger and snapshots."""
    engine, changes = RUNS[name]
    scene, keeper = pillar(**SHORT | changes), keeper_at(15)
    with pytest.raises(InterruptedRun):
        solve(engine, scene, keeper=keeper)
    assert 15 <= keeper.done < 40
    whole, again = solve(engine, scene), solve(engine, scene, keeper=keeper)
    assert whole.data_vars.keys() == again.data_vars.keys()
    for key in whole.data_vars:
        assert whole[key].equals(again[key]), key
