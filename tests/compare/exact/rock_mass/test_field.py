"""The incident field of a scene: the stack's where it has one, right at every quiet side."""

import numpy as np
import pytest

from jointwave.cases.incident import FreeField
from jointwave.compare.exact.rock_mass.field import StackField, field_of
from jointwave.compare.exact.rock_mass.stack import stack_of
from jointwave.compare.exact.rock_mass.stack_waves import motion_at

SIDES = np.array([[0.0, 12.0], [40.0, 21.0], [31.0, 0.0], [4.0, 30.0], [0.0, 3.0]])
TIMES = np.linspace(0, 0.02, 201)


def test_it_is_the_field_of_the_solution(rock_mass, wave):
    """Two simultaneous waves, on all sides."""
    one, other = wave(direction=[0.28, 0.96]), wave(direction=[0.0, 1.0], kind="S", amplitude=3e5)
    scene = rock_mass(waves=[one, other])
    found, exact = field_of(scene)(SIDES, TIMES), motion_at(scene, stack_of(scene), SIDES, TIMES)
    assert np.abs(found.velocity - exact.velocity).max() < 1e-8 * np.abs(exact.velocity).max()
    assert np.abs(found.stress - exact.stress).max() < 1e-8 * np.abs(exact.stress).max()


@pytest.mark.parametrize(
    "changes",
    [
        {"loads": [{"kind": "pressure", "opening": 0, "shape": "step", "amplitude": 1.0}]},
        {"gravity": {"static": False}},
        {"prestress": {"xx": 1e6, "yy": 2e6}},
    ],
)
def test_what_else_acts_and_openings_add_to_it(rock_mass, changes):
    opening = {"openings": [[[18, 13], [22, 13], [22, 17], [18, 17]]], "non_convex": "cut"}
    scene = rock_mass(**changes, domain=opening, record={"joints": []})
    found = field_of(scene)
    assert isinstance(found, StackField) and len(found.stack.joints) == 1


def test_without_planes_it_is_that_of_the_waves_alone(rock_mass, joint):
    crossed = [joint(), joint(name="other", dip=80.0)]
    for changes in ({"joint_sets": []}, {"waves": []}, {"joint_sets": crossed}):
        assert isinstance(field_of(rock_mass(**changes, record={"joints": []})), FreeField)


@pytest.mark.parametrize(
    "changes",
    [{"boundaries": {"left": "free"}}, {"damping": {"mass_proportional": 1.0}}, {"law": 30.0}],
)
def test_sides_damping_and_strength_leave_it_as_it_is(rock_mass, joint, changes):
    """Sides that waves run along, damped rock and a joint that may slip: to the last bit."""
    changes = changes | {"joint_sets": [joint(friction_angle=changes.pop("law", None))]}
    found, known = (field_of(x)(SIDES, TIMES) for x in (rock_mass(**changes), rock_mass()))
    assert np.array_equal(found.velocity, known.velocity) and known.velocity.any()
    assert np.array_equal(found.stress, known.stress)
