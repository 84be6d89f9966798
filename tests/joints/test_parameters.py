"""A parameter of the law reaches every kernel, and a formula of one's own is built on the law."""

import numba
import numpy as np
import pytest

from jointwave.joints.formula import formula
from jointwave.joints.law import OF_PART, History, Law, LawFlags, law_at, law_of, table_of, traction
from tests.joints.points import at_point

DT = 1e-5


def test_every_parameter_is_of_a_part_and_in_the_tables_of_kernels():
    names = [name for own in OF_PART.values() for name in own]
    assert sorted(["normal_stiffness", *names]) == sorted(Law._fields)
    assert set(OF_PART) <= set(LawFlags._fields)
    whole = Law(*(np.arange(2.0) + 10 * row for row in range(len(Law._fields))))
    for j in range(2):
        expected = Law(*(10.0 * row + j for row in range(len(Law._fields))))
        assert law_of(table_of(whole), j) == expected
        assert law_at(table_of(whole).ravel(), j, 2) == expected


@formula
def rough(table, parts, jump, step, rate, dt, history):
    """Return the `Traction` of the weaker of two laws: Patton's bilinear strength (1966)."""
    ridden = traction(law_of(table, 0), parts, jump, step, rate, dt, history)
    sheared = traction(law_of(table, 1), parts, jump, step, rate, dt, history)
    weaker = abs(ridden.x) < abs(sheared.x)
    return ridden if weaker else sheared


@pytest.mark.parametrize(("pressure", "limit"), [(1e5, 1e5), (2e5, 2e5), (1e6, 6e5)])
def test_a_formula_built_on_the_law_compiles(pressure, limit):
    """|T| <= min(t_n, 1e5 Pa + 0.5 t_n): both are 2e5 Pa under 2e5 Pa."""
    ways = Law(1e10, shear_stiffness=1e10, cohesion=[0.0, 1e5], friction=[1.0, 0.5])
    table, parts = table_of(ways), at_point(ways)[1]

    @numba.njit(error_model="numpy")
    def kernel(table, gap, slip):
        step, rate = (0.0, slip, 0.0), (0.0, slip / DT, 0.0)
        found = rough(
            table, parts, (gap, slip, 0.0), step, rate, DT, History(0.0, 0.0, 0.0, 0.0, 0.0)
        )
        return found.n, found.x, found.history.slide_x

    n, x, slide = kernel(table, -pressure / 1e10, 1e-3)
    assert (n, x) == pytest.approx((pressure, -limit), rel=1e-12)
    assert slide == pytest.approx(1e-3 - limit / 1e10, rel=1e-12)
