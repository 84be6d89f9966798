"""The compiled laws equal their plain-Python twin, part by part and joint by joint."""

from itertools import product
from math import hypot

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from joints import energy, laws, reference, shear, softening
from joints.laws import History, Law, law_of, normal_traction, spring_traction, traction
from joints.uniform import law, uniform

DT = 1e-5

# What limits the shear traction, by letter: cohesion, friction, residual cohesion. None: no shear.
SHEARS = (None, "", "c", "f", "cf", "cr", "cfr")
COMBINATIONS = list(product(("", "dashpots"), ("ties", "no tension", "softening"), SHEARS))


@st.composite
def one_law(draw, dashpots, opens, shears):
    """Return the smallest law of one joint, as the engines build it."""

    def some(low, high):
        # Rounded, as the square of a number below 1e-162 is zero.
        return np.array([round(draw(st.floats(low, high)), 9)])

    stiffness, parts = some(1e8, 1e11), {}
    if opens == "softening":
        parts["tensile_strength"] = some(1e3, 1e7)
        parts["critical_opening"] = some(1.1, 100) * parts["tensile_strength"] / stiffness
    if shears is not None:
        parts["shear_stiffness"] = some(1e8, 1e11)
        wanted = {"cohesion": some(0, 1e6), "friction": some(0, 2)}
        wanted["residual_cohesion"] = wanted["cohesion"] * some(0, 1)
        parts.update((name, value) for name, value in wanted.items() if name[0] in shears)
    eta = some(1e-9, 1e-3) if dashpots else None
    return law(stiffness, eta, np.array([opens != "no tension"]), **parts)


@st.composite
def paths(draw, one):
    """Return steps of (gap, gap rate, slip, slip rate) that reach every branch of a law."""
    reach = 1.5 * (one.critical_opening or 1e-4)
    unit = st.floats(-1, 1).map(lambda x: round(x, 9))
    steps = draw(st.lists(st.tuples(*[unit] * 6), min_size=1, max_size=12))
    return [
        (g * reach, 10 * r, (x * 1e-4, z * 1e-4), (10 * rx, 10 * rz))
        for g, r, x, z, rx, rz in steps
    ]


def virgin(one):
    """Return the history of a point that nothing has happened to."""
    slip = None if one.shear_stiffness is None else 0.0
    return History(
        None if one.tensile_strength is None else 0.0,
        slip,
        slip,
        None if one.residual_cohesion is None else one.cohesion,
    )


def scales(one, gap, rate, slip, slip_rate, h):
    """Return the sums of all magnitudes in the normal and in the shear traction, Pa."""
    cohesion = one.cohesion or 0.0
    n = one.normal_stiffness * abs(gap) + (one.normal_viscosity or 0) * abs(rate)
    n += one.tensile_strength or 0.0
    if h.ex is None:
        return n, 0.0
    s = one.shear_stiffness * (abs(h.ex) + abs(h.ez) + abs(slip[0]) + abs(slip[1]))
    s += (one.shear_viscosity or 0) * (abs(slip_rate[0]) + abs(slip_rate[1]))
    return n, s + cohesion + (one.friction or 0.0) * n


def near(found, expected, scale):
    """Hold two numbers to 1e-13 of the scale that they were computed from."""
    assert abs(found - expected) <= 1e-13 * scale


def on_the_edge(one, t_n, step, h, opening, scale):
    """Return whether the last digit decides if a step slips."""
    gap, _, slip, slip_rate = step
    trial = reference.shear_traction(one, h.ex + slip[0], h.ez + slip[1], *slip_rate)
    tau = reference.shear_strength(one, t_n, gap, opening, h.cohesion)
    return abs(hypot(*trial) - tau) <= 1e-12 * scale


@pytest.mark.parametrize(("dashpots", "opens", "shears"), COMBINATIONS)
@settings(max_examples=40)
@given(data=st.data())
def test_compiled_law_equals_reference(dashpots, opens, shears, data):
    """Step by step over a path, each step from the compiled history: tractions and memory."""
    one = data.draw(one_law(dashpots, opens, shears))
    h = virgin(one)
    for step in data.draw(paths(one)):
        n, s = scales(one, *step, h)
        t_n, t_x, t_z, after = traction(one, *step, DT, h)
        r_n, r_x, r_z, expected = reference.traction(one, *step, DT, h)
        near(t_n, r_n, n)
        near(t_x, r_x, s)
        near(t_z, r_z, s)
        assert after.opening == expected.opening
        if h.ex is not None:
            near(after.ex, expected.ex, s / one.shear_stiffness)
            near(after.ez, expected.ez, s / one.shear_stiffness)
            if not on_the_edge(one, r_n, step, h, expected.opening, s):
                assert after.cohesion == expected.cohesion
        h = after


