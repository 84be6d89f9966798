"""Shared by the tests of animations: blocks of any cells, and snapshots of a short pillar."""

from functools import cache

import numpy as np
import pytest

from jointwave.compare.figures.animation.snapshots import take
from jointwave.results.snapshots import snapshots
from jointwave.results.subcells import CORNERS

SHORT = {
    "pillar.length": 10.0,
    "ends.end": "matched",
    "time.duration": 0.02,
    "record": {"stress": [5.0]},
}


@pytest.fixture(scope="session")
def row():
    """Return a function that gives blocks of unit size, or of one cell of another kind in a block,
    along y; at two instants, the second with the given displacement of each node."""

    def made(count=3, kind="hexahedron", displacement=None, stress=None):
        cell = {"line": "interval", "quad": "quadrilateral"}.get(kind, kind)
        corners = np.array(CORNERS[cell], dtype=float)
        if corners.shape[1] == 1:
            corners = corners @ [[0.0, 1.0, 0.0]]
        elif corners.shape[1] == 2:
            corners = np.pad(corners - [0.5, 0.0], ((0, 0), (0, 1)))
        else:
            corners = corners - [0.5, 0.0, 0.5]
        points = np.concatenate([np.add(corners, [0.0, i, 0.0]) for i in range(count)])
        moved = np.zeros((2, *points.shape))
        if displacement is not None:
            moved[1] = displacement(points)
        found = np.zeros((2, count)) if stress is None else np.array(stress, dtype=float)
        cells = np.arange(len(points)).reshape(count, -1)
        times = np.array([0.0, 1e-3])
        return snapshots(times, points, kind, cells, np.arange(count), moved, 1e3 * moved, found)

    return made


@pytest.fixture(scope="session")
def simulated(pillar):
    """Return a function that gives a number of snapshots of a short pillar by both engines."""
    return cache(lambda count=41: take(pillar(**SHORT), 0.02 / (count - 1)))
