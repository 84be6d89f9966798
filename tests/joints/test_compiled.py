"""Compiled into a kernel, the law is what Python says, part by part, and nothing besides; a formula
of one's own is built on it."""

import re
from itertools import product

import numba
import numpy as np
import pytest

from jointwave.joints.formula import formula
from jointwave.joints.law import History, Law, law_of, parts_of, table_of, traction
from jointwave.joints.tangent import tangent
from tests.joints.points import RATE

N, DT, HISTORY = 64, 1e-5, History()
ELASTIC = Law(9e9, shear_stiffness=3e9)
WHOLE = Law(9e9, 1e5, False, 3e9, 3e4, 1e6, 0.5, 1e5, 1e6, 1e-3)
CLOSES = {"maximum_closure": 5e-4, "rock_compliance": 1e-11}
LAWS = {
    "no tension": ELASTIC._replace(carries_tension=False, **CLOSES),
    "dilation": WHOLE._replace(
        dynamic_friction=0.2, weakening_distance=2e-3, dilation=0.2, dilation_distance=2e-3
    ),
    "rate and state": WHOLE._replace(**RATE),
    "all of softening": WHOLE._replace(carries_tension=None),
}


def compiled(function):
    """Return a function as kernels are compiled."""
    return numba.njit(error_model="numpy", no_cfunc_wrapper=True)(function)


def kernel_of(parts):
    """Return a compiled loop over points: traction, memory and tangent of each."""

    @compiled
    def load(table, motion, memory, force, slope, r):
        law = law_of(table, 0)
        for i in range(motion.shape[1]):
            if parts.varied:
                law = law_of(table, i)
            before = History(memory[0, i], memory[1, i], memory[2, i], memory[3, i], memory[4, i])
            jump, step = (motion[0, i], motion[1, i], motion[2, i]), (0.0, 0.0, 0.0)
            rate = (motion[3, i], motion[4, i], motion[5, i])
            found = traction(law, parts, jump, step, rate, DT, before)
            force[0, i], force[1, i], force[2, i] = found.n, found.x, found.z
            for k in range(5):
                memory[k, i] = found.history[k]
            slopes = tangent(law, parts, jump, rate, DT, before, r)
            for k in range(8):
                slope[k, i] = slopes[k]

    return load


def points(seed=1):
    """Return motions [6, n], jump and rate, that reach every branch, and memories [5, n] before."""
    r = np.random.default_rng(seed)
    motion = r.uniform(-1, 1, (6, N)) * np.array([[1e-3], [1e-3], [1e-3], [1.0], [1.0], [1.0]])
    memory = np.abs(r.uniform(-1, 1, (5, N)))
    memory *= np.array([[1.2e-3], [1e-4], [1e-4], [1e6], [1e-3]])
    return motion, memory


@pytest.mark.parametrize("name, varied", [*product(LAWS, [True]), ("all of softening", False)])
def test_kernel_is_python(name, varied):
    """Bit for bit but for the last digit of a product and a sum in one instruction. Each point has
    a law of its own, or all have one."""
    one = LAWS[name]
    if varied:
        one = Law(*(None if part is None else np.full(N, part) for part in one))
    table, parts, (motion, memory) = table_of(one), parts_of(one), points()
    force, slope, after = np.zeros((3, N)), np.zeros((8, N)), memory.copy()
    kernel = kernel_of(parts)
    kernel(table, motion, after, force, slope, 1e3)
    for i in range(N):
        law = law_of(table, i if varied else 0)
        jump, rate, before = tuple(motion[:3, i]), tuple(motion[3:, i]), History(*memory[:, i])
        found = traction(law, parts, jump, (0.0, 0.0, 0.0), rate, DT, before)
        assert force[:, i] == pytest.approx(found[:3], rel=1e-12, abs=1e-6)
        assert after[:, i] == pytest.approx(found.history, rel=1e-12, abs=1e-18)
        assert slope[:, i] == pytest.approx(
            tangent(law, parts, jump, rate, DT, before, 1e3), rel=1e-9, abs=1e-3
        )


KINDS = ("fcmp", "fdiv", "fmul")


def counts(one, formula):
    """Return how many of each kind of instruction one point of a law takes."""
    parts, table = parts_of(one), table_of(one)

    @compiled
    def point(table, gap, x, n, vx, opening, slide, cohesion):
        law, h = law_of(table, 0), History(opening, slide, slide, cohesion, 0.0)
        jump, step, rate = (gap, x, x), (0.0, 0.0, 0.0), (n, vx, vx)
        if formula == "traction":
            found = traction(law, parts, jump, step, rate, DT, h)
            return found.n, found.x, found.z
        slope = tangent(law, parts, jump, rate, DT, h, 1e3)
        return slope.nn, slope.xx, slope.xn

    point(table, 1e-6, 0.1, 1e-6, 0.1, 0.0, 0.0, 0.0)
    text = "\n".join(point.inspect_llvm().values())
    return [len(re.findall(rf"= {kind} ", text)) for kind in KINDS]


@pytest.mark.parametrize(("formula", "products"), [("traction", 2), ("tangent", 0)])
def test_absent_parts_leave_no_instruction(formula, products):
    """A plain joint costs one product a direction, no comparison, no quotient, no root; friction
    brings all of them."""
    assert counts(ELASTIC, formula) == [0, 0, products]  # both shears are of one slip
    assert min(counts(ELASTIC._replace(friction=0.5), formula)) > 0


@formula
def rough(table, parts, jump, step, rate, dt, history):
    """Return the `Traction` of the weaker of two laws: Patton's bilinear strength (1966)."""
    ridden = traction(law_of(table, 0), parts, jump, step, rate, dt, history)
    sheared = traction(law_of(table, 1), parts, jump, step, rate, dt, history)
    weaker = abs(ridden.x) < abs(sheared.x)
    return ridden if weaker else sheared


def test_a_formula_built_on_the_law_compiles():
    """|T| <= min(t_n, 1e5 Pa + 0.5 t_n): both are 2e5 Pa under 2e5 Pa."""
    ways = Law(1e10, shear_stiffness=1e10, cohesion=[0.0, 1e5], friction=[1.0, 0.5])
    table, parts = table_of(ways), parts_of(ways)

    @compiled
    def kernel(table, gap, slip):
        step, rate = (0.0, slip, 0.0), (0.0, slip / DT, 0.0)
        before = History(0.0, 0.0, 0.0, 0.0, 0.0)
        found = rough(table, parts, (gap, slip, 0.0), step, rate, DT, before)
        return found.n, found.x, found.history.slide_x

    for pressure, limit in ((1e5, 1e5), (2e5, 2e5), (1e6, 6e5)):
        n, x, slide = kernel(table, -pressure / 1e10, 1e-3)
        assert (n, x) == pytest.approx((pressure, -limit), rel=1e-12)
        assert slide == pytest.approx(1e-3 - limit / 1e10, rel=1e-12)
