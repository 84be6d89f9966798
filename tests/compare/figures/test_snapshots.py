"""The picture of a pillar's snapshots: where the blocks are, and in which colours."""

import numpy as np
import pytest

from compare.figures.export import save
from compare.figures.snapshots import draw_snapshots, exaggeration
from results.snapshots import snapshots
from results.subcells import CORNERS

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


@pytest.mark.parametrize(("largest", "factor"), [(0.01, 50), (0.1, 5), (3e-4, 2000), (0.9, 0.5)])
def test_exaggeration_is_a_round_number_that_keeps_to_its_room(row, largest, factor):
    """At most 0.8 of the thickness, which is 1 m."""
    scaled = row._replace(displacement=row.displacement / np.abs(row.displacement).max() * largest)
    assert exaggeration(scaled) == pytest.approx(factor)


def test_a_pillar_at_rest_is_drawn_as_it_is(row):
    still = row._replace(displacement=0 * row.displacement, stress=0 * row.stress)
    assert exaggeration(still) == 1
    figure = draw_snapshots("still", still)
    assert [len(ax.collections[0].get_paths()) for ax in figure.axes[:2]] == [3, 3]


def test_blocks_are_drawn_where_they_are_in_the_colour_of_their_stress(row):
    """Of the turned block its end too, behind its side."""
    figure, factor = draw_snapshots("row", row), exaggeration(row)
    drawn = figure.axes[1].collections[0]
    corners = [path.vertices[:4, 0] for path in drawn.get_paths()]
    assert len(corners) == 4
    starts = [x.min() for x in corners]
    second = starts.index(pytest.approx(1 + 0.01 * factor))
    compressed, stretched = drawn.get_facecolors()[[np.argmin(starts), second]]
    assert compressed[0] > compressed[2] + 0.2 and stretched[2] > stretched[0] + 0.2
    assert [ax.get_ylabel() for ax in figure.axes[:2]] == ["0 ms", "2 ms"]
    assert f"× {factor:g}" in " ".join(text.get_text() for text in figure.texts)


def test_everything_lies_inside_its_strip(row):
    figure = draw_snapshots("row", row)
    assert len(figure.axes) == 2 + 1
    for ax in figure.axes[:-1]:
        drawn = np.concatenate([path.vertices for path in ax.collections[0].get_paths()])
        (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
        assert left < drawn[:, 0].min() and drawn[:, 0].max() < right
        assert low < drawn[:, 1].min() and drawn[:, 1].max() < high
        width, height = ax.get_window_extent().size
        assert (right - left) / (high - low) == pytest.approx(width / height)


def test_the_svg_holds_a_group_for_each_instant(row, tmp_path):
    drawn = save(draw_snapshots("row", row), tmp_path, "row", "A row")
    svg = drawn.file("svg").read_text(encoding="utf-8")
    assert 'id="row-0"' in svg and 'id="row-1"' in svg
    assert "compression positive" in svg
    assert "<image" not in svg
