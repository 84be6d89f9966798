"""Joints under a prestress against their strength by hand."""

import pytest

from jointwave.cases.material.rock_mass import beyond_strength
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.plane import InSituStress

#: At 30 degrees: t_n = 1 x 1/4 + 5 x 3/4 = 4 MPa, |t_s| = 4 sqrt(3)/4 = 1.732 MPa.
PRESSED = InSituStress(xx=1e6, yy=5e6)
PULLED = InSituStress(xx=-1e6, yy=-1e6)


@pytest.mark.parametrize(
    ("stress", "law", "found"),
    [
        (PRESSED, {}, None),
        (PRESSED, {"friction_angle": 23.42}, None),  # atan(sqrt(3)/4) = 23.413 degrees
        (PRESSED, {"friction_angle": 23.40}, "slides"),
        (PRESSED, {"cohesion": 1.733e6}, None),
        (PRESSED, {"cohesion": 1.731e6}, "slides"),
        (PRESSED, {"cohesion": 1e6, "friction_angle": 10.4}, None),  # 1 + 4 x 0.1835
        (PRESSED, {"cohesion": 1e6, "friction_angle": 10.3}, "slides"),  # 1 + 4 x 0.1817
        (PULLED, {}, None),
        (PULLED, {"tension": False}, "opens"),
        (PULLED, {"tensile_strength": 1.01e6, "fracture_energy": 100.0}, None),
        (PULLED, {"tensile_strength": 0.99e6, "fracture_energy": 100.0}, "opens"),
    ],
)
def test_a_joint_holds_or_fails_as_its_strength_says(stress, law, found):
    joint = JointSet(name="joint", dip=30.0, through=[0.0, 0.0], **law)
    assert beyond_strength(joint, stress.tensor) == found


@pytest.mark.parametrize(("angle", "found"), [(23.42, None), (23.40, "slides")])
def test_a_joint_in_space_bears_the_same_stress_in_the_plane_of_its_dip(angle, found):
    space = {"dimension": 3}
    keys = {"xx": 1e6, "yy": 9e6, "zz": 5e6}
    stress = InSituStress.model_validate(keys, context=space)
    keys = {"name": "joint", "dip": 30.0, "dip_direction": 90.0, "through": [0.0, 0.0, 0.0]}
    joint = JointSet.model_validate(keys | {"friction_angle": angle}, context=space)
    assert beyond_strength(joint, stress.tensor) == found