@pytest.mark.parametrize("opens", ["ties", "no tension", "softening"])
@given(data=st.data())
def test_compiled_energies_equal_reference(opens, data):
    """What is stored, slid away and broken, and whether anything is left to break."""
    one = data.draw(one_law("", opens, "cfr"))
    h = virgin(one)
    for gap, rate, slip, slip_rate in data.draw(paths(one)):
        n, s = scales(one, gap, rate, slip, slip_rate, h)
        after = traction(one, gap, rate, slip, slip_rate, DT, h)[-1]
        point = (one, gap, after.opening, after.ex, after.ez)
        stored = n * abs(gap) + s**2 / one.shear_stiffness
        near(energy.elastic_energy(*point), reference.elastic_energy(*point), stored)
        slide = (one, h.ex, h.ez, after.ex, after.ez, *slip)
        near(energy.friction_work(*slide), reference.friction_work(*slide), 4 * stored)
        near(spring_traction(*point[:3]), reference.spring_traction(*point[:3]), n)
        assert softening.is_broken(one, after.opening) == reference.is_broken(one, after.opening)
        if opens == "softening":
            spent = energy.fracture_energy_spent(one, after.opening)
            whole = one.tensile_strength * one.critical_opening
            near(spent, reference.fracture_energy_spent(one, after.opening), whole)
        h = after


@given(data=st.data())
def test_unlike_joints_behave_as_if_alone(data):
    """In an array of laws every joint carries what it carries by itself, to the last bit.

    Where a joint lacks a strength that others have, an unlimited one stands in.
    """
    alone = [
        data.draw(one_law("dashpots", "ties", "")),
        data.draw(one_law("dashpots", "no tension", "cf")),
        data.draw(one_law("dashpots", "softening", "")),
        data.draw(one_law("dashpots", "softening", "cfr")),
    ]
    without = {"friction": 0.0, "carries_tension": True}
    parts = {
        name: np.array(
            [
                without.get(name, shear.UNLIMITED) if part is None else part
                for part in (getattr(one, name) for one in alone)
            ]
        )
        for name in Law._fields
    }
    mixed = Law(**parts)
    path = data.draw(paths(alone[-1]))
    for j, one in enumerate(alone):
        a, b = virgin(one), virgin(law_of(mixed, j))
        for step in path:
            *t_alone, a = traction(one, *step, DT, a)
            *t_mixed, b = traction(law_of(mixed, j), *step, DT, b)
            assert t_alone == t_mixed
            assert (a.ex, a.ez) == (b.ex, b.ez)


def test_alike_joints_become_one_number_and_absent_parts_none():
    """No array for what is the same everywhere, nothing at all for what is not there."""
    stiffness, tension = np.full(4, 9e9), np.ones(4, dtype=bool)
    assert law(stiffness, None, tension) == Law(9e9)
    assert law(stiffness, None, tension, shear_stiffness=stiffness / 3) == Law(
        9e9, shear_stiffness=3e9
    )
    mixed = law(
        np.array([1.0, 2.0]),
        np.array([0.5, 0.5]),
        np.array([True, False]),
        shear_stiffness=np.array([4.0, 4.0]),
        friction=np.array([0.0, 0.5]),
    )
    assert mixed.normal_stiffness.tolist() == [1, 2]
    assert mixed.normal_viscosity.tolist() == [0.5, 1]
    assert law_of(mixed, 1) == Law(2.0, 1.0, False, 4.0, 2.0, friction=0.5)
    assert uniform(np.array([3.0, 3.0])) == 3.0
    assert uniform(None) is None


def test_absent_parts_leave_no_instruction(instructions):
    """A plain joint costs one product a direction; no comparison, no quotient, no root."""
    step = (1e-6, 0.1, (1e-6, 0.0), (0.1, 0.0), DT)

    def count(kind, one):
        return instructions(laws.traction, (one, *step, virgin(one)), kind)

    plain = Law(9e9, shear_stiffness=3e9)
    assert [count("fmul", one) for one in (Law(9e9), plain)] == [1, 3]
    assert count("fcmp", plain) == count("fdiv", plain) == 0
    assert count("fcmp", Law(9e9, carries_tension=False)) > 0 == count("fdiv", Law(9e9))
    assert count("fdiv", plain._replace(friction=0.5)) > 0
    assert count("fcmp", Law(9e9, tensile_strength=1e5, critical_opening=1e-3)) > 0


@pytest.mark.parametrize("gap", [1e-5, -1e-5])
def test_normal_part_is_the_first_of_the_whole(gap):
    """An axial scene that calls `normal_traction` alone gets the same number."""
    one = Law(9e9, 1e5, False)
    assert traction(one, gap, 0.1, (0.0, 0.0), (0.0, 0.0), DT, History())[0] == normal_traction(
        one, gap, 0.1
    )
