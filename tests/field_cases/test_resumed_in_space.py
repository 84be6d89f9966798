"""A run of blocks in space that ends half-way and goes on gives the very bits of one that does not:
under stress or weight, with laws that remember, weakly reflecting sides, snapshots and the ledger.
"""

import pytest

import jointwave as jw
from jointwave.cases.errors import InterruptedRun
from jointwave.compare.engines import solve
from tests.field_cases.scenes import ENGINES, mass

STIFF = {"normal_stiffness": 1e10, "shear_stiffness": 5e9, "spacing": 1.0}
SLIPS = {"friction_angle": 25.0, "tension": False}
WEAKENS = SLIPS | {"dynamic_friction_angle": 10.0, "weakening_distance": 1e-4}
DILATES = {"dilation_angle": 8.0, "dilation_distance": 1e-3, "damping_ratio": 0.02}
AGES = {"direct_effect": 0.01, "evolution_effect": 0.015, "critical_slip_distance": 1e-5}
AGES |= {"friction_angle": 25.0, "reference_rate": 1e-6}
BREAKS = {"friction_angle": 25.0, "cohesion": 2e5, "tensile_strength": 1e5, "fracture_energy": 1.0}
CLOSES = {"maximum_closure": 3e-4, "damping_ratio": 0.05}
BASE = {"kind": "base", "side": "bottom", "quantity": "velocity", "direction": [0.6, 0.0, 0.8]}
SHAKEN = {"loads": [BASE | {"shape": "ricker", "period": 0.004, "amplitude": 0.2}]}

#: By name: the laws of beds and walls, and what else is changed; None leaves a table out.
RUNS = {
    "weakening, dilation, softening and closure, under weight": (
        BREAKS | CLOSES,
        WEAKENS | DILATES,
        SHAKEN | {"prestress": None, "gravity": {"static": False}},
    ),
    "rate and state on a quiet base": (AGES, AGES, SHAKEN | {"boundaries": {"bottom": "quiet"}}),
}


def rock(beds, walls, changes):
    """Return eight blocks of 1 m by 2 m by 1 m that an oblique blow strikes."""
    blow = {"kind": "force", "quantity": "force", "at": [0.6, 0.9, 4.0], "shape": "half-sine"}
    tables = mass(
        *(2.0, 2.0),
        domain={"size": [2.0, 2.0, 4.0]},
        joint_sets=[
            {"name": "beds", "dip": 0.0} | STIFF | beds,
            {"name": "walls", "dip": 90.0, "dip_direction": 90.0} | STIFF | walls,
        ],
        prestress={"xx": 5e5, "yy": 0.0, "zz": 1e6},
        loads=[blow | {"direction": [0.6, 0.0, -0.8], "amplitude": 4e6, "period": 0.004}],
        boundaries={"bottom": "fixed"},
        time={"duration": 0.006},
        numerics={"continuum": {"scheme": "explicit", "size": 1.0, "order": 1}},
        record={
            "points": [[0.5, 0.5, 3.5], [1.5, 1.5, 1.5]],
            "joints": [[0.5, 0.5, 3.0]],
            "interval": 1e-4,
            "fields": 1e-3,
        },
    )
    return jw.load({key: one for key, one in (tables | changes).items() if one is not None})


EACH = [(name, engine) for name in RUNS for engine in ENGINES]


@pytest.mark.parametrize(("name", "engine"), EACH)
def test_a_run_in_space_goes_on_to_the_same_bits(engine, name, keeper_at, plain):
    scene, keeper = rock(*RUNS[name]), keeper_at(40)
    with pytest.raises(InterruptedRun):
        solve(engine, scene, keeper=keeper)
    assert 40 <= keeper.done < 60
    whole, again = solve(engine, scene), solve(engine, scene, keeper=keeper)
    assert whole.data_vars.keys() == again.data_vars.keys()
    assert float(abs(whole.slip).max()) > 5e-7
    for key in whole.data_vars:
        assert whole[key].equals(again[key]), key
