"""The order of the elements and of the step, by a manufactured motion g(t) U(x) of a whole body."""

import numpy as np
import pytest

from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.problem import Problem
from tests.continuum.stacked import readings
from tests.verification.moved import END, Load, moved

#: Kind, order p, and cells a side of the coarser mesh.
MESHES = [
    *(("quadrilateral", p, count) for p, count in ((1, 8), (2, 4), (3, 3), (4, 2))),
    *(("hexahedron", p, count) for p, count in ((1, 4), (2, 2), (3, 2))),
    *(("triangle", p, count) for p, count in ((1, 8), (2, 4))),
    *(("tetrahedron", p, count) for p, count in ((1, 4), (2, 3))),
]
NEVER = 10**9  # steps between samples


def free(one):
    return Problem(one.body, readings(one.body))


def drive(one, dt, steps, inertia):
    """Return the displacement after so many steps dt (s) of leapfrog from the exact start. inertia
    : g'' (1/s2) at a time (s)."""
    g, start = one.motion.history, one.motion.displacement(one.body.x).ravel()
    leapfrog = Leapfrog(free(one)._replace(forces=Load(one, dt, inertia)), dt, 1)
    leapfrog.start(g(0.0) * start)
    for before in (leapfrog.state.v, leapfrog.state.v_before):
        leapfrog.place((g(0.0) - g(-dt)) / dt * start, before)
    leapfrog.take(0, steps, NEVER)
    return leapfrog.u


def leapfrogs_own(motion, dt):
    """Return g'' as leapfrog takes it, by differences: under it, its steps make no error."""
    g = motion.history
    return lambda t: (g(t + dt) - 2 * g(t) + g(t - dt)) / dt**2


def steps_of(one):
    """Return how many equal steps of 0.9 of the critical one reach the end."""
    return int(np.ceil(END / (0.9 * free(one).critical_step())))


@pytest.mark.parametrize("kind, order, count", MESHES)
def test_order_of_the_elements(kind, order, count):
    """The displacement converges at p + 1 in the L2 norm, with steps that make no error."""
    errors = []
    for cells in (count, 2 * count):
        one = moved(kind, order, cells)
        dt = END / steps_of(one)
        u = drive(one, dt, steps_of(one), leapfrogs_own(one.motion, dt))
        errors.append(one.error(u))
    rate = np.log2(errors[0] / errors[1])
    assert order + 1 - 0.2 < rate < order + 1 + 0.5


@pytest.mark.parametrize("kind", ["quadrilateral", "hexahedron"])
def test_order_of_the_step(kind):
    """Two: the distance from the steps under leapfrog's own inertia, which make no error."""
    one, errors = moved(kind, 4, 1), []
    for steps in (steps_of(one), 2 * steps_of(one), 4 * steps_of(one)):
        dt = END / steps
        u = drive(one, dt, steps, one.motion.acceleration)
        errors.append(np.linalg.norm(u - drive(one, dt, steps, leapfrogs_own(one.motion, dt))))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.02)
