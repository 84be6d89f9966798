"""Short rows of blocks in space, the state that steps leave, and the step as a matrix."""

from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np
import pytest

from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Clock
from jointwave.dem.spatial.build import buffers_for, build_model, samples_for, state_at_rest
from jointwave.dem.spatial.ends import CLOSURE
from jointwave.dem.spatial.layout import LANES, STRIDE, TERMS, packed, unpacked
from jointwave.dem.spatial.march import make_stepper
from jointwave.dem.spatial.simulate import prepare
from jointwave.numerics.divergence import guard

SHORT: dict[str, Any] = {
    "pillar__length": 8.0,
    "rock__intact_modulus": None,  # at a wall the half spring of a joint, whose numbers are at hand
    "load__amplitude": 1e5,
    "load__direction": [0.48, 0.6, -0.64],
    "load__at": [0.1, -0.05],
    "time__duration": 0.03,
    "record": {"stress": [0.0, 2.0, 5.0, 8.0], "velocity": [3.0, 6.0], "interval": 1e-4},
}


class Row(NamedTuple):
    """A row of blocks in the middle of its steps."""

    p: Properties
    model: Any
    state: Any
    samples: Any
    time: Clock

    def take(self, first: int, last: int, guarded: bool = True) -> None:
        """Take the steps first .. last - 1, by the kernel of runs: under a guard of energy alone,
        which a row that was put in motion after its first sample cannot have."""
        unheld = guard([np.inf] * self.model.form.freedoms) if guarded else None
        buffers = buffers_for(self.model, 1, unheld)
        make_stepper(self.model, self.state, buffers, self.samples)(first, last)

    @property
    def motion(self) -> np.ndarray:
        """Displacements and rotations, then their rates half a step before: [2 freedoms, N]."""
        return unpacked(self.state.motion, STRIDE, self.p.block_count)

    def put(self, motion: np.ndarray) -> None:
        """Give the blocks this motion."""
        self.state.motion[:] = packed(motion, STRIDE)

    def energy(self, terms: tuple[str, ...], samples: int) -> np.ndarray:
        """Return the first samples of these terms of the ledger [terms, samples], J."""
        return self.samples.energy[[list(TERMS).index(term) for term in terms], :samples]

    def gaps(self) -> np.ndarray:
        """Gap of every contact point of every joint, m [points, N - 1]."""
        (x, z, _), m = self.model.points, self.motion
        g, about_x, about_z = (np.diff(m[k]) for k in (1, 3, 5))
        return g + np.outer(x, about_z) - np.outer(z, about_x)


@pytest.fixture
def row(pillar):
    """Return a function that gives 16 blocks under an oblique eccentric blow, keys changed."""
    return lambda **changes: pillar(**{**deepcopy(SHORT), **changes})


@pytest.fixture
def at_rest():
    """Return a function that gives the `Row` of a scene before its first step."""

    def prepared(scene):
        p, model, time, _ = prepare(scene)
        samples = samples_for(model, time.samples + 1)
        return Row(p, model, state_at_rest(model), samples, time)

    return prepared


@pytest.fixture
def step_matrix():
    """Return a function of (scene, p, dt) that gives the matrix of one linear step dt (s).

    Its rows are the motion of all blocks, rates half a step before and closures of the ends.
    """

    def matrix(scene, p, dt):
        model = build_model(scene, p, Clock(dt, 1, 1))
        model = model._replace(load=model.load._replace(stress=np.zeros(0)))
        row = Row(p, model, state_at_rest(model), samples_for(model, 2), None)
        size = _parts(row)[0].size
        step = np.zeros((size, size))
        for i, unit in enumerate(np.eye(size)):
            _set(row, unit)
            row.take(0, 1)
            step[:, i] = _parts(row)[0]
        return step

    return matrix


def _parts(row):
    """Return what a step needs of the state as one vector, and where its pieces end."""
    n, state = row.p.block_count, row.state
    history = np.zeros((0, n - 1))
    if state.history is not None:
        history = unpacked(state.history, LANES, n - 1)
    pieces = [row.motion.ravel(), history.ravel(), *_closures(state)]
    return np.concatenate(pieces), np.cumsum([x.size for x in pieces])[:-1]


def _set(row, vector):
    n, state = row.p.block_count, row.state
    motion, history, *ends = np.split(vector, _parts(row)[1])
    row.put(motion.reshape(-1, n))
    if state.history is not None:
        state.history[:] = packed(history.reshape(-1, n - 1), LANES)
    for own, closure in zip(_closures(state), ends, strict=True):
        own[:] = closure


def _closures(state):
    return [] if state.ends is None else list(state.ends[:, CLOSURE])
