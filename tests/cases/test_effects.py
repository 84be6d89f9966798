"""What a scene calls for, key by key."""

import pytest

from cases.effects import active_effects, effects

CALLS = {
    "dashpots": {"joints.damping_ratio": 0.02},
    "no tension": {"joints.tension": False},
    "joints that differ": {"soft_layers": [{"y": 20.0, "spacing_stiffness": 4e8}]},
    "quiet ends": {"ends.end": "quiet"},
    "matched ends": {"ends.start": "matched"},
    "fixed ends": {"ends.end": "fixed"},
    "energy ledger": {"record.energy": True},
}


@pytest.mark.parametrize("name", CALLS)
def test_one_key_calls_for_one_effect(scene_with, name):
    nothing = {"record.energy": False}
    assert active_effects(scene_with(**nothing)) == []
    assert active_effects(scene_with(**nothing | CALLS[name])) == [name]


def test_a_layer_may_be_the_only_joint_with_a_dashpot(scene_with):
    scene = scene_with(soft_layers=[{"y": 20.0, "damping_ratio": 0.1}])
    assert "dashpots" in active_effects(scene)


def test_a_layer_may_be_the_only_joint_without_tension(scene_with):
    scene = scene_with(soft_layers=[{"y": 20.0, "tension": False}])
    reasons = {effect.name: effect.reason for effect in effects(scene)}
    assert reasons["no tension"] == "1 of 99 joints"


def test_every_effect_says_why(scene_with):
    assert all(effect.reason for effect in effects(scene_with()))
