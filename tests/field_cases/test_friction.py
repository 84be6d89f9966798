"""Blocks that stick and slide on a plane under their own weight, as users of discrete-element and
multibody codes ask for them (Yade's answers 4102 and 4142, MuJoCo's issue 3328, newton's 943): the
right answers are Coulomb's."""

import numpy as np
import pytest

import jointwave

ENGINES = ("dem", "continuum-jointed")
DENSITY, SIDE, GRAVITY, SHEAR_STIFFNESS = 2500.0, 2.0, 9.81, 4e8
SCENE = f"""
title = "A block on a plane"
[domain]
size = [{SIDE}, {SIDE}]
[rock]
density = {DENSITY}
intact_modulus = 5.0e10
[[joint_sets]]
name = "plane"
dip = 0.0
through = [1.0, 1.0]
normal_stiffness = 1.0e9
shear_stiffness = {SHEAR_STIFFNESS}
friction_angle = {{friction}}
tension = false
damping_ratio = 0.3
[gravity]
direction = [{{sine!r}}, {{minus_cosine!r}}]
static = {{static}}
[boundaries]
bottom = "fixed"
[time]
duration = {{duration}}
[record]
points = [[1.0, 1.5]]
joints = [[1.0, 1.0]]
interval = 0.001
"""


@pytest.fixture
def block(tmp_path):
    """Return a function of the slope and the friction angle (degrees), of how gravity acts and of
    the duration (s), that gives the scene; gravity is tilted, not the plane."""

    def scene(slope, friction, static, duration):
        sine, cosine = np.sin(np.radians(slope)), np.cos(np.radians(slope))
        text = SCENE.format(
            friction=friction,
            sine=float(sine),
            minus_cosine=-float(cosine),
            static=str(static).lower(),
            duration=duration,
        )
        (file := tmp_path / "block.toml").write_text(text)
        return jointwave.load(file)

    return scene


@pytest.mark.parametrize("engine", ENGINES)
def test_a_joint_below_its_strength_holds_for_ten_seconds(engine, block):
    """Shear of 2 % of the strength, set on at once: the joint comes to rest at W sin / (K_s A),
    within 0.1 % where the rock around it bends, and stays there to round-off."""
    slip = jointwave.simulate(block(1.0, 40.0, False, 10.0), engine).slip.values[0]
    weight = DENSITY * GRAVITY * SIDE * SIDE / 2
    exact = weight * np.sin(np.radians(1.0)) / (SHEAR_STIFFNESS * SIDE)
    half = slip.size // 2
    assert abs(slip[-1]) == pytest.approx(exact, rel=1e-3)
    assert np.abs(slip[half:] - slip[-1]).max() < 1e-12 * exact


@pytest.mark.parametrize("engine", ENGINES)
def test_a_block_below_its_friction_angle_stays(engine, block):
    """From the static state it moves by less than 1e-8 m/s."""
    result = jointwave.simulate(block(20.0, 21.0, True, 0.1), engine)
    assert np.abs(result.velocity.values).max() < 1e-8


@pytest.mark.parametrize("engine", ENGINES)
def test_a_block_above_its_friction_angle_slides_as_coulomb_says(engine, block):
    """At g (sin a - cos a tan phi) = 0.1811 m/s2, once it has settled on its joint: within 1 % in
    the mean of the last tenth of a second."""
    result = jointwave.simulate(block(20.0, 19.0, False, 0.3), engine)
    speed, time = result.velocity.values[0, :, 0], result.time.values
    slope, friction = np.radians((20.0, 19.0))
    exact = GRAVITY * (np.sin(slope) - np.cos(slope) * np.tan(friction))
    late = time >= 0.2
    found = (speed[late][-1] - speed[late][0]) / (time[late][-1] - time[late][0])
    assert found == pytest.approx(exact, rel=0.01)
