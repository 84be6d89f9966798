"""A key whose physics is not built is refused, never ignored."""

import pytest

from cases import SceneError
from cases.availability import JOINT_KEYS
from cases.scene import JointLaw

VALUES = {
    "friction_angle": 30.0,
    "cohesion": 0.0,
    "tensile_strength": 1e5,
    "fracture_energy": 10.0,
    "contact_points": 2,
    "point_rule": "gauss",
}

UNAVAILABLE = {
    **{f"joints.{key}": {f"joints.{key}": value} for key, value in VALUES.items()},
    **{
        f"soft_layers[0].{key}": {"soft_layers": [{"y": 20.0, key: value}]}
        for key, value in {**VALUES, "thickness": 0.05}.items()
    },
    "load.direction": {"load.direction": [1, 0, 0]},
    "load.at": {"load.at": [0.1, 0.0]},
    "ends.start": {"ends.start": "fixed"},
    "gravity": {"gravity": {"direction": [0, 1, 0]}},
    "prestress": {"prestress": {"normal": 1e5}},
    "numerics.continuum.scheme": {"numerics.continuum.scheme": "implicit"},
}


@pytest.mark.parametrize("key", UNAVAILABLE)
def test_key_is_not_available_yet(scene_with, key):
    with pytest.raises(SceneError) as error:
        scene_with(**UNAVAILABLE[key])
    assert error.value.key == key
    assert str(error.value).endswith("not available yet")


def test_every_key_of_a_joint_is_simulated_or_refused():
    simulated = {"normal_stiffness", "tension", "damping_ratio"}
    assert set(JointLaw.model_fields) == simulated | set(JOINT_KEYS) == simulated | set(VALUES)
