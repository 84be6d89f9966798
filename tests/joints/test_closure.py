"""The hyperbola of a joint that stiffens, by hand, and what physics allows it.

k_ni = 1e9 Pa/m and d_m = 0.1 mm: s_m = 1e5 Pa. Half of d_m takes s_m, nine tenths 9 s_m. A
millionth of its own compliance, that the joint keeps, is all that differs from that.
"""

from math import log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.joints.closure import closure_stiffness, closure_traction, closure_under
from jointwave.joints.energy import elastic_energy
from jointwave.joints.law import Law
from jointwave.joints.normal import gap_under, normal_traction, spring_traction
from tests.joints.points import at_point

ALONE = Law(1e9, maximum_closure=1e-4)
#: 0.3 of the joint's own compliance is the rock's.
IN_ROCK = Law(1e9, 1e4, maximum_closure=1e-4, rock_compliance=0.3e-9)


def near(value):
    """Hold a number to the millionth that a joint keeps of its compliance, where it is up to a
    hundred times as stiff as at first."""
    return pytest.approx(value, rel=1.1e-4)


@pytest.mark.parametrize(
    ("gap", "expected", "energy"),
    [
        (-5e-5, 1e5, 10 * (log(2) - 0.5)),
        (-9e-5, 9e5, 10 * (log(10) - 0.9)),
        (-1e-12, 1e-3, 0.5e-15),
        (2e-5, -2e4, 0.2),  # open: linear
    ],
)
def test_the_hyperbola(gap, expected, energy):
    """k_ni d / (1 - d / d_m) and k_ni d_m^2 (-ln(1 - d / d_m) - d / d_m)."""
    assert spring_traction(*at_point(ALONE), gap, 0.0) == near(expected)
    assert elastic_energy(*at_point(ALONE), gap, 0.0, 0.0, 0.0) == near(energy)
    assert gap_under(*at_point(ALONE), expected) == near(gap)


def test_rock_beside_the_joint():
    """Own compliance 0.7e-9, so s_m = 1e-4 / 0.7e-9 Pa. At s_m the joint has closed by 0.05 mm, the
    rock by 0.3e-9 s_m; the stiffness is 1 / (0.3e-9 + 0.7e-9 / 4)."""
    law, parts = at_point(IN_ROCK)
    most = 1e-4 / 0.7e-9
    whole = 0.5e-4 + 0.3e-9 * most
    assert closure_traction(law, whole) == near(most)
    assert normal_traction(law, parts, -whole, -2.0, 0.0) == near(most + 2e4)  # and its dashpot
    assert closure_stiffness(law, 0.0) == pytest.approx(1e9, rel=1e-12)
    assert closure_stiffness(law, most) == near(1 / (0.3e-9 + 0.7e-9 / 4))


def test_beyond_its_maximum_a_joint_is_a_million_times_as_stiff():
    """A step that would pass d_m gives a finite, larger traction: a wall, not a singularity."""
    law, parts = at_point(ALONE)
    gaps = -1e-4 * np.array([0.999, 1.0, 1.001, 1.1, 2.0, 1e3, 1e9])
    t = np.array([spring_traction(law, parts, gap, 0.0) for gap in gaps])
    assert np.isfinite(t).all() and (np.diff(t) > 0).all()
    steepest = np.diff(t[3:]) / -np.diff(gaps[3:])
    assert steepest == pytest.approx(1e15, rel=2e-2) and (steepest <= 1e15 * (1 + 1e-9)).all()


closures = st.floats(1e-9, 1e2)  # of d_m


@given(closures, closures, st.sampled_from([ALONE, IN_ROCK]))
def test_stored_energy_is_the_work_whatever_the_way(a, b, one):
    """From a to b by Gauss in the logarithm of the traction; back it is the same with the other
    sign, for the joint unloads along its curve."""
    law, parts = at_point(one)
    t = [closure_traction(law, x * 1e-4) for x in (a, b)]
    nodes, weights = np.polynomial.legendre.leggauss(120)
    at = np.exp(np.log(t[0]) + (nodes + 1) / 2 * np.log(t[1] / t[0]))
    work = np.log(t[1] / t[0]) / 2 * weights @ (at**2 / closure_stiffness(law, at))
    stored = [elastic_energy(law, parts, -x * 1e-4, 0.0, 0.0, 0.0) for x in (a, b)]
    assert min(stored) >= 0
    assert stored[1] - stored[0] == pytest.approx(work, rel=1e-9, abs=1e-11 * max(stored))


@given(st.floats(1e-6, 1e8), st.floats(1.0, 2.0))
def test_the_gap_of_a_traction(t, more):
    """It is the inverse, to the round-off of a steep curve, and rises."""
    for one in (ALONE, IN_ROCK):
        law, parts = at_point(one)
        gap = gap_under(law, parts, t)
        off = 1e-14 * abs(gap) * closure_stiffness(law, t)
        assert spring_traction(law, parts, gap, 0.0) == pytest.approx(t, rel=1e-13, abs=off)
        assert closure_under(law, more * t) >= closure_under(law, t)
        assert gap_under(law, parts, -t) == t / law.normal_stiffness
