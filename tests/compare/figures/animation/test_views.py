"""Bodies in a picture: where they are, in the colours of their values, near before far."""

import numpy as np
import pytest
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from jointwave.compare.figures.animation.bodies import FRONT, OBLIQUE, Body, BodyView
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.style import RC

PLATE = np.array([[0.0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 0, 1], [2, 0, 1], [0, 0, 1]])
COLOURS = ScalarMappable(Normalize(-1.0, 1.0), "RdBu_r")


def picture(body, per_away, i):
    """Return the picture of a body at an instant."""
    with blank(2.0, RC | {"figure.figsize": (10.0, 2.0)}) as figure:
        figure.set_layout_engine("none")
        ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        ax.set_axis_off()
        BodyView(ax, body, COLOURS, per_away).show(i)
        figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)


def test_a_body_is_where_it_moves_to_in_the_colours_of_its_faces():
    """A plate in two halves moves by its length: the left one red, the right one blue."""
    motion = np.zeros((2, 6, 3))
    motion[1, :, 0] = 4.0
    faces, values = np.array([[0, 1, 4, 5], [1, 2, 3, 4]]), np.array([[0.0, 0.0], [1.0, -1.0]])
    shown = picture(Body(PLATE, motion, faces, values, np.arange(2)), FRONT, 1)
    height, width = shown.shape[:2]
    empty, _, red, blue = (shown[height // 2, int((k + 0.5) / 4 * width)] for k in range(4))
    assert (empty == 255).all()
    assert red[0] > red[2] + 50 and blue[2] > blue[0] + 50


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
@pytest.mark.parametrize("per_away", [FRONT, OBLIQUE])
def test_what_is_near_hides_what_is_far(per_away, order):
    """Two plates of which the first is nearer to the viewer by 0.1 m, in any order."""
    rest = np.concatenate([PLATE, PLATE + np.array([0.0, 0.1, 0.0])])
    faces = np.array([[0, 2, 3, 5], [6, 8, 9, 11]])[order]
    body = Body(
        rest, np.zeros((1, 12, 3)), faces, np.array([[1.0, -1.0]])[:, order], np.array(order)
    )
    shown = picture(body, per_away, 0)
    middle = shown[shown.shape[0] // 2, shown.shape[1] // 2]
    assert middle[0] > middle[2] + 50
