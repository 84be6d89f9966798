"""The order of the elements and of the step, by a manufactured motion of the whole body."""

from functools import cache

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from jointwave.continuum.explicit.critical import critical_time_step
from jointwave.continuum.explicit.march import march
from jointwave.continuum.implicit.balance import implicit_matrices
from jointwave.continuum.implicit.run import Implicit
from jointwave.continuum.model import Ends, Model, Receivers, RockOperators
from jointwave.continuum.space.body import whole
from jointwave.continuum.space.operator import zeros
from jointwave.continuum.state import empty_samples, state_at_rest

#: Kind, order p, cells a side of the coarser mesh, and the order of convergence.
MESHES = [
    ("quadrilateral", 1, 8, 2),
    ("quadrilateral", 2, 4, 3),
    ("quadrilateral", 3, 3, 4),
    ("quadrilateral", 4, 2, 5),
    ("hexahedron", 1, 4, 2),
    ("hexahedron", 2, 2, 3),
    ("hexahedron", 3, 2, 4),
    ("hexahedron", 4, 1, 5),
    ("triangle", 1, 8, 2),
    ("triangle", 2, 4, 2),
    ("tetrahedron", 1, 4, 2),
    ("tetrahedron", 2, 3, 2),
]
SIMPLICES = ("triangle", "tetrahedron")
DEAR = ("hexahedron", 3)  # to factorise: implicit steps take orders 1, 2 and 4 by default
END = 1e-3  # s, 0.6 of a period


def model_of(problem, dt):
    """Return the constants of a run of the body alone, whose weight may change from step to step:
    it is the load."""
    body, n = problem.body, problem.body.mass.size
    none = csr_matrix((0, n))
    return Model(
        rock=RockOperators(body.stiffness, None, body.mass, dt / body.mass, None),
        interfaces=None,
        ends=Ends(None, None, None),
        weight=zeros(n),
        receivers=Receivers(none, None, none, None, none, None),
        dt=dt,
    )


def drive(problem, dt, steps, inertia):
    """Return the displacement after so many steps dt (s) of leapfrog from the exact start.

    inertia : g'' (1/s2) at a time (s).
    """
    model, g, start = model_of(problem, dt), problem.motion.history, problem.at_nodes()
    state = state_at_rest(model, keep_ledger=False)
    state.u[:], state.v[:] = g(0.0) * start, (g(0.0) - g(-dt)) / dt * start
    leapfrog = march(model, state, empty_samples(model, state, 1), steps, None)
    for k in range(steps):
        t = k * dt
        model.weight[:] = inertia(t) * problem.inertia + g(t) * problem.elastic
        leapfrog(k, k + 1)
    return state.u


def stiffness(body):
    """Return the stiffness matrix of a body, N/m."""
    return whole(body.layout, body.mesh, body.blocks)


def drive_implicitly(problem, dt, steps, frequency, rho=1.0):
    """Return the displacement after so many implicit steps dt (s) of spectral radius rho, from the
    exact start; frequency : rad/s, that velocity and inertia of the motion are taken with."""
    model, motion, start = model_of(problem, dt), problem.motion, problem.at_nodes()
    state = state_at_rest(model, keep_ledger=False)
    speed = frequency * np.cos(motion.start)
    state.u[:], state.v[:] = motion.history(0.0) * start, speed * start
    samples = empty_samples(model, state, 1)
    stepper = Implicit(model, state, samples, implicit_matrices(problem.body), rho)
    for k in range(steps + 1):
        load = problem.elastic - frequency**2 * problem.inertia
        model.weight[:] = motion.history(k * dt) * load
        stepper.run(steps + 1, k, k + 1)
    return state.u


def trapezoids_own(motion, dt):
    """Return the frequency (rad/s) that the trapezoidal rule sees a sine with: under it, its steps
    make no error."""
    return 2 / dt * np.tan(motion.omega * dt / 2)


def steps_of(problem, fraction):
    """Return how many equal steps of this fraction of the critical one reach the end."""
    critical = critical_time_step(problem.body.mass, stiffness(problem.body))
    return int(np.ceil(END / (fraction * critical)))


def leapfrogs_own(motion, dt):
    """Return g'' as leapfrog takes it, by differences: under it, its steps make no error."""
    g = motion.history
    return lambda t: (g(t + dt) - 2 * g(t) + g(t - dt)) / dt**2


