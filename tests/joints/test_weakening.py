"""Friction that falls with slip, in round numbers worked out by hand.

K_s = 2e9 Pa/m under 1 MPa: tan(phi) from 0.6 to 0.2 over 1 mm, so that the strength falls by 4e8
Pa/m, from 6e5 to 2e5 Pa.
"""

import pytest

from jointwave.joints.law import Law
from tests.joints.points import Point, advance, at_point, tangent

JOINT = Law(1e9, shear_stiffness=2e9, friction=0.6, dynamic_friction=0.2, weakening_distance=1e-3)
PRESSED = -1e-3  # m: 1 MPa
DT = 1e-5


def slip(one, x, history, gap=PRESSED):
    """Return the shear traction (Pa) along x and the history after a slip by x, m."""
    _, t, _, after = advance(*at_point(one), gap, 0.0, (x, 0.0), (x / DT, 0.0), DT, history)
    return t, after


@pytest.mark.parametrize(
    ("x", "path", "stress"),
    [
        (2e-4, 0.0, 4e5),  # it holds
        (3e-4, 0.0, 6e5),
        (7e-4, 5e-4, 4e5),  # 1.4e6 - 6e5 = (2e9 - 4e8) 5e-4
        (1.1e-3, 1e-3, 2e5),
        (4e-3, 3.9e-3, 2e5),
    ],
)
def test_strength_over_the_path(x, path, stress):
    """tau = 6e5 - 4e8 S, of S = x - tau / 2e9: in one step, or in two to the same place."""
    t, after = slip(JOINT, x, Point())
    assert (t, after.path) == pytest.approx((-stress, path), rel=1e-12, abs=1e-15)
    t, after = slip(JOINT, x / 2, slip(JOINT, x / 2, Point())[1])
    assert (t, after.path) == pytest.approx((-stress, path), rel=1e-12, abs=1e-15)


def test_the_path_grows_whatever_the_direction():
    """There by 0.5 mm and back by another: the strength is 4e5, then 2e5 Pa."""
    t, after = slip(JOINT, 7e-4, Point())
    t, after = slip(JOINT, -8e-4, after)  # 4e5 to -2e5 Pa unloads by 0.3 mm: 0.5 mm of slide
    assert (t, after.path) == pytest.approx((2e5, 1e-3), rel=1e-12)


def test_a_joint_softer_than_its_friction_falls_snaps():
    """Over 0.1 mm: 4e9 Pa/m. Just beyond 6e5 Pa it falls to 2e5 Pa, and slides by the 0.2 mm that
    its spring of 2e9 Pa/m gives back."""
    steep = JOINT._replace(weakening_distance=1e-4)
    assert slip(steep, 3e-4 * (1 - 1e-9), Point())[0] == pytest.approx(-6e5, rel=1e-8)
    t, after = slip(steep, 3e-4 * (1 + 1e-9), Point())
    assert (t, after.path) == pytest.approx((-2e5, 2e-4), rel=1e-8)


def test_open_faces_wear_nothing():
    """What moves while it is open, or is pulled, is no path."""
    one = JOINT._replace(carries_tension=False)
    assert slip(one, 1.0, Point(), gap=1e-6)[1].path == 0.0
    sticky = JOINT._replace(cohesion=1e5)
    t, after = slip(sticky, 1e-3, Point(), gap=1e-5)  # a pull of 1e4 Pa: 1e5 - 0.6e4
    assert t == pytest.approx(-9.4e4) and after.path == 0.0


def test_the_tangent_is_that_of_the_falling_strength():
    """d tau / d slip = -4e8 / (1 - 4e8 / 2e9); and 0.4 of the normal stiffness by that factor."""
    found = tangent(*at_point(JOINT), PRESSED, 0.0, (7e-4, 0.0), (0.0, 0.0), DT, Point(), 0.0)
    assert found.xx == pytest.approx(4e8 / 0.8, rel=1e-12)
    assert found.xn == pytest.approx(0.4 * 1e9 / 0.8, rel=1e-12)
    assert found.zz == pytest.approx(-2e9 * 4e5 / 1.4e6, rel=1e-12)
