"""A softening joint pulled apart takes its fracture energy once (exaDEM's traction test counts it
twice): G_f times its area, by both engines."""

import pytest

import jointwave

SIDE, ENERGY = 0.5, 50.0  # m, J/m2
SCENE = f"""
title = "One joint pulled apart"
[pillar]
length = 2.0
side = {SIDE}
block = 1.0
[rock]
density = 2400.0
p_speed = 2200.0
s_speed = 800.0
intact_modulus = 8.64e10
[joints]
tensile_strength = 2.0e5
fracture_energy = {ENERGY}
[load]
shape = "half-sine"
amplitude = -2.0e6
period = 0.02
[time]
duration = 0.03
[record]
velocity = [0.5]
"""


@pytest.mark.parametrize("engine", ("dem", "continuum-jointed"))
def test_a_joint_pulled_apart_takes_its_fracture_energy_once(engine, tmp_path):
    """Whatever the faces do on the way: softening gives nothing back."""
    (file := tmp_path / "pull.toml").write_text(SCENE)
    energy = jointwave.simulate(jointwave.load(file), engine).energy
    assert float(energy.sel(term="fracture")[-1]) == pytest.approx(ENERGY * SIDE**2, rel=1e-12)
