"""One joint that stiffens or slips in a rock mass: its linear limit, the plane against space."""

import numpy as np
import pytest

from closed_forms.slipping_joint import slipping_joint
from jointwave.cases.sampling import sample_times
from jointwave.compare.engines import solve
from jointwave.compare.exact.rock_mass.field import field_of

CLOSES = {"maximum_closure": 1e-4}
#: Strength of 2e5 + 1e6 tan(30) Pa under `PRESSED`.
SLIPS = {"friction_angle": 30.0, "cohesion": 2e5}
PRESSED = {"xx": 1e6, "yy": 1e6}


@pytest.mark.parametrize(
    "law, kind, pressed, still, bound",
    [
        (SLIPS | {"cohesion": 2e6}, "S", PRESSED, "gap", 1e-8),
        ({"maximum_closure": 10.0}, "P", None, "slip", 2e-5),
    ],
)
def test_a_strong_joint_and_one_that_hardly_closes_are_linear(
    straight, law, kind, pressed, still, bound
):
    """The linear joint at an angle, by FFT, of an S wave of 1 MPa at twice that strength, and of a
    P wave at a maximum closure of 10 m, a million times what it closes: the curve bends by 1e-5."""
    found = solve("normal-incidence", straight(law, {"kind": kind}, pressed))
    linear = solve("oblique-joint", straight({}, {"kind": kind}, pressed))
    moves = {"gap": "slip", "slip": "gap"}[still]
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        one, other = found[name].values, linear[name].values
        size = np.abs(linear[moves if name == still else name].values).max()
        assert np.abs(one - other).max() <= bound * size, name


def test_a_joint_that_slips_moves_as_it_does_marched_in_time(straight):
    """By Heun's method in steps of 4e-6 s, for waves at any angle; it has the wave reach its
    strength up to a step late, which changes velocity by a part omega dt = 5e-3 there."""
    scene = straight({"friction_angle": 0.0, "cohesion": 4e5}, {"kind": "S"})
    found, points = solve("normal-incidence", scene), np.array(scene.record.points)
    marched = slipping_joint(scene, points, found.time.values)
    assert np.abs(found.slip).max() > 1e-4
    size = np.abs(marched).max()
    assert np.abs(found.velocity.values - marched).max() <= 5e-3 * size


def test_space_turned_about_the_normal_is_the_plane(straight, rock_mass, joint, wave):
    """A wave that goes up through a horizontal joint, and moves rock along (0.6, 0.8): what the
    plane has along x, with friction that weakens."""
    law = SLIPS | {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3, "dip": 0.0}
    flat = rock_mass(
        joint_sets=[joint(**law)],
        waves=[wave(kind="S")],
        prestress=PRESSED,
    )
    space = rock_mass(
        domain={"size": [40.0, 40.0, 30.0]},
        joint_sets=[joint(**law | {"through": [20.0, 20.0, 15.0]})],
        waves=[wave(kind="S", direction=[0.0, 0.0, 1.0], polarisation=[-0.6, -0.8, 0.0])],
        boundaries=dict.fromkeys(("front", "back"), "quiet"),
        prestress=PRESSED | {"zz": 1e6},
        record={"points": [[18.0, 3.0, 4.0], [22.0, 9.0, 27.0]], "joints": [[20.0, 9.0, 15.0]]},
    )
    one, other = (solve("normal-incidence", scene) for scene in (flat, space))
    axis = np.array([0.6, 0.8])
    assert np.abs(one.slip).max() > 3e-5
    for name in ("velocity", "displacement"):
        along = other[name].values[..., :2] @ axis
        assert along == pytest.approx(one[name].values[..., 0], abs=1e-12), name
    size = np.linalg.norm(other.slip.values, axis=-1)
    assert size == pytest.approx(np.abs(one.slip.values), abs=1e-12)


@pytest.mark.parametrize("law, kind, pressed", [(CLOSES, "P", None), (SLIPS, "S", PRESSED)])
def test_what_enters_is_the_solution(straight, law, kind, pressed):
    """Through quiet sides, at the place of the receivers."""
    scene = straight(law, {"kind": kind}, pressed)
    field, found = field_of(scene), solve("normal-incidence", scene)
    velocity, stress = field(np.array(scene.record.points), sample_times(scene))
    assert np.abs(velocity - found.velocity.values.swapaxes(1, 2)).max() <= 1e-12
    carried = found.stress.values - np.array([1e6, 1e6, 0.0]) * (pressed is not None)
    assert np.abs(stress + carried.swapaxes(1, 2)).max() <= 1e-6
    gap = found.gap.values[0]
    assert kind == "S" or found.traction.values[0, :, 0] == pytest.approx(
        1e10 * gap / -(1 + np.minimum(gap / 1e-4, 0)), abs=1.0
    )
