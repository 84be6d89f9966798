"""A joint that slips: a block on an incline."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.compare.exact.blocks import sliding_block


def incline(pillar, slope):
    """Return two blocks on a slope whose tangent is `slope` times that of the friction angle."""
    beta = np.arctan(slope * np.tan(np.radians(30.0)))
    return pillar(
        load={"shape": "step", "amplitude": 0.0},
        pillar__length=1.0,
        motion__rotation="none",
        ends__end="fixed",
        joints={"friction_angle": 30.0, "damping_ratio": 1.0},
        gravity={"direction": [np.sin(beta), np.cos(beta), 0.0], "static": False},
        time__duration=0.1,
        record={"stress": [0.5], "velocity": [0.25], "interval": 1e-3},
    )


@pytest.mark.parametrize("slope", [0.98, 1.001])
def test_a_block_slides_above_the_friction_angle_alone(pillar, slope):
    """By g (sin - cos tan(phi)) to 1e-6 g, once the dashpots have stilled the normal vibration;
    below, it stands still and its shear force is all of m g sin(beta).

    Two blocks on their half spring, at the damping ratio 1: it decays as exp(-(2 - sqrt(2)) w t),
    w = sqrt(k / m) = 2700 1/s, below 1e-16 from 0.05 s on.
    """
    scene = incline(pillar, slope)
    assert sliding_block.applies(scene)
    result, exact = dem.simulate(scene), sliding_block.solve(scene)
    v, known = (x.velocity.values[0, :, 0] for x in (result, exact))
    expected = (known[-1] - known[-51]) / 0.05
    assert (v[-1] - v[-51]) / 0.05 == pytest.approx(expected, abs=1e-6 * 9.81)
    if slope < 1:
        assert np.abs(result.velocity.values[0, -10:]).max() < 1e-9
        assert result.shear.values[0, -1, 0] == pytest.approx(
            exact.shear.values[0, -1, 0], rel=1e-9
        )
