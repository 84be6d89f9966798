"""What a scene starts from: gravity, prestress, and what waves on top of them do."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate

G = 9.81
DOWN = {"direction": [0, 1, 0]}
NO_LOAD = {"shape": "step", "amplitude": 0.0}


@pytest.mark.parametrize(
    "held, joints",
    [
        ("end", {}),
        ("start", {}),
        ("start", {"tensile_strength": 3e6, "fracture_energy": 1e5}),
    ],
    ids=["standing", "hanging", "hanging by joints that soften"],
)
def test_every_joint_carries_the_weight_beyond_it(pillar, held, joints):
    """Static stress at joint j is j m g / A on a base, and j m g / A less the weight where the
    pillar hangs; it stays, to 1e-8 of the largest."""
    p = calibrate(pillar())
    scene = pillar(
        load=NO_LOAD,
        gravity=DOWN,
        ends={"start": "free", "end": "free", held: "fixed"},
        joints=joints,
        record={"stress": [0.0, *p.joint_y.tolist(), 50.0], "interval": 1e-3},
    )
    result = dem.simulate(scene)
    weight = p.block_mass * G / p.area * np.arange(p.block_count + 1)
    expected = weight if held == "end" else weight - weight[-1]
    assert np.abs(result.stress.values - expected[:, None]).max() < 1e-8 * weight[-1]
    assert result.attrs["static_steps"] == 0
    assert result.attrs["static_out_of_balance"] < 1e-12


@pytest.mark.parametrize("start", ["free", "quiet", "matched"])
def test_wave_on_top_of_gravity_is_the_wave_without(pillar, start):
    """Linear joints superpose: differences are round-off of the static state, 1e-11 of the wave."""
    ends = {"ends": {"start": start, "end": "fixed"}, "joints__damping_ratio": 0.02}
    points = {"record": {"stress": [20.0, 40.0], "velocity": [30.0]}}
    heavy = dem.simulate(pillar(gravity=DOWN, **ends, **points))
    light = dem.simulate(pillar(**ends, **points))
    for name in ("stress", "velocity"):
        wave = heavy[name].values - heavy[name].values[:, :1]
        wave += light[name].values[:, :1]
        assert np.abs(wave - light[name].values).max() < 1e-11 * np.abs(light[name].values).max()


def test_base_in_acceleration_is_gravity_against_it(pillar):
    """In the frame of a base accelerated at a, the pillar has the weight -a: to round-off."""
    held = {"ends__start": "fixed", "record__stress": [0.0, 20.0]}
    base = {"shape": "step", "amplitude": 3.0, "quantity": "acceleration"}
    gravity = {"direction": [0, -1, 0], "acceleration": 3.0, "static": False}
    shaken = dem.simulate(pillar(load=base, **held))
    heavy = dem.simulate(pillar(load=NO_LOAD, gravity=gravity, **held))
    largest = np.abs(heavy.stress.values).max()
    assert np.abs(shaken.stress.values - heavy.stress.values).max() < 1e-9 * largest


@pytest.mark.parametrize("ends", [("free", "free"), ("quiet", "matched"), ("free", "fixed")])
def test_prestressed_pillar_is_at_rest_at_once(pillar, ends):
    """No step is needed, and without a load nothing ever moves."""
    scene = pillar(
        load=NO_LOAD,
        prestress={"normal": 2e6},
        ends=dict(zip(("start", "end"), ends, strict=True)),
        record={"stress": [0.0, 20.0, 50.0], "velocity": [10.0], "interval": 1e-3},
    )
    result = dem.simulate(scene)
    assert result.attrs["static_steps"] == 0
    assert result.attrs["static_out_of_balance"] < 1e-12
    assert np.abs(result.stress.values - 2e6).max() < 1e-6
    assert np.abs(result.velocity.values).max() < 1e-12


def test_prestress_lets_a_pillar_without_tension_carry_a_tensile_wave(pillar):
    """Below the prestress the wave is that of linear joints, to round-off; above it is cut."""
    quiet = {"ends__end": "quiet"}
    linear = dem.simulate(pillar(**quiet)).stress.values
    barred = {**quiet, "joints__tension": False}
    enough = dem.simulate(pillar(**barred, prestress={"normal": 1.2e6})).stress.values
    little = dem.simulate(pillar(**barred, prestress={"normal": 0.5e6})).stress.values
    assert linear.min() < -0.9e6
    assert np.abs(enough - 1.2e6 - linear).max() < 1e-10 * np.abs(linear).max()
    assert little.min() == 0.0
    assert np.abs(little - 0.5e6 - linear).max() > 0.1e6


@pytest.mark.parametrize(
    "changes, message",
    [
        (
            {"gravity": {"direction": [0, -1, 0]}, "ends__end": "fixed"},
            r"gravity: no static .* static = false",
        ),
        (
            {"prestress": {"normal": -1e6}},
            r"prestress: no static state: the block .* the joints cannot",
        ),
    ],
    ids=["hanging", "pulled"],
)
def test_without_a_static_state_the_scene_is_refused(pillar, changes, message):
    """A pillar without tension neither hangs nor bears to be pulled: one line says so."""
    with pytest.raises(SceneError, match=message):
        dem.simulate(pillar(joints__tension=False, **changes))
