"""What a spatial scene starts from, and what waves on top of it do."""

import numpy as np

from jointwave import dem
from jointwave.cases.material.calibrate import calibrate

UNLOADED = {"load": {"shape": "step", "amplitude": 0.0, "direction": [1, 0, 0]}}
FIELDS = ("stress", "shear", "velocity", "displacement", "rotation")
G = 9.81


def test_row_under_its_weight_stays_at_rest(row):
    """A leaning column on a fixed end: what is out of balance by 1e-8 W moves it by as little."""
    scene = row(
        **UNLOADED,
        gravity={"direction": [0.6, 0.8, 0.0]},
        ends__end="fixed",
        joints__damping_ratio=0.05,
    )
    p, result = calibrate(scene), dem.simulate(scene)
    weight = p.block_count * p.block_mass * G
    moved = result.displacement.values - result.displacement.values[:, :1]
    assert result.attrs["static_out_of_balance"] <= 1e-8
    assert np.abs(moved).max() < 1e-7 * np.abs(result.displacement.values).max()
    stress, shear = (p.block_mass * G / p.area * np.array([0, 4, 10, 16]) * k for k in (0.8, 0.6))
    assert np.abs(result.stress.values - stress[:, None]).max() < 1e-6 * weight / p.area
    assert np.abs(result.shear.values[..., 0] - shear[:, None]).max() < 1e-6 * weight / p.area


def test_wave_on_top_of_gravity_is_the_wave_without(row):
    """Linear joints superpose: they differ by what the static state is out of balance by.

    1e-11 of the weight of 47 kN, beside a wave of 25 kN, swung up a hundredfold by bending.
    """
    tight = {"numerics__dem__static_tolerance": 1e-11}
    held = {"ends__end": "fixed", "joints__damping_ratio": 0.05}
    heavy = dem.simulate(row(**held, **tight, gravity={"direction": [0.6, 0.8, 0.0]}))
    light = dem.simulate(row(**held))
    for name in FIELDS:
        wave = heavy[name].values - heavy[name].values[:, :1] + light[name].values[:, :1]
        error = np.abs(wave - light[name].values).max() / np.abs(light[name].values).max()
        assert error < 1e-8


def test_tighter_balance_gives_a_smaller_difference(row):
    """numerics.dem.static_tolerance says how far the static state may be out of balance."""
    still = {**UNLOADED, "gravity": {"direction": [1, 0, 0]}, "ends__end": "fixed"}
    scenes = [row(**still, numerics__dem__static_tolerance=tolerance) for tolerance in (1e-5, 1e-8)]
    rough, fine = (dem.simulate(scene).attrs for scene in scenes)
    assert fine["static_out_of_balance"] <= 1e-8 < rough["static_out_of_balance"] <= 1e-5
    assert rough["static_steps"] < fine["static_steps"]


def test_free_fall_is_a_parabola(row):
    """Gravity that acts suddenly: u = g t^2 / 2 along it, to round-off from the first step on."""
    direction = [0.48, 0.6, -0.64]
    result = dem.simulate(row(**UNLOADED, gravity={"direction": direction, "static": False}))
    t = result.time.values[None, :, None]
    assert np.abs(result.displacement.values - G * t**2 / 2 * direction).max() < 1e-12
    assert np.abs(result.velocity.values - G * t * direction).max() < 1e-11
