"""One joint that stiffens in a rock mass: its linear limit, its place in space, where it holds."""

import numpy as np
import pytest

from jointwave.cases.sampling import sample_times
from jointwave.compare.engines import applies, solve
from jointwave.compare.exact.rock_mass.field import field_of

CLOSES = {"maximum_closure": 1e-4}
NO = [
    ({}, {}, "no joint has closure: see oblique-joint"),
    (CLOSES | {"damping_ratio": 0.1}, {}, "the joint is damped"),
    (CLOSES | {"friction_angle": 30.0}, {}, "joint set 'joint' can slip"),
    (CLOSES, {"kind": "S"}, "the wave is not a P wave at normal incidence"),
    (CLOSES, {"direction": [0.0, 1.0]}, "the wave is not a P wave at normal incidence"),
]


@pytest.fixture
def straight(rock_mass, joint, wave):
    """A function of keys of the joint and of the wave, which meets the joint straight on at an
    angle to the axes."""
    n = [-np.sin(np.radians(25.0)), np.cos(np.radians(25.0))]
    whole = {"direction": n, "through": [16.0, -6.0]}
    return lambda law, one: rock_mass(joint_sets=[joint(**law)], waves=[wave(**whole | one)])


@pytest.mark.parametrize("law, one, reason", NO)
def test_no_gives_the_reason(straight, law, one, reason):
    assert applies("normal-incidence", straight(law, one)).reason == reason


def test_a_joint_that_hardly_closes_is_linear(straight):
    """At a maximum closure of 10 m, a million times what the wave closes, the curve bends by 1e-5
    and less: every waveform of the linear joint at an angle, by FFT."""
    found = solve("normal-incidence", straight({"maximum_closure": 10.0}, {}))
    linear = solve("oblique-joint", straight({}, {}))
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        one, other = found[name].values, linear[name].values
        size = np.abs(linear["gap" if name == "slip" else name].values).max()
        assert np.abs(one - other).max() <= 2e-5 * size, name


def test_what_enters_is_the_solution(straight):
    """Through quiet sides, at the place of the receivers."""
    scene = straight(CLOSES, {})
    assert applies("normal-incidence", scene)
    field, found = field_of(scene), solve("normal-incidence", scene)
    velocity, stress = field(np.array(scene.record.points), sample_times(scene))
    assert np.abs(velocity - found.velocity.values.swapaxes(1, 2)).max() <= 1e-12
    assert np.abs(stress + found.stress.values.swapaxes(1, 2)).max() <= 1e-6
    assert found.traction.values[0, :, 0] == pytest.approx(
        1e10 * found.gap.values[0] / -(1 + np.minimum(found.gap.values[0] / 1e-4, 0)), abs=1.0
    )
