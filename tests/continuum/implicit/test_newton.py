"""Newton's method and the matrix of a step, by themselves."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix, random

from jointwave.continuum.implicit import step as implicit_step
from jointwave.continuum.implicit.factors import Factors
from jointwave.continuum.implicit.newton import MOST_ITERATIONS, newton
from jointwave.continuum.implicit.pattern import pattern


def roots_of_two(x):
    return 2 - x**2, 1e-12


def test_errors_are_squared_in_every_iteration():
    """x^2 = 2 from 1: the residual is the square of the last one over 4 x^2."""
    at = [1.0]

    def correction(rest):
        step = rest / (2 * at[-1])
        at.append(at[-1] + step[0])
        return step

    outcome = newton(roots_of_two, correction, np.array([1.0]))
    assert outcome.converged
    assert outcome.x == pytest.approx([np.sqrt(2)], rel=1e-14)
    for k in range(1, 4):
        expected = outcome.errors[k - 1] ** 2 / (4 * at[k - 1] ** 2)
        assert outcome.errors[k] == pytest.approx(expected, rel=1e-6)


def test_a_linear_problem_is_solved_though_its_start_would_do():
    """One correction leaves round-off, where the tolerance alone would leave what it allows."""
    outcome = newton(lambda x: (1 - x, 1e-3), lambda rest: rest, np.array([0.9999]))
    assert outcome.converged and outcome.x.tolist() == [1.0]
    assert len(outcome.errors) == 2


def test_nothing_is_corrected_where_nothing_moves():
    def correction(rest):
        raise AssertionError

    assert newton(lambda x: (0 * x, 0.0), correction, np.zeros(3)).converged


@pytest.mark.parametrize("rest", [np.array([1.0]), np.array([np.nan])])
def test_failure_is_told_and_bounded(rest):
    """A residual that stays takes all iterations, one that is no number takes one."""
    outcome = newton(lambda x: (rest, 1e-3), lambda rest: rest, np.zeros(1))
    assert not outcome.converged
    assert len(outcome.errors) == (1 if np.isnan(rest[0]) else MOST_ITERATIONS + 1)


def test_what_is_no_number_is_no_solution():
    """Not even where what may be left grows with it."""
    outcome = newton(lambda x: (x + np.nan, np.inf), lambda rest: rest, np.zeros(1))
    assert not outcome.converged


def test_factors_solve_what_they_were_given_last():
    """Two matrices of one pattern, neither symmetric."""
    rng = np.random.default_rng(1)
    matrix = csr_matrix(random(60, 60, 0.1, random_state=1) + 10 * np.eye(60))
    factors = Factors(matrix.indptr, matrix.indices)
    for _ in range(2):
        matrix.data *= rng.uniform(0.5, 2, matrix.nnz)
        factors.factorise(matrix.data)
        right = rng.standard_normal(60)
        assert matrix @ factors.solve(right) == pytest.approx(right, abs=1e-12)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_joints_on_the_pattern_are_the_product_of_their_matrices(short, implicit, dim):
    """B^T D B with any D, friction's one-sided coupling of shear to the gap included, among the
    freedoms that move."""
    scene = short(
        load__direction=[0.6, 0.8, 0.0],
        joints__friction_angle=30.0,
        ends__end="fixed",
        **({"motion__rotation": "none"} if dim == 1 else {}),
    )
    run = implicit(scene, dim=dim)
    joints, free = run.model.interfaces, run.implicit.stepper.free
    size, q = run.state.u.size, joints.area.size
    found = pattern([csr_matrix((size, size))], joints, free)
    nn, xn, zn, xx, xz, zz = d = np.random.default_rng(1).standard_normal((6, q))
    jumps = [joints.jump[d * q : (d + 1) * q] for d in range(joints.directions)]
    blocks = [[nn, 0 * nn, 0 * nn], [xn, xx, xz], [zn, xz, zz]]
    expected = csr_matrix((size, size))
    for a, left in enumerate(jumps):
        for b, right in enumerate(jumps):
            expected = expected + left.T @ csr_matrix(np.diag(blocks[a][b])) @ right
    values = found.joints @ d.ravel()
    matrix = csr_matrix((values, found.column, found.start), (free.size, free.size))
    assert abs(matrix - expected[free][:, free]).max() < 1e-14
    assert found.diagonal.tolist() == [
        found.start[i] + list(found.column[found.start[i] : found.start[i + 1]]).index(i)
        for i in range(free.size)
    ]


def test_matrices_on_the_pattern_are_themselves(short, implicit):
    run = implicit(short(ends__end="fixed"))
    free, size = run.implicit.stepper.free, run.state.u.size
    parts = [csr_matrix(random(size, size, 0.05, random_state=k)) for k in range(2)]
    found = pattern(parts, None, free)
    assert found.joints.shape == (found.column.size, 0)
    for part, values in zip(parts, found.fixed, strict=True):
        matrix = csr_matrix((values, found.column, found.start), (free.size, free.size))
        assert abs(matrix - part[free][:, free]).max() < 1e-15


@pytest.mark.parametrize("zeta", [None, 0.02])
def test_slip_that_turns_converges_quadratically(pillar, implicit, monkeypatch, zeta):
    """The direction of Coulomb's traction bends the residual. Beside the solution, what one
    correction leaves goes with the square of the distance; a tangent that is not the derivative
    would leave a share of the distance itself."""
    scene = pillar(
        pillar__length=1.0,
        time__duration=2e-3,
        record={"stress": [0.5], "velocity": [0.75], "interval": 2e-4},
        motion__rotation="none",
        load__direction=[1.0, 0.0, 0.0],
        joints__friction_angle=30.0,
        prestress={"normal": 1e6},
        **({} if zeta is None else {"joints__damping_ratio": zeta}),
    )
    run = implicit(scene, rho=0.9)
    body, state = run.discrete.body, run.state
    for component, speed in ((0, 1.0), (2, 0.5)):
        state.v[body.freedom(body.cells[-1], component)] = speed
    run.implicit.run(1, 0, 4)
    assert run.energy("friction")[3] > 0
    solution = run.implicit.stepper.step(3, 1.0, 0).x
    way = np.abs(solution).max() * np.random.default_rng(1).standard_normal(solution.size)
    errors = []
    for distance in (1e-2, 1e-3, 1e-4):
        start = solution + distance * way
        monkeypatch.setattr(
            implicit_step,
            "newton",
            lambda rest, correct, _, communicator, x=start: newton(rest, correct, x),
        )
        errors.append(run.implicit.stepper.step(3, 1.0, 0).errors[:2])
    orders = np.log10(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx(np.array([[1, 2], [1, 2]]), abs=0.1)


def test_a_linear_run_is_factorised_once(short, implicit):
    """With dashpots and half joints: one correction is enough in every step."""
    scene = short(joints__damping_ratio=0.05, ends__start="matched", ends__end="quiet")
    run = implicit(scene, rho=0.9).go()
    assert run.implicit.stepper.counts[1] == 1
    assert run.implicit.stepper.counts[0] == run.clock.steps
