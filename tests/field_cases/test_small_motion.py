"""A roof wedge falls four metres onto a floor (a user's tunnel; both engines let it fall through).

Contacts and areas are those of the initial state: what moves beyond 2 % of the smaller block is not
what the result would show, and a run stops with exit code 3. A wedge that nothing holds falls
g t^2 / 2, so that it is 2 % of sqrt(A) away at t = sqrt(0.04 sqrt(A) / g).
"""

import numpy as np
import pytest

from jointwave import load, simulate
from jointwave.cases.errors import StoppedError

WEDGE = {
    "title": "a roof wedge above a floor",
    "domain": {
        "size": [20.0, 16.0],
        "openings": [[[7.0, 4.0], [13.0, 4.0], [13.0, 8.0], [7.0, 8.0]]],
        "non_convex": "cut",
    },
    "rock": {"density": 2500.0, "intact_modulus": 2e10, "intact_poisson": 0.25},
    "joint_sets": [
        {
            "name": name, "dip": dip, "through": [10.0, 12.0],
            "normal_stiffness": 1e10, "shear_stiffness": 5e9, "friction_angle": 10.0,
            "tension": False,
        }
        for name, dip in (("left", 60.0), ("right", 120.0))
    ],
    "boundaries": dict.fromkeys(("left", "right", "bottom"), "fixed"),
    "gravity": {"static": False},
    "time": {"duration": 0.3},
    "record": {"points": [[10.0, 8.5], [10.0, 3.0]]},
    "numerics": {"continuum": {"size": 2.0}},
}  # fmt: skip
AREA = 0.5 * 4.0 * 2 * 4.0 / np.tan(np.radians(60.0))  # apex 4 m above the roof

#: A slab of 4 x 1 m that nothing holds falls onto another, 10 mm below it, between joints that let
#: it slip: it overlaps that by 1 % after 20 mm, before 40 mm, 2 % of it.
SLOT = {
    "title": "a slab above a slot",
    "domain": {
        "size": [12.0, 2.01],
        "openings": [[[4.0, 1.0], [8.0, 1.0], [8.0, 1.01], [4.0, 1.01]]],
    },
    "rock": {"density": 2500.0, "intact_modulus": 2e10, "intact_poisson": 0.0},
    "joint_sets": [
        {
            "name": "cross", "dip": 90.0, "through": [4.0, 0.0], "spacing": 4.0,
            "normal_stiffness": 1e9, "shear_stiffness": 1.0,
        }
    ],
    "boundaries": dict.fromkeys(("left", "right", "bottom"), "fixed"),
    "gravity": {"static": False},
    "time": {"duration": 0.2},
    "record": {"points": [[6.0, 1.5]]},
    "numerics": {"continuum": {"size": 2.0}},
}  # fmt: skip


@pytest.mark.parametrize("solver", ["dem", "continuum-jointed"])
def test_a_falling_wedge_stops_the_run(solver):
    with pytest.raises(StoppedError) as stopped:
        simulate(load(WEDGE), solver)
    words, result = str(stopped.value), stopped.value.result
    assert "has moved by" in words and "numerics.allow_large_motion = true" in words
    at = float(words.split("by t = ")[1].split(" s")[0])
    reached = np.sqrt(2 * 0.02 * np.sqrt(AREA) / 9.81)
    assert reached < at < reached + 0.3 / 20 + 1e-3  # looked at twenty times
    moved = float(words.split("has moved by ")[1].split(" m")[0])
    assert moved == pytest.approx(9.81 * at**2 / 2, rel=0.02)
    assert reached - 0.3 / 20 - 1e-3 < result.time.values[-1] < reached
    fall = result.displacement.values[0, -1, 1]
    assert fall == pytest.approx(-9.81 * result.time.values[-1] ** 2 / 2, rel=0.02)


@pytest.mark.parametrize("solver", ["dem", "continuum-jointed"])
def test_who_says_so_goes_on(solver):
    whole = simulate(load(WEDGE, changes={"numerics.allow_large_motion": True}), solver)
    assert whole.displacement.values[0, -1, 1] == pytest.approx(-9.81 * 0.3**2 / 2, rel=0.02)


@pytest.mark.parametrize("solver", ["dem", "continuum-jointed"])
def test_blocks_that_meet_others_than_their_neighbours_stop_the_run(solver):
    with pytest.raises(StoppedError, match=r"overlaps block [0-9]+, which it did not") as stopped:
        simulate(load(SLOT), solver)
    at = float(str(stopped.value).split("by t = ")[1].split(" s")[0])
    assert np.sqrt(2 * 0.02 / 9.81) < at < np.sqrt(2 * 0.04 / 9.81)


def test_exit_code_and_one_line(jointwave, tmp_path, in_toml):
    path = tmp_path / "wedge.toml"
    path.write_text(in_toml(WEDGE))
    stopped = jointwave("run", path, "--out", tmp_path, code=3)
    line = stopped.err.splitlines()[-1]  # after what is warned of
    assert "block" in line and "0.02" in line
