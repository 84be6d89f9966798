"""What physics allows the normal traction: no tension, softening, dashpots."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.joints.energy import elastic_energy, fracture_energy_spent
from jointwave.joints.law import Law
from jointwave.joints.normal import normal_traction, spring_traction
from jointwave.joints.softening import is_broken, strength_left
from tests.joints.points import at_point

gaps = st.floats(-1e-3, 1e-3)
rates = st.floats(-10, 10)
stiffnesses = st.floats(1e3, 1e11)
viscosities = st.none() | st.just(0.0) | st.floats(1e-3, 1e7)
openings = st.lists(st.floats(-1, 1.5), min_size=2, max_size=30)  # in units of w_c

tied = st.tuples(stiffnesses, viscosities).map(lambda parts: Law(*parts))
no_tension = tied.map(lambda one: one._replace(carries_tension=False))


@st.composite
def softening(draw, viscosities=viscosities):
    """Return a law that softens, from nearly brittle to very ductile."""
    stiffness, strength = draw(st.floats(1e8, 1e11)), draw(st.floats(1e3, 1e7))
    critical = draw(st.floats(1.01, 1000)) * strength / stiffness
    return Law(stiffness, draw(viscosities), tensile_strength=strength, critical_opening=critical)


def softening_starts(one):
    """Return w_0 (m), where the strength is reached."""
    return one.tensile_strength / one.normal_stiffness


def nodes(path, kinks):
    """Return a path of gaps with a node at every kink that it crosses: then trapezoids are exact.

    The crossings of each piece are sorted in its direction.
    """
    fine = [path[0]]
    for a, b in pairwise(path):
        crossed = [k for k in kinks if min(a, b) < k < max(a, b)]
        fine += [*sorted(crossed, reverse=bool(b < a)), b]
    return np.array(fine)


@given(no_tension, gaps, rates)
def test_no_tension_never_pulls_and_open_is_free(one, gap, rate):
    """Equation (10): no traction when open, none below zero, whatever the dashpot wants."""
    t = normal_traction(*at_point(one), gap, rate, 0.0)
    assert t >= 0
    if gap > 0:
        assert t == 0


@given(no_tension | tied, st.lists(gaps, min_size=2, max_size=30))
def test_spring_gives_back_what_it_took(one, path):
    """The springs' work around any closed path of gaps is zero, opening included."""
    fine = nodes([*path, path[0]], [0.0])
    t = np.array([spring_traction(*at_point(one), g, 0.0) for g in fine])
    work = -np.sum((t[1:] + t[:-1]) / 2 * np.diff(fine))
    scale = one.normal_stiffness * np.abs(fine).max() ** 2
    assert work == pytest.approx(0, abs=1e-12 * scale + 1e-300)


@given(no_tension | tied, gaps, rates)
def test_dashpot_only_dissipates(one, gap, rate):
    """The part of the traction that is not elastic never does positive work on the blocks."""
    excess = normal_traction(*at_point(one), gap, rate, 0.0) - spring_traction(
        *at_point(one), gap, 0.0
    )
    assert excess * rate <= 1e-12 * abs(one.normal_stiffness * gap * rate)


@given(softening(), openings, rates)
def test_dashpot_of_a_softening_joint_only_dissipates(one, path, rate):
    """The same with any history, and spring and dashpot together never pull beyond s(k)."""
    k = 0.0
    for gap in np.array(path) * one.critical_opening:
        k = max(k, gap)
        t, spring = (
            normal_traction(*at_point(one), gap, rate, k),
            spring_traction(*at_point(one), gap, k),
        )
        assert t >= -strength_left(one, k)
        round_off = 1e-14 * (one.normal_stiffness * abs(gap) + one.tensile_strength)
        assert (t - spring) * rate <= round_off * abs(rate)


@given(softening(st.none()), openings)
def test_softening_keeps_its_energy_at_every_step(one, path):
    """Work of the traction = elastic energy + fracture energy, which never falls.

    The traction is piecewise linear in the gap, with kinks at zero, at the largest opening so
    far, at w_0 and at w_c: with nodes there, trapezoids are its work exactly.
    """
    path = np.array([0.0, *path]) * one.critical_opening
    kinks = [0.0, softening_starts(one), one.critical_opening]
    k = work = spent = 0.0
    for a, b in pairwise(path):
        for g, h in pairwise(nodes([a, b], [*kinks, k])):
            before = spring_traction(*at_point(one), g, k)
            k = max(k, h)
            work -= (before + spring_traction(*at_point(one), h, k)) / 2 * (h - g)
        stored, previous, spent = (
            elastic_energy(*at_point(one), b, k, 0.0, 0.0),
            spent,
            fracture_energy_spent(one, k),
        )
        scale = one.normal_stiffness * np.abs(path).max() ** 2 * len(path)
        assert work == pytest.approx(stored + spent, abs=1e-13 * scale)
        assert spent >= previous


@given(softening(), openings)
def test_pulled_to_the_critical_opening_takes_fracture_energy(one, path):
    """However it is unloaded on the way: G_c = s_t w_c / 2 in all, and nothing is left."""
    critical = one.critical_opening
    k = max(0.0, *np.array(path) * critical, critical)
    assert fracture_energy_spent(one, k) == pytest.approx(
        one.tensile_strength * critical / 2, rel=1e-12
    )
    assert is_broken(*at_point(one), k) and strength_left(one, k) == 0
    assert elastic_energy(*at_point(one), critical / 2, k, 0.0, 0.0) == 0


@given(softening(), st.floats(0, 1), st.floats(0, 1))
def test_unloads_through_the_origin(one, largest, part):
    """Between zero and the largest opening the spring is a straight line through both."""
    k = largest * one.critical_opening
    whole = spring_traction(*at_point(one), k, k)
    assert spring_traction(*at_point(one), part * k, k) == pytest.approx(
        part * whole, rel=1e-12, abs=1e-300
    )
    # One step after the strength is reached the secant is K but for the last digit.
    assert -whole == pytest.approx(min(one.normal_stiffness * k, strength_left(one, k)), rel=1e-12)


@given(softening(), gaps, rates)
def test_broken_joint_is_a_no_tension_joint(one, gap, rate):
    """Once broken, the joint follows equation (10)."""
    k = max(gap, one.critical_opening)
    without = Law(one.normal_stiffness, one.normal_viscosity, False)
    assert normal_traction(*at_point(one), gap, rate, k) == normal_traction(
        *at_point(without), gap, rate, 0.0
    )
    assert elastic_energy(*at_point(one), gap, k, 0.0, 0.0) == elastic_energy(
        *at_point(without), gap, 0.0, 0.0, 0.0
    )
