"""The picture of a pillar's snapshots: where the blocks are, and in which colours."""

import numpy as np
import pytest

from jointwave.compare.figures.animation.frame import draw_snapshots
from jointwave.compare.figures.export import save
from jointwave.results.snapshots import snapshots
from jointwave.results.subcells import CORNERS

TURN = 0.1  # rad


@pytest.fixture
def row():
    """Three unit blocks along y at two instants: at rest; then the second a little to the right,
    the third turned about x."""
    block = np.array(CORNERS["hexahedron"], dtype=float)
    points = np.concatenate([block + np.array([0, i, 0]) for i in range(3)])
    moved = np.zeros((2, 24, 3))
    moved[1, 8:16, 1] = 0.01
    moved[1, 16:, 2] = -TURN * (points[16:, 1] - 2.5)
    moved[1, 16:, 1] = TURN * (points[16:, 2] - 0.5)
    return snapshots(
        np.array([0.0, 2e-3]),
        points,
        "hexahedron",
        np.arange(24).reshape(3, 8),
        np.arange(3),
        moved,
        np.zeros_like(moved),
        np.array([[0.0, 0.0, 0.0], [2e6, -1e6, 0.0]]),
    )


@pytest.fixture
def scene(pillar):
    return pillar(pillar={"length": 3.0, "side": 1.0, "block": 1.0}, record={"stress": [1.0]})


def test_blocks_are_drawn_in_the_colour_of_their_stress(row, scene):
    """The three faces of each block that face the viewer, compression red and tension blue."""
    figure = draw_snapshots("row", scene, row)
    figure.canvas.draw()
    first, second = (ax.collections[0].get_facecolor() for ax in figure.axes[:2])
    assert len(first) == len(second) == 9
    red_over_blue = second[:, 0] - second[:, 2]
    assert (red_over_blue > 0.2).sum() == (red_over_blue < -0.2).sum() == 3
    assert [ax.get_ylabel() for ax in figure.axes[:2]] == ["0 ms", "2 ms"]
    assert "displacements × " in figure.axes[1].get_xlabel()


def test_a_pillar_at_rest_is_drawn_as_it_is(row, scene):
    still = row._replace(displacement=0 * row.displacement, stress=0 * row.stress)
    figure = draw_snapshots("still", scene, still)
    assert "displacements × 1" in figure.axes[1].get_xlabel()


def test_everything_lies_inside_the_figure(row, scene, collisions):
    figure = draw_snapshots("row", scene, row)
    assert collisions(figure) == []


def test_the_svg_holds_a_group_for_each_instant(row, scene, tmp_path):
    drawn = save(draw_snapshots("row", scene, row), tmp_path, "row", "A row")
    svg = drawn.file("svg").read_text()
    assert 'id="row-0"' in svg and 'id="row-1"' in svg
    assert "compression positive" in svg
