"""Which pillars the continuum simulates, in which dimension, and what its homogenised rock is."""

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.continuum import applies, simulate
from jointwave.continuum.plan import plan_of

SOFT = 4.375e8  # Pa/m, of a layer
OBLIQUE = {"load__direction": [0.6, 0.8, 0.0]}
models = pytest.mark.parametrize("model", ["jointed", "equivalent"])


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
    """A joint as stiff as the others is in the homogenised rock already."""
    scene = pillar(**layer(cohesion=1e5), **OBLIQUE)
    p, law = calibrate(scene), plan_of(scene, "equivalent", dim=2).problem.law
    assert law.normal_stiffness == pytest.approx(10 * p.regular_stiffness, rel=1e-12)
    assert law.shear_stiffness == pytest.approx(10 * p.regular_shear_stiffness, rel=1e-12)


REFUSED = {
    "no modulus": ("jointed", {"rock__intact_modulus": None}, "needs rock.intact_modulus"),
    "no tension": ("equivalent", {"joints__tension": False}, "no joints without tension"),
    "stiff layer": ("equivalent", layer(spacing_stiffness=9e9), "stiffer"),
    "damped layer": ("equivalent", layer(damping_ratio=0.1), "ordinary joint"),
    "stiff shear": (
        "equivalent",
        layer(shear_stiffness=1e11) | OBLIQUE,
        "stiffer than the others in shear",
    ),
    "softening": (
        "equivalent",
        {"joints": {"tensile_strength": 5e6, "fracture_energy": 2000.0}},
        "no joints that slide or break",
    ),
    "slip": ("equivalent", {"joints__friction_angle": 30.0} | OBLIQUE, "no joints that slide"),
    "local damping, jointed": ("jointed", {"damping__local": 0.5}, "no local damping"),
    "local damping": ("equivalent", {"damping__local": 0.5}, "no local damping"),
}


@pytest.mark.parametrize(("model", "changes", "reason"), REFUSED.values(), ids=REFUSED)
def test_model_that_does_not_apply_says_why(pillar, changes, model, reason):
    scene = pillar(**changes)
    assert reason in applies(scene, model)
    with pytest.raises(SceneError, match=reason):
        simulate(scene, model)


@models
@pytest.mark.parametrize(
    ("changes", "dim", "reason"),
    [
        ({"load__at": [0.1, 0.0]}, 1, "a bar does not bend or twist"),
        ({"load__direction": [0.0, 0.8, 0.6]}, 1, "a bar does not bend or twist"),
        ({"load__direction": [0.0, 0.8, 0.6]}, 2, "leaves the plane of x and y"),
        ({"load__at": [0.0, 0.1]}, 2, "leaves the plane of x and y"),
        ({"load__arm": 0.1}, 2, "leaves the plane of x and y"),
        ({"load__at": [0.1, 0.0], "motion__rotation": "finite"}, 3, "rotations are small"),
    ],
)
def test_dimension_that_does_not_hold_the_motion_says_why(pillar, changes, dim, reason, model):
    assert reason in applies(pillar(**changes), model, dim)


@models
@pytest.mark.parametrize(
    ("changes", "dim"),
    [
        ({}, 1),
        ({"load__direction": [0.0, 0.8, 0.6], "motion__rotation": "none"}, 1),
        (OBLIQUE, 2),
        ({"load__at": [0.1, 0.0]}, 2),
        ({"load__arm": 0.1, "load__direction": [0.0, 0.0, 1.0]}, 2),
        ({"load__arm": 0.1}, 3),
        ({"load__at": [0.0, 0.1]}, 3),
    ],
)
def test_the_least_dimension_that_holds_the_motion_is_taken(short, changes, dim, model):
    scene = short(numerics__continuum__order=1, **changes)
    assert applies(scene, model) == ""
    assert plan_of(scene, model).problem.body.x.shape[1] == dim


@models
def test_friction_that_nothing_calls_for_is_no_obstacle(pillar, model):
    assert applies(pillar(joints__friction_angle=30.0), model) == ""


def test_soft_layer_without_tension_opens_in_the_homogenised_rock(pillar):
    scene = pillar(**layer(spacing_stiffness=SOFT, tension=False))
    stress = simulate(scene, "equivalent")["stress"]
    assert float(stress.min()) > -1e-10 * float(stress.max())


@pytest.mark.parametrize(("key", "value"), [("dim", 0), ("dim", 4), ("model", "discrete")])
def test_what_is_not_there_is_refused(pillar, key, value):
    with pytest.raises(SceneError, match=key):
        simulate(pillar(), **{key: value})
