"""The picture of a pillar's snapshots: where the blocks are, and in which colours."""

import numpy as np
import pytest
from mpl_toolkits.mplot3d import proj3d

from jointwave.compare.figures.export import save
from jointwave.compare.figures.snapshots import HEAD, STRIP, draw_snapshots
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
    """Six faces a block at every instant, compression red and tension blue."""
    figure = draw_snapshots("row", scene, row)
    first, second = (ax.collections[0] for ax in figure.axes[:2])
    assert len(first.get_facecolor()) == len(second.get_facecolor()) == 18
    red_over_blue = second.get_facecolor()[:, 0] - second.get_facecolor()[:, 2]
    assert (red_over_blue > 0.2).sum() == (red_over_blue < -0.2).sum() == 6
    said = [text.get_text() for text in figure.texts]
    assert said[:2] == ["0 ms", "2 ms"] and "displacements × " in said[2]


def test_a_pillar_at_rest_is_drawn_as_it_is(row, scene):
    still = row._replace(displacement=0 * row.displacement, stress=0 * row.stress)
    figure = draw_snapshots("still", scene, still)
    assert "displacements × 1" in figure.texts[-1].get_text()


def test_everything_lies_inside_the_figure_and_its_strip(row, scene):
    figure = draw_snapshots("row", scene, row)
    figure.canvas.draw()
    width, height = figure.bbox.size
    for k, ax in enumerate(figure.axes[:2]):
        places = (row.points + 0.1 * row.displacement[k])[:, [1, 2, 0]]
        x, y, _ = proj3d.proj_transform(*places.T, ax.get_proj())
        across, up = ax.transData.transform(np.stack([x, y], axis=1)).T
        assert across.min() > 0 and across.max() < width
        low = height - figure.dpi * (HEAD + STRIP * (k + 1))
        assert low < up.min() and up.max() < low + figure.dpi * STRIP


def test_the_svg_holds_a_group_for_each_instant(row, scene, tmp_path):
    drawn = save(draw_snapshots("row", scene, row), tmp_path, "row", "A row")
    svg = drawn.file("svg").read_text()
    assert 'id="row-0"' in svg and 'id="row-1"' in svg
    assert "compression positive" in svg
