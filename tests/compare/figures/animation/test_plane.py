"""The picture of a rock mass: blocks where they are, coloured by their motion."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.compare.figures.animation.bodies import body_of
from jointwave.compare.figures.animation.frame import Frame
from jointwave.compare.figures.animation.settings import settings_for
from jointwave.compare.figures.animation.snapshots import SceneSnapshots
from jointwave.results.snapshots import snapshots

TABLES = {
    "title": "two blocks",
    "domain": {"size": [2.0, 1.0]},
    "rock": {"density": 2600.0, "intact_modulus": 5e10},
    "time": {"duration": 0.01},
    "record": {"points": [[0.5, 0.5]]},
}
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.fixture
def simulated():
    """Two squares of 1 m, of which the right one moves by 1e-4 m along (0.6, 0.8) at 2 m/s."""
    points = np.concatenate([SQUARE, SQUARE + np.array([1.0, 0.0])])
    moved = np.zeros((2, 8, 2))
    moved[1, 4:] = 1e-4 * np.array([0.6, 0.8])
    moving = np.zeros((2, 8, 2))
    moving[1, 4:] = 2.0 * np.array([0.6, 0.8])
    cells = np.arange(8).reshape(2, 4)
    taken = snapshots(np.array([0.0, 0.01]), points, "quad", cells, [0, 1], moved, moving)
    reasons = {"continuum-jointed": "it has not been asked"}
    return SceneSnapshots(load_tables(TABLES), {"dem": taken}, reasons, {})


def test_cells_are_displaced_and_coloured_by_their_speed(simulated):
    """2 m/s."""
    settings = settings_for(simulated.scene, simulated.found, 1000.0)
    body = body_of(simulated.found["dem"], settings)
    np.testing.assert_allclose(body.values, [[0, 0], [0, 2.0]])
    corners = (body.rest + body.motion[1])[body.faces][..., [0, 2]]
    np.testing.assert_allclose(corners[0], SQUARE)
    np.testing.assert_allclose(corners[1], SQUARE + np.array([1.06, 0.08]))


def test_displacements_are_drawn_as_they_can_be_seen(simulated):
    """4 % of 2 m over 1e-4 m is 800; of 1, 2, 5 times a power of ten at most that is 500."""
    assert settings_for(simulated.scene, simulated.found).scale == 500


def test_the_picture_shows_the_block_that_moves_where_it_is(simulated):
    settings = settings_for(simulated.scene, simulated.found, 1000.0)
    frame = Frame(simulated, settings)
    start, end = frame.image(0).astype(int), frame.image(1).astype(int)
    assert start.shape == (720, 1280, 4)
    (ax,) = (ax for ax in frame.figure.axes if ax.get_xlabel() == "x (m)")
    height = start.shape[0]

    def colour(image, x, y):
        across, up = ax.transData.transform((x, y))
        return image[height - 1 - int(up), int(across), :3]

    assert (colour(start, 1.5, 0.5) == colour(start, 0.5, 0.5)).all()
    assert (colour(end, 0.5, 0.5) == colour(start, 0.5, 0.5)).all()
    assert (colour(end, 1.5, 0.5) != colour(start, 1.5, 0.5)).any()
    assert (colour(end, 2.04, 0.5) == colour(end, 1.5, 0.5)).all()  # beyond where it was
    assert (colour(start, 2.04, 0.5) == 255).all()
    assert "t = 10 ms" in frame.clock.get_text()
