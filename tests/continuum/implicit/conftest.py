"""Implicit runs of scenes, with what they are made of within reach."""

from typing import Any, NamedTuple

import numpy as np
import pytest

from jointwave.cases.sampling import Clock
from jointwave.continuum.build import build_model, discretise
from jointwave.continuum.implicit.balance import implicit_matrices
from jointwave.continuum.implicit.run import Implicit
from jointwave.continuum.state import TERMS, empty_samples, state_at_rest


class Run(NamedTuple):
    """A run before its first step; `go` takes it to the end."""

    discrete: Any
    model: Any
    state: Any
    samples: Any
    clock: Any
    implicit: Any

    def go(self):
        self.implicit.run(self.clock.stride, 0, self.clock.steps + 1)
        return self

    def energy(self, term):
        return self.samples.energy[TERMS.index(term)]


@pytest.fixture
def implicit():
    """Return a function that makes a run of a scene, ready to go.

    rho : spectral radius. stride : steps per sample. dim, kind : of the model. change : function
    of the model that returns another. ledger : whether it is kept.
    """

    def make(scene, rho=1.0, stride=1, kind="jointed", dim=None, change=None, ledger=True):
        discrete = discretise(scene, kind, dim)
        count = int(scene.time.duration / scene.interval + 1e-9) + 1
        clock = Clock(scene.interval / stride, stride, count)
        model = build_model(scene, discrete, kind, clock)
        model = model if change is None else change(model)
        state = state_at_rest(model, ledger)
        samples = empty_samples(model, state, count)
        stepper = Implicit(model, state, samples, implicit_matrices(discrete.body), rho)
        return Run(discrete, model, state, samples, clock, stepper)

    return make


@pytest.fixture
def short(pillar):
    """Return a function that gives ten blocks of the paper's pillar for 10 ms, keys changed."""

    def scene(**changes):
        few = {"pillar__length": 5.0, "time__duration": 0.01}
        few |= {"record__stress": [2.0], "record__velocity": [1.0]}
        return pillar(**few | changes)

    return scene


def with_pressure(pressure):
    """Return a change of a model: another history of its load, Pa [steps + 1]."""

    def change(model):
        loaded = model.ends.loaded._replace(pressure=pressure)
        return model._replace(ends=model.ends._replace(loaded=loaded))

    return change


@pytest.fixture
def noise():
    """Return a function of a number of steps that gives a change of a model: a load of 1 MPa noise,
    which holds every frequency."""

    def change(steps):
        return with_pressure(1e6 * np.random.default_rng(1).standard_normal(steps + 1))

    return change
