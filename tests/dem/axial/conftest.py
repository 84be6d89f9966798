"""The engine's own step as a matrix, for what its eigenvalues say."""

import numpy as np
import pytest

from cases.material.calibrate import calibrate
from cases.sampling import Clock
from dem.axial.model import build_model
from dem.axial.state import state_at_rest
from dem.axial.step import march


@pytest.fixture
def step_matrix():
    """Return a function of (scene, dt) that gives the matrix of one linear step dt (s).

    Its rows are displacements, velocities, gap rates half a step before and closures of the ends.
    """

    def matrix(scene, dt):
        p = calibrate(scene)
        model = build_model(scene, p, Clock(dt, 1, 1))._replace(load=np.zeros(0))
        size = _packed(state_at_rest(model.chain, p.block_count, False)).size
        step = np.zeros((size, size))
        for i, unit in enumerate(np.eye(size)):
            state = state_at_rest(model.chain, p.block_count, False)
            at = 0
            for x in _parts(state):
                x[:] = unit[at : at + x.size]
                at += x.size
            march(model, state, 0, 1)
            step[:, i] = _packed(state)
        return step

    return matrix


def _parts(state):
    kept = [state.u, state.v, state.gap_rate]
    kept += [None if end is None else end[:1] for end in (state.start, state.end)]
    return [x for x in kept if x is not None]


def _packed(state):
    return np.concatenate(_parts(state))