@pytest.mark.parametrize("kind", ["quadrilateral", "tetrahedron"])
def test_the_loads_balance_the_motion(problem, kind):
    """rho u'' is the body force and the divergence of the stress: here by central differences."""
    motion, h = problem(kind, 1, 1).motion, 1e-5
    dim, lame = len(motion.phase), (3e9, 2e9)
    x = np.random.default_rng(0).random((20, dim))
    steps = h * np.eye(dim)
    gradient = np.stack(
        [(motion.displacement(x + d) - motion.displacement(x - d)) / (2 * h) for d in steps], axis=2
    )
    trace = np.trace(gradient, axis1=1, axis2=2)[:, None, None] * np.eye(dim)
    stress = lame[0] * trace + lame[1] * (gradient + gradient.transpose(0, 2, 1))
    assert np.abs(motion.stress(x, *lame) - stress).max() < 1e-8 * np.abs(stress).max()
    divergence = sum(
        (motion.stress(x + d, *lame) - motion.stress(x - d, *lame))[:, :, j] / (2 * h)
        for j, d in enumerate(steps)
    )
    exact = motion.divergence(x, *lame)
    assert np.abs(exact - divergence).max() < 1e-8 * np.abs(exact).max()


@pytest.mark.parametrize("distorted", [False, True], ids=["straight", "distorted"])
@pytest.mark.parametrize("kind, order, count, expected", MESHES)
def test_order_of_the_elements(problem, kind, order, count, expected, distorted):
    """The displacement converges at p + 1 in the L2 norm, with steps that make no error.

    Lumped quadratic simplices converge at 2: the diagonal of their mass, scaled, integrates only
    linear functions exactly, and the error of a smooth load is second order (Strang & Fix, An
    Analysis of the Finite Element Method, 1973, section 4.3).
    """
    errors = []
    for cells in (count, 2 * count):
        one = problem(kind, cells, order, distorted)
        steps = steps_of(one, 0.9)
        u = drive(one, END / steps, steps, leapfrogs_own(one.motion, END / steps))
        errors.append(one.error(u, one.motion.history(END)))
    rate = np.log2(errors[0] / errors[1])
    assert expected - 0.2 < rate < expected + 0.5


@pytest.mark.parametrize(
    "kind, order, count, expected, consistent",
    [pytest.param(*mesh, False, marks=[pytest.mark.slow] * (mesh[:2] == DEAR)) for mesh in MESHES]
    + [(*mesh[:3], mesh[1] + 1, True) for mesh in MESHES if mesh[0] in SIMPLICES],
)
def test_order_of_the_elements_in_implicit_steps(problem, kind, order, count, expected, consistent):
    """The same orders; p + 1 for quadratic simplices too, where their mass is consistent. Steps of
    any length make no error."""
    errors, dt = [], END / 10
    for cells in (count, 2 * count):
        one = problem(kind, cells, order, True, consistent)
        u = drive_implicitly(one, dt, 10, trapezoids_own(one.motion, dt))
        errors.append(one.error(u, one.motion.history(END)))
    rate = np.log2(errors[0] / errors[1])
    assert expected - 0.2 < rate < expected + 0.5


@pytest.mark.parametrize("kind", ["quadrilateral", "hexahedron"])
def test_order_of_the_step(problem, kind):
    """Two: the distance from the steps under leapfrog's own inertia, which make no error."""
    one, errors = problem(kind, 1, 4), []
    coarsest = steps_of(one, 0.9)
    for steps in (coarsest, 2 * coarsest, 4 * coarsest):
        dt = END / steps
        u = drive(one, dt, steps, one.motion.acceleration)
        errors.append(np.linalg.norm(u - drive(one, dt, steps, leapfrogs_own(one.motion, dt))))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.02)


@cache
def without_error_of_steps(problem, kind, steps):
    """Return the displacement of one cell of order 4 at the end, after trapezoidal steps."""
    one, dt = problem(kind, 1, 4), END / steps
    return drive_implicitly(one, dt, steps, trapezoids_own(one.motion, dt))


@pytest.mark.parametrize("rho", [1.0, 0.5, 0.0])
@pytest.mark.parametrize("kind", ["quadrilateral", "hexahedron"])
def test_order_of_the_implicit_step(problem, kind, rho):
    """Two for every spectral radius: the distance from steps that make no error."""
    one, errors = problem(kind, 1, 4), []
    for steps in (60, 120, 240):
        u = drive_implicitly(one, END / steps, steps, one.motion.omega, rho)
        errors.append(np.linalg.norm(u - without_error_of_steps(problem, kind, steps)))
    assert np.diff(-np.log2(errors)) == pytest.approx([2, 2], abs=0.05)
