"""Newton's method and the matrix of a step, by themselves."""

import numpy as np
import pytest

from jointwave.continuum.implicit import step as implicit_step
from jointwave.continuum.implicit.newton import newton


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
