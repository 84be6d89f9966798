"""The picture of a pillar's snapshots: where the blocks are, and in which colours."""

import numpy as np
import pytest

from jointwave.compare.figures.animation.frame import draw_snapshots
from jointwave.compare.figures.export import save

TURN = 0.1  # rad


@pytest.fixture
def blocks(row):
    """Three unit blocks at two instants: at rest; then the second a little to the right, the third
    turned about x."""

    def moved(points):
        at = np.repeat([0, 1, 2], 8)
        turned = np.where(at == 2, TURN, 0.0)
        along = 0.01 * (at == 1) + turned * points[:, 2]
        return np.stack([0 * along, along, -turned * (points[:, 1] - 2.5)], axis=1)

    return row(displacement=moved, stress=[[0.0, 0.0, 0.0], [2e6, -1e6, 0.0]])


@pytest.fixture
def scene(pillar):
    return pillar(pillar={"length": 3.0, "side": 1.0, "block": 1.0}, record={"stress": [1.0]})


def test_blocks_are_drawn_in_the_colour_of_their_stress(blocks, scene):
    """The three faces of each block that face the viewer, compression red and tension blue."""
    figure = draw_snapshots("row", scene, blocks)
    figure.canvas.draw()
    first, second = (ax.collections[0].get_facecolor() for ax in figure.axes[:2])
    assert len(first) == len(second) == 9
    red_over_blue = second[:, 0] - second[:, 2]
    assert (red_over_blue > 0.2).sum() == (red_over_blue < -0.2).sum() == 3
    assert [ax.get_ylabel() for ax in figure.axes[:2]] == ["0 ms", "1 ms"]
    assert "displacements × " in figure.axes[1].get_xlabel()


def test_a_pillar_at_rest_is_drawn_as_it_is(blocks, scene):
    still = blocks._replace(displacement=0 * blocks.displacement, stress=0 * blocks.stress)
    figure = draw_snapshots("still", scene, still)
    assert "displacements × 1" in figure.axes[1].get_xlabel()


def test_everything_lies_inside_the_figure(blocks, scene, collisions):
    figure = draw_snapshots("row", scene, blocks)
    assert collisions(figure) == []


def test_the_svg_holds_a_group_for_each_instant(blocks, scene, tmp_path):
    drawn = save(draw_snapshots("row", scene, blocks), tmp_path, "row", "A row")
    svg = drawn.file("svg").read_text()
    assert 'id="row-0"' in svg and 'id="row-1"' in svg
    assert "compression positive" in svg
