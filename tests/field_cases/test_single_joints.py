"""A rigid block on one joint, as it is given: nothing sends waves, and no block need be cut.

The slope of Yade's answers 4102 and 4142 and of cb-geo's pull request 3, as tilted gravity: at 20
degrees a block stays with friction of 21 degrees, and slides with 19 at g (sin 20 - cos 20 tan 19).
"""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.engines import solve

TILT = np.radians(20.0)


def slope(friction, **numerics):
    """Return a block of 4 m x 2 m on a fixed one, 1 m thick."""
    law = {"normal_stiffness": 1e9, "shear_stiffness": 1e9, "tension": False}
    return load_tables(
        {
            "title": "a block on a plane",
            "domain": {"size": [4.0, 3.0]},
            "rock": {"density": 2500.0, "intact_modulus": 5e10},
            "joint_sets": [
                {"name": "base", "dip": 0.0, "through": [2.0, 1.0], **law}
                | {"friction_angle": friction}
            ],
            "gravity": {"direction": [np.sin(TILT), -np.cos(TILT)], "static": friction > 20},
            "boundaries": {"bottom": "fixed"},
            "time": {"duration": 0.5},
            "record": {"points": [[2.0, 2.0]], "joints": [[2.0, 1.0]]},
            "numerics": numerics,
        }
    )


@pytest.mark.parametrize("block", [None, 4.0, 100.0])
def test_a_block_stays_as_a_whole(block):
    """On average rho g h cos 20 and rho g h sin 20 at the joint, which cannot slide."""
    found = solve("dem", slope(21.0, dem={} if block is None else {"block": block}))
    weight = 2500.0 * 9.81 * 2.0 * np.array([np.cos(TILT), np.sin(TILT)])
    assert found.traction.values[0, 0] == pytest.approx(weight, rel=1e-5)
    assert np.abs(found.velocity.values).max() < 1e-7


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
def test_a_block_slides_as_a_whole(engine):
    """Gravity at once: once the block moves, its speed grows at 0.1811 m/s2; 1 % for the bounce on
    its joint, of period 2 pi sqrt(rho h / k_n) = 14 ms, that is left."""
    found = solve(engine, slope(19.0))
    speed, times = found.velocity.values[0, :, 0], found.time.values
    slides = times > 0.1
    grows = 9.81 * (np.sin(TILT) - np.cos(TILT) * np.tan(np.radians(19.0)))
    assert grows == pytest.approx(0.1811, rel=1e-3)
    assert np.polyfit(times[slides], speed[slides], 1)[0] == pytest.approx(grows, rel=0.01)
