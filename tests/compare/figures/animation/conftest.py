"""What the tests of moving pictures share: blocks of any cells, and a short pillar's simulated."""

import numpy as np
import pytest

from compare.figures.animation.snapshots import take
from results.snapshots import snapshots
from results.subcells import CORNERS

SHORT = {
    "pillar__length": 10.0,
    "ends__end": "matched",
    "time__duration": 0.02,
    "record": {"stress": [5.0]},
}


@pytest.fixture
def row():
    """Return a function that gives blocks of unit size, or of one cell of another kind in a block,
    along y; at two instants, the second with the given displacement of each node."""

    def made(count=3, kind="hexahedron", displacement=None, stress=None):
        cell = {"line": "interval", "quad": "quadrilateral"}.get(kind, kind)
        corners = np.array(CORNERS[cell], dtype=float)
        if corners.shape[1] == 1:
            corners = np.array([[0.0, y[0], 0.0] for y in corners])
        elif corners.shape[1] == 2:
            corners = np.pad(corners - [0.5, 0.0], ((0, 0), (0, 1)))
        else:
            corners = corners - [0.5, 0.0, 0.5]
        points = np.concatenate([corners + np.array([0.0, i, 0.0]) for i in range(count)])
        moved = np.zeros((2, *points.shape))
        if displacement is not None:
            moved[1] = displacement(points)
        return snapshots(
            np.array([0.0, 1e-3]),
            points,
            kind,
            np.arange(len(points)).reshape(count, -1),
            np.arange(count),
            moved,
            1e3 * moved,
            np.zeros((2, count)) if stress is None else np.array(stress, dtype=float),
        )

    return made


@pytest.fixture(scope="session")
def _kept():
    return {}


@pytest.fixture
def simulated(pillar, _kept):
    """Return a function that gives both engines' simulated of a short pillar with keys changed."""

    def taken(count=41, **changes):
        key = repr((count, changes))
        if key not in _kept:
            _kept[key] = take(pillar(**(SHORT | changes)), count)
        return _kept[key]

    return taken
