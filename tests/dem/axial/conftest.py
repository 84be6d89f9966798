"""The engine's own step as a matrix, for what its eigenvalues say."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock
from jointwave.dem.axial.build import build_model
from jointwave.dem.axial.leapfrog import march
from jointwave.dem.axial.state import state_at_rest


@pytest.fixture
def step_matrix(plain):
    """Return a function of (scene, dt) that gives the matrix of one linear step dt (s), taken as
    plain Python.

    Its rows are displacements, velocities, gap rates half a step before and closures of the ends.
    """

    def matrix(scene, dt):
        p = calibrate(scene)
        model = build_model(scene, p, Clock(dt, 1, 1))._replace(load=np.zeros(0))
        effects = model.effects
        size = _packed(state_at_rest(effects, p.block_count, False), effects).size
        step = np.zeros((size, size))
        for i, unit in enumerate(np.eye(size)):
            state = state_at_rest(model.effects, p.block_count, False)
            at = 0
            for x in _parts(state, effects):
                x[:] = unit[at : at + x.size]
                at += x.size
            march(model, state, 0, 1)
            step[:, i] = _packed(state, effects)
        return step

    return matrix


def _parts(state, effects):
    held = ((effects.start, state.start), (effects.end, state.end))
    kept = [state.u, state.v, state.gap_rate, *(end[:1] for is_held, end in held if is_held)]
    return [x for x in kept if x is not None]


def _packed(state, effects):
    return np.concatenate(_parts(state, effects))
