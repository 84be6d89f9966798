"""In whatever order tiles are stepped, every bit is the same."""

import os

import numpy as np
import pytest

from jointwave.dem.spatial.build import buffers_for, samples_for, state_at_rest
from jointwave.dem.spatial.layout import LANES
from jointwave.dem.spatial.march import make_stepper
from jointwave.dem.spatial.simulate import prepare
from jointwave.dem.time_loop import ENOUGH_BLOCKS, thread_count

BLOCKS = 80 * LANES  # five runs of tiles for threads that follow one another
STEPS = 203  # no multiple of any depth


@pytest.fixture
def prepared(pillar):
    """A row with what a step keeps: slides, rates, ends, ledger, samples."""
    length = 0.5 * BLOCKS
    scene = pillar(
        pillar__length=length,
        load={
            "shape": "sine",
            "amplitude": 1e6,
            "period": 1e-3,
            "direction": [0.48, 0.6, -0.64],
            "at": [0.1, -0.05],
        },
        joints={"friction_angle": 20.0, "cohesion": 1e4, "damping_ratio": 0.05},
        ends={"start": "quiet", "end": "matched"},
        gravity={"direction": [0.6, 0.8, 0.0], "static": False},
        record={
            "stress": [2.0, 32.0, 33.0, length - 1],
            "velocity": [0.25, 31.9],
            "interval": 1e-4,
        },
        numerics__dem__step_fraction=0.3,
        time__duration=0.05,
    )
    return prepare(scene)


def outcome(prepared, threads, depth):
    """Return every array that so many steps leave."""
    model = prepared.model
    state = state_at_rest(model)
    samples = samples_for(model, STEPS // prepared.time.stride + 1)
    velocities = state.motion[:, state.motion.shape[1] // 2 :]
    velocities[:] = np.random.default_rng(1).uniform(-1e-3, 1e-3, velocities.shape)
    buffers = buffers_for(model, threads)._replace(depth=depth)
    make_stepper(model, state, buffers, samples)(0, STEPS)
    return [*samples, *state.ends, state.motion, state.history, state.sums]


@pytest.mark.parametrize("threads, depth", [(1, 2), (1, 3), (1, 8), (2, 1), (2, 3), (2, 8), (3, 8)])
def test_threads_and_depth_change_no_bit(prepared, threads, depth):
    """Tiles may take their steps one by one or many while they are in the cache, in turn or not."""
    found, expected = outcome(prepared, threads, depth), outcome(prepared, 1, 1)
    assert all(part.any() for part in expected[:4])
    assert all((a == b).all() for a, b in zip(found, expected, strict=True))


def test_a_long_row_takes_the_processors_that_it_may_use(monkeypatch):
    """Those of this process, by default; a short row takes one."""
    monkeypatch.setattr(os, "sched_getaffinity", {0: {2, 3, 5}}.__getitem__, raising=False)
    assert thread_count(None, ENOUGH_BLOCKS) == 3
    assert thread_count(None, ENOUGH_BLOCKS - 1) == 1
    assert thread_count(4, 1) == 4
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert thread_count(None, ENOUGH_BLOCKS) == 1
