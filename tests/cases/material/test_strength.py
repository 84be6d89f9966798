"""The strength of every joint: its own, that of [joints], or none."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.properties import NAMES
from jointwave.cases.schema.law_parts import UNLIMITED

TENSILE = {"tensile_strength": 1e5, "fracture_energy": 10.0}


def layer(**keys):
    return {"soft_layers": [{"y": 20.0, **keys}]}


def test_joints_of_an_elastic_scene_have_no_strength(scene_with):
    p = calibrate(scene_with(soft_layers=[{"y": 20.0}]))
    assert p.strengths() == {} and all(getattr(p, name) is None for name in NAMES)
    with pytest.raises(AttributeError):
        p.strenght  # noqa: B018


def test_friction_of_all_joints_needs_no_cohesion(scene_with):
    p = calibrate(scene_with(**{"joints.friction_angle": 45.0}))
    assert p.friction == pytest.approx(np.ones(99), rel=1e-15)
    assert p.cohesion is None


def test_cohesion_of_all_joints_needs_no_friction(scene_with):
    p = calibrate(scene_with(**{"joints.cohesion": 2e5}))
    assert (p.cohesion == 2e5).all()
    assert p.friction is None and p.residual_cohesion is None


@pytest.mark.parametrize("key", ["friction_angle", "cohesion"])
def test_one_joint_that_slips_among_those_that_do_not(scene_with, key):
    p = calibrate(scene_with(**layer(**{key: 30.0})))
    assert (np.delete(p.cohesion, 39) == UNLIMITED).all()
    assert p.cohesion[39] == (30.0 if key == "cohesion" else 0.0)
    if key == "cohesion":
        assert p.friction is None
    else:
        assert not np.delete(p.friction, 39).any()
        assert p.friction[39] == pytest.approx(np.tan(np.pi / 6))


def test_a_layer_inherits_what_it_leaves_out(scene_with):
    changes = {"joints.friction_angle": 30.0, **layer(cohesion=3e4)}
    p = calibrate(scene_with(**changes))
    assert p.friction == pytest.approx(np.tan(np.pi / 6))
    assert p.cohesion[39] == 3e4 and not np.delete(p.cohesion, 39).any()


def test_cohesion_that_is_not_said_to_be_lost_stays(scene_with):
    p = calibrate(scene_with(**{"joints.cohesion": 2e5, **layer(residual_cohesion=1e4)}))
    assert p.residual_cohesion[39] == 1e4
    assert (np.delete(p.residual_cohesion, 39) == 2e5).all()


def test_critical_opening_spends_the_fracture_energy(scene_with):
    """G_c is the triangle below the softening line: w_c = 2 G_c / sigma_t."""
    p = calibrate(scene_with(**{f"joints.{key}": value for key, value in TENSILE.items()}))
    assert (p.tensile_strength == 1e5).all()
    assert p.critical_opening == pytest.approx(2e-4, rel=1e-15)


def test_one_joint_that_breaks_among_those_that_do_not(scene_with):
    p = calibrate(scene_with(**layer(**TENSILE)))
    for part, own in (("tensile_strength", 1e5), ("critical_opening", 2e-4)):
        values = getattr(p, part)
        assert values[39] == pytest.approx(own, rel=1e-15)
        assert (np.delete(values, 39) == UNLIMITED).all()


def test_a_joint_without_tension_beside_one_that_breaks(scene_with):
    layers = [{"y": 20.0, **TENSILE}, {"y": 30.0, "tension": False}]
    p = calibrate(scene_with(soft_layers=layers))
    assert np.flatnonzero(~p.tension).tolist() == [59]
    assert np.flatnonzero(p.tensile_strength < UNLIMITED).tolist() == [39]


def test_the_least_fracture_energy_that_is_named_is_accepted(scene_with):
    """The refusal rounds its number up, so that it can be copied."""
    stiffness = calibrate(scene_with()).regular_stiffness
    least = 1e5**2 / (2 * stiffness)
    assert 0.57151 < least < 0.5716
    scene = scene_with(**{"joints.tensile_strength": 1e5, "joints.fracture_energy": 0.5716})
    p = calibrate(scene)
    assert (p.critical_opening > p.tensile_strength / p.stiffness).all()
