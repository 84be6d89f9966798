"""The order of the elements and of the step, by a manufactured motion of the whole body."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import factorized

from continuum.body import whole
from continuum.build import room, state_at_rest
from continuum.critical import critical_time_step
from continuum.explicit import run
from continuum.model import Ends, Model, Receivers, Rock
from continuum.operator import zeros
from continuum.sparse import rows

#: Kind, order p, cells a side of the coarser mesh, and the order of convergence.
MESHES = [
    ("quadrilateral", 1, 8, 2),
    ("quadrilateral", 2, 4, 3),
    ("quadrilateral", 3, 3, 4),
    ("quadrilateral", 4, 2, 5),
    ("hexahedron", 1, 5, 2),
    ("hexahedron", 2, 2, 3),
    ("hexahedron", 3, 2, 4),
    ("hexahedron", 4, 1, 5),
    ("triangle", 1, 8, 2),
    ("triangle", 2, 4, 2),
    ("tetrahedron", 1, 4, 2),
    ("tetrahedron", 2, 3, 2),
]
SIMPLICES = ("triangle", "tetrahedron")
END = 1e-3  # s, 0.6 of a period


def drive(problem, dt, steps, inertia):
    """Return the displacement after so many steps dt (s) of leapfrog from the exact start.

    inertia : g'' (1/s2) at a time (s).
    """
    body, n = problem.body, problem.body.mass.size
    g, start = problem.motion.history, problem.at_nodes()
    none = rows(csr_matrix((0, n)))
    model = Model(
        rock=Rock(body.stiffness, None, body.mass, dt / body.mass, None),
        interfaces=None,
        ends=Ends(None, None, None),
        weight=zeros(n),
        receivers=Receivers(none, None, none, None, none, None),
        dt=dt,
    )
    state = state_at_rest(model, keep_ledger=False)
    state.u[:], state.v[:] = g(0.0) * start, (g(0.0) - g(-dt)) / dt * start
    samples = room(model, state, 1)
    for k in range(steps):
        t = k * dt
        # The weight is a force that may change from step to step.
        model.weight[:] = inertia(t) * problem.inertia + g(t) * problem.elastic
        run(model, state, samples, steps, k, k + 1)
    return state.u


def stiffness(body):
    """Return the stiffness matrix of a body, N/m."""
    return whole(body.layout, body.mesh, body.blocks)


def drive_by_trapezoids(problem, dt, steps):
    """Return the displacement after so many steps dt (s) of the trapezoidal rule, consistent mass.

    Inertia and elastic force of g are taken by the differences and means that the rule takes, so
    that its steps make no error.
    """
    n = np.flatnonzero(problem.body.consistent.diagonal())
    mass, k = (a[n][:, n].tocsc() for a in (problem.body.consistent, stiffness(problem.body)))
    solve, g, found = factorized(mass / dt**2 + k / 4), problem.motion.history, problem.at_nodes()
    before, now = g(-dt) * found[n], g(0.0) * found[n]
    for t in dt * np.arange(steps):
        inertia = (g(t + dt) - 2 * g(t) + g(t - dt)) / dt**2 * problem.inertia[n]
        elastic = (g(t + dt) + 2 * g(t) + g(t - dt)) / 4 * problem.elastic[n]
        old = mass @ (before - 2 * now) / dt**2 + k @ (before + 2 * now) / 4
        before, now = now, solve(inertia + elastic - old)
    found[n] = now
    return found


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


@pytest.mark.parametrize("distorted", [False, True], ids=["straight", "distorted"])
@pytest.mark.parametrize("kind, order, count", [m[:3] for m in MESHES if m[0] in SIMPLICES])
def test_order_of_simplices_with_consistent_mass(problem, kind, order, count, distorted):
    """p + 1, quadratic ones too."""
    errors = []
    for cells in (count, 2 * count):
        one = problem(kind, cells, order, distorted, consistent=True)
        errors.append(one.error(drive_by_trapezoids(one, END / 40, 40), one.motion.history(END)))
    rate = np.log2(errors[0] / errors[1])
    assert order + 0.8 < rate < order + 1.5


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
