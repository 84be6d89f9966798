"""The compiled laws equal their plain-Python twin, and do what physics allows."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from joints import reference
from joints.laws import Law, law_of, normal_traction, spring_traction
from joints.uniform import law, uniform

gaps = st.floats(-1e-3, 1e-3)
rates = st.floats(-10, 10)
stiffnesses = st.floats(1e3, 1e11)
viscosities = st.just(0.0) | st.floats(1e-3, 1e7)


def compiled(stiffness, viscosity, carries_tension):
    """Return the smallest law of one joint, as the engines build it."""
    return law(
        np.array([stiffness]),
        None if viscosity is None else np.array([viscosity / stiffness]),
        np.array([carries_tension]),
    )


@given(stiffnesses, st.none() | viscosities, st.booleans(), gaps, rates)
def test_compiled_law_equals_reference(stiffness, viscosity, carries_tension, gap, rate):
    """To the last digits, for every combination of present and absent parts."""
    found = normal_traction(compiled(stiffness, viscosity, carries_tension), gap, rate)
    expected = reference.normal_traction(stiffness, viscosity or 0.0, carries_tension, gap, rate)
    scale = abs(stiffness * gap) + abs((viscosity or 0.0) * rate)
    assert found == pytest.approx(expected, abs=1e-14 * scale)


@given(stiffnesses, viscosities, gaps, rates)
def test_no_tension_never_pulls_and_open_is_free(stiffness, viscosity, gap, rate):
    """Equation (10): no traction when open, none below zero, whatever the dashpot wants."""
    t = normal_traction(compiled(stiffness, viscosity, False), gap, rate)
    assert t >= 0
    if gap > 0:
        assert t == 0


@given(stiffnesses, st.booleans(), st.lists(gaps, min_size=2, max_size=30))
def test_spring_gives_back_what_it_took(stiffness, carries_tension, path):
    """Without a dashpot the work around any closed path of gaps is zero, opening included."""
    one = compiled(stiffness, None, carries_tension)
    loop = np.array([*path, path[0]])
    # The traction is piecewise linear with one kink, at zero: a node there makes trapezoids exact.
    fine = np.concatenate([[a, 0.0] if a * b < 0 else [a] for a, b in pairwise(loop)])
    fine = np.append(fine, loop[-1])
    t = np.array([spring_traction(one, g) for g in fine])
    work = -np.sum((t[1:] + t[:-1]) / 2 * np.diff(fine))
    assert work == pytest.approx(0, abs=1e-12 * stiffness * np.abs(fine).max() ** 2 + 1e-300)


@given(stiffnesses, viscosities, st.booleans(), gaps, rates)
def test_dashpot_only_dissipates(stiffness, viscosity, carries_tension, gap, rate):
    """The part of the traction that is not elastic never does positive work on the blocks."""
    one = compiled(stiffness, viscosity, carries_tension)
    excess = normal_traction(one, gap, rate) - spring_traction(one, gap)
    assert excess * rate <= 1e-12 * abs(stiffness * gap * rate)


def test_alike_joints_become_one_number_and_absent_parts_none():
    """No array for what is the same everywhere, nothing at all for what is not there."""
    stiffness, tension = np.full(4, 9e9), np.ones(4, dtype=bool)
    assert law(stiffness, None, tension) == Law(9e9, None, None)
    mixed = law(np.array([1.0, 2.0]), np.array([0.5, 0.5]), np.array([True, False]))
    assert mixed.normal_stiffness.tolist() == [1, 2]
    assert mixed.normal_viscosity.tolist() == [0.5, 1]
    assert law_of(mixed, 1) == (2.0, 1.0, False)
    assert uniform(np.array([3.0, 3.0])) == 3.0
