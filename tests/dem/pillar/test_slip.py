"""Joints that slip: a harmonic shear wave, and a block on an incline."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.compare.exact.blocks import sliding_block

PERIOD = 0.04  # s: 64 blocks a wavelength
WAVE = {
    "pillar__length": 40.0,
    "motion__rotation": "none",
    "ends": {"start": "matched", "end": "matched"},
    "load": {
        "shape": "sine",
        "amplitude": 2e6,
        "period": PERIOD,
        "cycles": 8,
        "direction": [0.6, 0.0, -0.8],
    },
    "time__duration": 0.24,
    "record": {"stress": [20.0], "velocity": [], "interval": 1e-4},
}
SHARES = {
    0.5: (0.6253, 0.4159, 0.6603),
    0.1: (0.1384, 0.8746, 0.4647),
    0.02: (0.0282, 0.9746, 0.2221),
}


def scalar(result):
    """Return the shear stress along the load, Pa."""
    return result.shear.values @ np.array([0.6, -0.8])


def with_strength(pillar, tau):
    """Return the wave of 1 MPa that meets a joint of this strength (Pa) at 20 m."""
    return pillar(**WAVE, soft_layers=[{"y": 20.0, "cohesion": tau, "friction_angle": 0.0}])


@pytest.mark.parametrize("a", SHARES)
def test_harmonic_wave_at_a_joint_that_slips(pillar, a):
    """T, R and A of Miller (1978) within 1 %: 64 blocks a wavelength, 13 of the fifth harmonic.

    The reflected wave is what slip changes in front of the joint; A^2 is the share of the incident
    energy that friction takes in a cycle.
    """
    incident = scalar(dem.simulate(with_strength(pillar, 1e9)))[0]
    scene = with_strength(pillar, a * 1e6)
    result = dem.simulate(scene)
    there = scalar(result)[0]
    cycle = slice(-round(PERIOD / 1e-4), None)
    whole = np.mean(incident[cycle] ** 2)
    T = np.sqrt(np.mean(there[cycle] ** 2) / whole)
    R = np.sqrt(np.mean((there - incident)[cycle] ** 2) / whole)
    friction = result.energy.sel(term="friction").values
    z, area = 2400.0 * 800.0, 0.25
    A = np.sqrt((friction[-1] - friction[-1 - round(PERIOD / 1e-4)]) / (whole * PERIOD * area / z))
    assert pytest.approx(SHARES[a], rel=0.01) == (T, R, A)
    assert np.abs(there).max() <= a * 1e6 * (1 + 1e-9)


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
