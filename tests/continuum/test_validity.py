"""Which scenes the continuum simulates, in which dimension, and what its homogenised rock is."""

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import applies, simulate
from jointwave.continuum.plan import plan_of

SOFT = 4.375e8  # Pa/m, of a layer
OBLIQUE = {"load__direction": [0.6, 0.8, 0.0]}
OUT_OF_PLANE = {"load__direction": [0.0, 0.8, 0.6]}
BENDS = {"load__at": [0.1, 0.0]}
BOTH = ("jointed", "equivalent")


def layer(**keys):
    return {"soft_layers": [{"y": 20.0, **keys}]}


def test_homogenised_rock_is_whole_but_for_soft_layers(pillar):
    """A layer has the compliance by which it exceeds the other joints."""
    scene = pillar(soft_layers=[{"y": 20.0, "spacing_stiffness": SOFT}, {"y": 30.0}])
    p, problem = calibrate(scene), plan_of(scene, "equivalent").problem
    assert problem.body.joints.weight.size == 1
    excess = 1 / p.stiffness[39] - 1 / p.regular_stiffness
    assert problem.law.normal_stiffness == pytest.approx(1 / excess, rel=1e-12)


def test_homogenised_rock_keeps_a_joint_that_can_fail_as_stiff_as_ten(pillar):
    """A tenth of an ordinary joint's own compliance, which the blocks beside it lose."""
    scene = pillar(**layer(cohesion=1e5), **OBLIQUE)
    p, law = calibrate(scene), plan_of(scene, "equivalent", dim=2).problem.law
    assert law.normal_stiffness == pytest.approx(10 * p.regular_own_stiffness, rel=1e-12)
    assert law.shear_stiffness == pytest.approx(10 * p.regular_own_shear_stiffness, rel=1e-12)


BREAKS = {"joints": {"tensile_strength": 5e6, "fracture_energy": 2000.0}}
LEAVES = "leaves the plane of x and y"
NO_BAR = "a bar does not bend or twist"
#: Models, dimension, keys and reason.
REFUSED = [
    (["jointed"], None, {"rock__intact_modulus": None}, "needs rock.intact_modulus"),
    (["equivalent"], None, {"joints__tension": False}, "no joints without tension"),
    (["equivalent"], None, layer(spacing_stiffness=9e9), "stiffer"),
    (["equivalent"], None, layer(damping_ratio=0.1), "ordinary joint"),
    (["equivalent"], None, layer(shear_stiffness=1e11) | OBLIQUE, "than the others in shear"),
    (["equivalent"], None, BREAKS, "no joints that slide or break"),
    (["equivalent"], None, {"joints__friction_angle": 30.0} | OBLIQUE, "no joints that slide"),
    (BOTH, None, {"damping__local": 0.5}, "no local damping"),
    (BOTH, 1, BENDS, NO_BAR),
    (BOTH, 1, OUT_OF_PLANE, NO_BAR),
    (BOTH, 2, OUT_OF_PLANE, LEAVES),
    (BOTH, 2, {"load__at": [0.0, 0.1]}, LEAVES),
    (BOTH, 2, {"load__arm": 0.1}, LEAVES),
    (BOTH, 3, BENDS | {"motion__rotation": "finite"}, "rotations are small"),
    (BOTH, 0, {}, "dim = 0: must be 1, 2 or 3"),
    (BOTH, 4, {}, "dim = 4: must be 1, 2 or 3"),
    (["discrete"], None, {}, "model = 'discrete': must be one of jointed, equivalent"),
]


@pytest.mark.parametrize(("models", "dim", "changes", "reason"), REFUSED)
def test_a_pillar_that_cannot_be_simulated_says_why(pillar, models, dim, changes, reason):
    for model in models:
        with pytest.raises(SceneError, match=reason) as error:
            simulate(pillar(**changes), model, dim=dim)
        assert "\n" not in str(error.value)


SET = {"dip": 30.0, "spacing": 2.0}


@pytest.mark.parametrize(
    ("joints", "changes", "reason"),
    [
        ([{"dip": 30.0, "through": [3.0, 3.0]}], {}, "no joint set has a spacing"),
        ([SET | {"friction_angle": 30.0}], {}, "no friction_angle"),
        ([SET | {"tension": False}], {}, "homogenised joints do not open"),
        ([SET], {"damping": {"local": 0.5}}, "no local damping"),
    ],
)
def test_what_an_effective_medium_cannot_be_is_said(joints, changes, reason, rock_mass):
    with pytest.raises(SceneError, match=reason):
        simulate(rock_mass(*joints, **changes), "equivalent")


@pytest.mark.parametrize("model", BOTH)
@pytest.mark.parametrize(
    ("changes", "dim"),
    [
        ({}, 1),
        (OUT_OF_PLANE | {"motion__rotation": "none"}, 1),
        (OBLIQUE, 2),
        (BENDS, 2),
        ({"load__arm": 0.1, "load__direction": [0.0, 0.0, 1.0]}, 2),
        ({"load__arm": 0.1}, 3),
        ({"load__at": [0.0, 0.1]}, 3),
    ],
)
def test_the_least_dimension_that_holds_the_motion_is_taken(short, changes, dim, model):
    scene = short(numerics__continuum__order=1, **changes)
    assert applies(scene, model) == ""
    assert plan_of(scene, model).problem.body.x.shape[1] == dim
