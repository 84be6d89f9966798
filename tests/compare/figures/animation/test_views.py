"""Bodies in space by both libraries: where they are, in the colours of their values."""

import numpy as np
import pytest
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from jointwave.compare.figures.animation.bodies import SpaceView
from jointwave.compare.figures.animation.polygons import Polygons
from jointwave.compare.figures.animation.rendered import RenderedView, Stage, can_render
from jointwave.compare.figures.export import blank

#: A plate that faces the viewer, 4 m x 1 m, in two halves; at the second instant it is elsewhere.
POINTS = np.array([[0.0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 0, 1], [2, 0, 1], [0, 0, 1]])
FRONT = 0.0, -1.0, 0.0


@pytest.fixture
def plate():
    motion = np.zeros((2, 6, 3))
    motion[1, :, 0] = 4.0
    faces, values = np.array([[0, 1, 4, 5], [1, 2, 3, 4]]), np.array([[0.0, 0.0], [1.0, -1.0]])
    return Polygons(POINTS, motion, faces, values)


@pytest.fixture
def colours():
    return ScalarMappable(Normalize(-1.0, 1.0), "RdBu_r")


def halves(picture):
    """Return the colours in the middle of each quarter of a picture's width."""
    height, width = picture.shape[:2]
    return [picture[height // 2, int((k + 0.5) / 4 * width), :3].astype(int) for k in range(4)]


def is_drawn(picture):
    """Hold the plate to the right half of the picture, the left one red, the right one blue."""
    empty, _, red, blue = halves(picture)
    assert (empty == 255).all()
    assert red[0] > red[2] + 50 and blue[2] > blue[0] + 50


def test_matplotlib_draws_polygons_where_they_are(plate, colours):
    with blank(2.0, 10.0, True) as figure:
        view = SpaceView(figure, (0.0, 0.0, 1.0, 1.0), plate, colours, FRONT)
        view.show(1)
        figure.canvas.draw()
    is_drawn(np.asarray(figure.canvas.buffer_rgba()))


def test_pyvista_draws_the_same(plate, colours):
    if not can_render():
        pytest.skip("PyVista cannot render here")
    is_drawn(Stage([plate], colours, (1000, 200), FRONT).image(1))


def test_a_rendered_body_is_a_part_of_a_figure(plate, colours):
    if not can_render():
        pytest.skip("PyVista cannot render here")
    with blank(2.0, 10.0, True) as figure:
        view = RenderedView(figure.add_axes((0.0, 0.0, 1.0, 1.0)), plate, colours)
        before = view.picture.get_array()
        view.show(1)
    assert (view.picture.get_array() != before).any()
