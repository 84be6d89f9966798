"""A roof wedge falls four metres onto a floor (a user's tunnel; both engines let it fall through).

Contacts and areas are those of the initial state: what moves beyond 2 % of the smaller block is not
what the result would show, and a run stops with exit code 3. A wedge that nothing holds falls
g t^2 / 2, so that it is 2 % of sqrt(A) away at t = sqrt(0.04 sqrt(A) / g)."""

import numpy as np
import pytest

from jointwave import load, simulate
from jointwave.cases.errors import StoppedError
from tests.field_cases.scenes import ENGINES, SIDES, mass

AREA = 0.5 * 4.0 * 2 * 4.0 / np.tan(np.radians(60.0))  # m2, apex 4 m above the roof
FALLS = {"gravity": {"static": False}, "numerics": {"continuum": {"size": 2.0}}}
FALLS |= {"boundaries": dict.fromkeys(SIDES[:3], "fixed")}


def wedge():
    """Return the tables of the wedge above an opening of 6 m by 4 m."""
    opening = [[7.0, 4.0], [13.0, 4.0], [13.0, 8.0], [7.0, 8.0]]
    law = {"normal_stiffness": 1e10, "shear_stiffness": 5e9, "friction_angle": 10.0}
    law |= {"tension": False, "through": [10.0, 12.0]}
    return mass(
        *(20.0, 16.0),
        domain={"size": [20.0, 16.0], "openings": [opening], "non_convex": "cut"},
        joint_sets=[law | {"name": str(dip), "dip": dip} for dip in (60.0, 120.0)],
        time={"duration": 0.3},
        record={"points": [[10.0, 8.5], [10.0, 3.0]]},
        **FALLS,
    )


def slot():
    """Return a slab of 4 x 1 m that nothing holds, 10 mm above another, between joints that let it
    slip: it overlaps that by 1 % after 20 mm, before 40 mm, 2 % of it."""
    opening = [[4.0, 1.0], [8.0, 1.0], [8.0, 1.01], [4.0, 1.01]]
    cross = {"name": "cross", "dip": 90.0, "through": [4.0, 0.0], "spacing": 4.0}
    return mass(
        *(12.0, 2.01),
        domain={"size": [12.0, 2.01], "openings": [opening]},
        joint_sets=[cross | {"normal_stiffness": 1e9, "shear_stiffness": 1.0}],
        time={"duration": 0.2},
        record={"points": [[6.0, 1.5]]},
        **FALLS,
    )


def stopped_at(words):
    return float(words.split("by t = ")[1].split(" s")[0])


@pytest.mark.parametrize("solver", ENGINES)
def test_a_falling_wedge_stops_the_run_unless_it_may_go_on(solver):
    with pytest.raises(StoppedError) as stopped:
        simulate(load(wedge()), solver)
    words, result = str(stopped.value), stopped.value.result
    assert "numerics.allow_large_motion = true" in words
    at, reached = stopped_at(words), np.sqrt(2 * 0.02 * np.sqrt(AREA) / 9.81)
    assert reached < at < reached + 0.3 / 20 + 1e-3  # looked at twenty times
    moved = float(words.split("has moved by ")[1].split(" m")[0])
    assert moved == pytest.approx(9.81 * at**2 / 2, rel=0.02)
    last = result.time.values[-1]
    assert reached - 0.3 / 20 - 1e-3 < last < reached
    whole = simulate(load(wedge(), changes={"numerics.allow_large_motion": True}), solver)
    for found, end in ((result, last), (whole, 0.3)):
        fall = found.displacement.values[0, -1, 1]
        assert fall == pytest.approx(-9.81 * end**2 / 2, rel=0.02)


@pytest.mark.parametrize("solver", ENGINES)
def test_blocks_that_meet_others_than_their_neighbours_stop_the_run(solver):
    with pytest.raises(StoppedError, match=r"overlaps block [0-9]+, which it did not") as stopped:
        simulate(load(slot()), solver)
    assert np.sqrt(2 * 0.02 / 9.81) < stopped_at(str(stopped.value)) < np.sqrt(2 * 0.04 / 9.81)


def test_exit_code_and_one_line(jointwave, tmp_path, in_toml):
    (path := tmp_path / "wedge.toml").write_text(in_toml(wedge()))
    line = jointwave("run", path, "--out", tmp_path, code=3).err.splitlines()[-1]
    assert "block" in line and "0.02" in line
