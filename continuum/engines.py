"""The ways to step a model, under one face."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from cases.sampling import Clock
from cases.scene import Scene
from continuum.body import Body
from continuum.build import Discrete
from continuum.model import Model, Samples, State


class Engine(NamedTuple):
    """One way to step a model.

    compile : compiles its kernels and changes nothing.
    march : function of (first, last) that takes the steps up to that of step last - 1.
    ahead : s, how far displacements are beyond the last of these when `march` returns.
    attributes : what a result says of the steps. reached : the last whole step that was done.
    """

    compile: Callable[[], None]
    march: Callable[[int, int], None]
    ahead: float
    attributes: Callable[[], dict[str, Any]]
    reached: Callable[[], int]

    def samples_done(self, time: Clock) -> int:
        """Return how many samples have been taken when a run stops on its way."""
        return self.reached() // time.stride + 1


def explicit_engine(
    scene: Scene, discrete: Discrete, model: Model, state: State, samples: Samples, time: Clock
) -> Engine:
    """Return leapfrog."""
    team, held = discrete.body.team, model.ends.held
    if scene.gravity is not None and not scene.gravity.static:
        let_go(model, state, discrete.body)
    run = team.stepping(np.zeros(0, dtype=np.int64) if held is None else held.freedom)

    def march(first: int, last: int) -> None:
        run(model, state, samples, time.stride, first, last)

    def compile() -> None:
        with team.in_turn():
            march(0, 0)

    return Engine(compile, march, time.dt, dict, lambda: time.steps)


def let_go(model: Model, state: State, body: Body) -> None:
    """Set the velocities before the first step of rock that gravity acts on from t = 0 on.

    At t = 0, in the middle of the first two, it is at rest.
    """
    fall = 0.5 * model.rock.step_over_mass * body.team.total(model.weight)
    if model.rock.keep is not None:
        fall *= 2 / (1 + model.rock.keep)  # step_over_mass is that of damped motion
    if model.ends.held is not None:
        fall[model.ends.held.freedom] = 0.0
    state.v[:], state.v_before[:] = -fall, -3 * fall


def implicit_engine(
    scene: Scene, discrete: Discrete, model: Model, state: State, samples: Samples, time: Clock
) -> Engine:
    """Return the generalised-alpha method of the scene's spectral radius."""
    from continuum.implicit import Implicit
    from continuum.implicit_step import rock_matrices

    rho = scene.numerics.continuum.spectral_radius
    run = Implicit(model, state, rock_matrices(discrete.body), rho)

    def attributes() -> dict[str, Any]:
        return {
            "spectral_radius": rho,
            "newton_iterations": run.stepper.iterations,
            "factorisations": run.stepper.factorisations,
            "halved_steps": run.halvings,
        }

    return Engine(
        lambda: run.compile(samples),
        lambda first, last: run.run(samples, time.stride, first, last),
        0.0,
        attributes,
        lambda: run.reached,
    )
