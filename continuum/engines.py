"""The ways to step a model, under one face."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from jointwave.continuum.implicit.balance import implicit_matrices
from jointwave.continuum.implicit.run import Implicit
from jointwave.continuum.model import Model
from jointwave.continuum.monitor import Monitor
from jointwave.continuum.run import Run
from jointwave.continuum.space.body import Body
from jointwave.continuum.state import State

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


def explicit_engine(run: Run, monitor: Monitor) -> Engine:
    """Return leapfrog."""
    time, communicator = run.choice.time, run.communicator
    if run.sudden is not None:
        apply_sudden_gravity(run.model, run.state, run.discrete.body, run.sudden)
    of_run = run.model, run.state, run.samples
    march = communicator.leapfrog(*of_run, time.stride, monitor.guard)

    def compile() -> None:
        with communicator.in_turn():
            march(0, 0)

    return Engine(compile, march, time.dt, dict)


def apply_sudden_gravity(model: Model, state: State, body: Body, weight: np.ndarray) -> None:
    """Set the velocities before the first step of rock that gravity acts on from t = 0 on.

    At t = 0, in the middle of the first two, it is at rest.
    """
    fall = 0.5 * model.rock.step_over_mass * body.communicator.total(weight)
    if model.rock.decay is not None:
        fall *= 2 / (1 + model.rock.decay)  # step_over_mass is that of damped motion
    if model.ends.fixed is not None:
        fall[model.ends.fixed.freedom] = 0.0
    state.v[:], state.v_before[:] = -fall, -3 * fall


def implicit_engine(run: Run, monitor: Monitor) -> Engine:
    """Return the generalised-alpha method of the scene's spectral radius."""
    rho, stride = run.scene.numerics.continuum.spectral_radius, run.choice.time.stride
    matrices = implicit_matrices(run.discrete.body)
    steps = Implicit(run.model, run.state, run.samples, matrices, rho)

    def attributes() -> dict[str, Any]:
        return {
            "spectral_radius": rho,
            "newton_iterations": int(steps.stepper.counts[0]),
            "factorisations": int(steps.stepper.counts[1]),
            "halved_steps": steps.halvings,
        }

    return Engine(
        steps.compile,
        lambda first, last: steps.run(stride, first, last, monitor),
        0.0,
        attributes,
        steps.parts,
        IMPLICIT_WORK,
    )
