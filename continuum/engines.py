"""The ways to step a model, under one face."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from cases.schema.scene import Scene
from continuum.build import Discrete
from continuum.model import Model, Samples, State
from continuum.monitor import Monitor
from continuum.space.body import Body

IMPLICIT_WORK = 100  # some corrections, each a triangular solve and often a factorisation


class Engine(NamedTuple):
    """One way to step a model.

    compile : compiles its kernels and changes nothing.
    march : function of (first, last) that takes the steps up to that of step last - 1.
    ahead : s, how far displacements are beyond the last of these when `march` returns.
    attributes : what a result says of the steps. parts : arrays that change beside the state.
    work : of a step, over one of leapfrog.
    """

    compile: Callable[[], None]
    march: Callable[[int, int], object]
    ahead: float
    attributes: Callable[[], dict[str, Any]]
    parts: Any = ()
    work: int = 1


def explicit_engine(
    scene: Scene, discrete: Discrete, model: Model, state: State, samples: Samples, monitor: Monitor
) -> Engine:
    """Return leapfrog."""
    communicator = discrete.body.communicator
    if scene.gravity is not None and not scene.gravity.static:
        let_go(model, state, discrete.body)
    march = communicator.leapfrog(model, state, samples, monitor.time.stride, monitor.guard)

    def compile() -> None:
        with communicator.in_turn():
            march(0, 0)

    return Engine(compile, march, monitor.time.dt, dict)


def let_go(model: Model, state: State, body: Body) -> None:
    """Set the velocities before the first step of rock that gravity acts on from t = 0 on.

    At t = 0, in the middle of the first two, it is at rest.
    """
    fall = 0.5 * model.rock.step_over_mass * body.communicator.total(model.weight)
    if model.rock.decay is not None:
        fall *= 2 / (1 + model.rock.decay)  # step_over_mass is that of damped motion
    if model.ends.fixed is not None:
        fall[model.ends.fixed.freedom] = 0.0
    state.v[:], state.v_before[:] = -fall, -3 * fall


def implicit_engine(
    scene: Scene, discrete: Discrete, model: Model, state: State, samples: Samples, monitor: Monitor
) -> Engine:
    """Return the generalised-alpha method of the scene's spectral radius."""
    from continuum.implicit.balance import implicit_matrices
    from continuum.implicit.run import Implicit

    rho = scene.numerics.continuum.spectral_radius
    run = Implicit(model, state, implicit_matrices(discrete.body), rho)

    def attributes() -> dict[str, Any]:
        return {
            "spectral_radius": rho,
            "newton_iterations": int(run.stepper.counts[0]),
            "factorisations": int(run.stepper.counts[1]),
            "halved_steps": run.halvings,
        }

    return Engine(
        lambda: run.compile(samples),
        lambda first, last: run.run(samples, monitor.time.stride, first, last, monitor),
        0.0,
        attributes,
        run.parts,
        IMPLICIT_WORK,
    )
