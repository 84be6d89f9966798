"""The balance of energy of a point, and slip in one direction: what every engine may rely on."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.joints.law import History, Law, rows_of, traction
from jointwave.joints.tangent import tangent
from tests.joints.points import at_point

DT = 1e-5
PLAIN = Law(9e9, shear_stiffness=3e9)
DAMPED = {"normal_viscosity": 1e5, "shear_viscosity": 3e4}
COULOMB = PLAIN._replace(cohesion=1e5, friction=0.5)
LAWS = {
    "elastic": PLAIN,
    "dashpots": PLAIN._replace(**DAMPED),
    "no tension": PLAIN._replace(carries_tension=False),
    "slip": COULOMB,
    "slip with dashpots": COULOMB._replace(**DAMPED),
    "residual": COULOMB._replace(residual_cohesion=2e4),
    "softening": COULOMB._replace(tensile_strength=1e5, critical_opening=1e-4),
    "closure": COULOMB._replace(maximum_closure=3e-4, rock_compliance=0.0),
    "weakening": COULOMB._replace(dynamic_friction=0.2, weakening_distance=2e-4, **DAMPED),
    "dilation": COULOMB._replace(dilation=0.2, dilation_distance=2e-4, **DAMPED),
    "rate and state": COULOMB._replace(
        direct_effect=0.01,
        evolution_effect=0.015,
        critical_slip_distance=1e-3,
        reference_rate=1e-6,
        initial_state=1.0,
    ),
}
#: Of jumps, m: 0.1 mm, mostly closed.
unit = st.floats(-1, 1).map(lambda x: round(x, 6))
paths = st.lists(st.tuples(unit, unit, unit), min_size=2, max_size=12)


def march(one, path, **flags):
    """Yield (step, traction before, after) of every step of a path of jumps, from rest."""
    law, parts = at_point(one)
    parts, history, before = parts._replace(**flags), History(cohesion=one.cohesion or 0.0), None
    for last, jump in pairwise([np.zeros(3), *(1e-4 * np.array(one) for one in path)]):
        step = jump - last
        now = traction(law, parts, tuple(jump), tuple(step), tuple(step / DT), DT, history)
        if before is not None:
            yield step, before, now
        history, before = now.history, now


@pytest.mark.parametrize("name", sorted(set(LAWS) - {"no tension", "softening", "closure"}))
@given(path=paths)
def test_balance_closes_at_every_step(name, path):
    """Mean traction of both ends of a step times its jump, as leapfrog's ledger has it, is what
    the springs store, what sliding takes and what the dashpots' share does. Exactly where springs
    are linear; a lift that grows in the step counts with both its ends."""
    for step, before, now in march(LAWS[name], path):
        work, drag = (
            -0.5 * np.array([part(before), part(now)]).sum(axis=0) @ step
            for part in (lambda t: np.array(t[:3]), lambda t: np.array(t[3:6]))
        )
        gained = now.stored - before.stored + now.spent - before.spent
        size = before.stored + now.stored + (np.abs([before[:6], now[:6]]).max() * 2e-4)
        assert work == pytest.approx(gained + now.slid + drag, abs=1e-12 * size)


@pytest.mark.parametrize("name", ["no tension", "softening", "closure"])
@given(path=paths)
def test_balance_closes_with_the_step_where_springs_bend(name, path):
    """The normal spring's work over a path in n steps to a trapezoid's error; all else exactly."""
    one = LAWS[name]
    errors = []
    for count in (8, 64):
        ends = [np.zeros(3), *map(np.array, path)]
        fine = [a + (b - a) * i / count for a, b in pairwise(ends) for i in range(1, count + 1)]
        missed, first, last = 0.0, None, None
        for step, before, now in march(one, fine):
            first = first or before
            missed -= 0.5 * (np.array(before[:3]) + np.array(now[:3])) @ step + now.slid
            last = now
        missed -= last.stored + last.spent - first.stored - first.spent
        errors.append(abs(missed) / (9e9 * 1e-8 * len(path)))
    assert errors[1] <= errors[0] / 8 + 1e-3


@pytest.mark.parametrize("name", LAWS)
@given(path=paths)
def test_slip_in_one_direction_is_slip_in_two_without_the_other(name, path):
    """To round-off: tractions, history, balance and tangent."""
    one = LAWS[name]
    law, parts = at_point(one)
    line = [(gap, x, 0.0) for gap, x, _ in path]
    for (_, _, whole), (_, _, planar) in zip(
        march(one, line), march(one, line, planar=True), strict=True
    ):
        size = 9e9 * 1e-4 + 1e5 * 20
        assert planar[:6] == pytest.approx(whole[:6], rel=1e-9, abs=1e-9 * size)
        assert planar.history == pytest.approx(whole.history, rel=1e-9, abs=1e-12)
        assert planar[7:] == pytest.approx(whole[7:], rel=1e-8, abs=1e-9 * size * 1e-4)
    for gap, x, _ in path:
        point = (1e-4 * gap, 1e-4 * x, 0.0), (gap, x, 0.0), DT, History(cohesion=1e5), 1e3
        whole, planar = (
            tangent(law, parts, *point),
            tangent(law, parts._replace(planar=True), *point),
        )
        for name in ("nn", "xn", "xx", "nx"):
            expected = pytest.approx(getattr(whole, name), rel=1e-8, abs=1.0)
            assert getattr(planar, name) == expected


def test_rows_that_a_law_reads():
    """Of the table, the fields of its parts alone."""
    rows = rows_of(at_point(COULOMB)[1])
    names = {Law._fields[row] for row in rows}
    assert names == {"normal_stiffness", "shear_stiffness", "cohesion", "friction"}
