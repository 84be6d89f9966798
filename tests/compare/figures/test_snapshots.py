"""The picture of a pillar shows the sides that a viewer would see, where the blocks are."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

from compare.figures.export import save
from compare.figures.snapshots import draw_snapshots, exaggeration, visible_faces
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


def test_a_block_shows_the_side_towards_the_viewer(row):
    """From +z at rest the side z = 1 and no other."""
    faces, cells = visible_faces(row, row.points)
    assert cells.tolist() == [0, 1, 2]
    assert (faces[..., 2] == 1).all()
    assert faces[1, :, 1].min() == 1 and faces[1, :, 1].max() == 2


def test_a_turned_block_shows_a_second_side_behind_the_first(row):
    """Turned about x, whose far end then leans back, it shows the side at its end too."""
    faces, cells = visible_faces(row, row.points + row.displacement[1])
    assert sorted(cells.tolist()) == [0, 1, 2, 2]
    depths = faces[..., 2].mean(axis=1)
    assert (np.diff(depths) >= 0).all()
    end = faces[cells == 2][0]
    assert np.ptp(end[:, 2]) == pytest.approx(1) and np.ptp(end[:, 1]) == pytest.approx(TURN)


@pytest.mark.parametrize(
    ("kind", "corners"),
    [
        ("line", [0, 1]),
        ("triangle", [0, 1, 3]),
        ("quad", [0, 1, 2, 3]),
        ("tetra", [0, 1, 3, 4]),
        ("hexahedron", range(8)),
    ],
)
def test_every_kind_of_cell_shows_one_side(kind, corners):
    """Of the tetrahedron it is the slope: the side in z = 0 looks away, the others are edge-on."""
    points = np.array(CORNERS["hexahedron"], dtype=float)[list(corners)]
    one = snapshots(
        np.zeros(1), points, kind, [range(len(points))], [0], points[None], points[None]
    )
    faces, cells = visible_faces(one, points)
    assert len(faces) == 1 and cells.tolist() == [0]
    if kind == "tetra":
        assert (faces.sum(axis=2) == 1).all()


@pytest.mark.parametrize(("largest", "factor"), [(0.01, 50), (0.1, 5), (3e-4, 2000), (0.9, 0.5)])
def test_exaggeration_is_a_round_number_that_keeps_to_its_room(row, largest, factor):
    """At most 0.8 of the thickness, which is 1 m."""
    scaled = row._replace(displacement=row.displacement / np.abs(row.displacement).max() * largest)
    assert exaggeration({"dem": scaled}) == pytest.approx(factor)


def test_a_pillar_at_rest_is_drawn_as_it_is(row):
    still = row._replace(displacement=0 * row.displacement, stress=0 * row.stress)
    assert exaggeration({"dem": still}) == 1
    assert len(draw_snapshots("still", {"dem": still}).axes) == 3


def test_blocks_are_drawn_where_they_are_in_the_colour_of_their_stress(row):
    figure = draw_snapshots("row", {"dem": row})
    strips = [ax.collections[0] for ax in figure.axes[:2]]
    assert all(isinstance(strip, PolyCollection) for strip in strips)
    assert [strip.get_gid() for strip in strips] == ["row-0-dem", "row-1-dem"]
    factor = exaggeration({"dem": row})
    _, cells = visible_faces(row, row.points + factor * row.displacement[1])
    first, second = (int(np.flatnonzero(cells == i)[0]) for i in (0, 1))
    drawn = strips[1].get_paths()[second].vertices
    assert drawn[:, 0].min() == pytest.approx(1 + 0.01 * factor)
    compressed, stretched = strips[1].get_facecolors()[[first, second]]
    assert compressed[0] > compressed[2] + 0.2 and stretched[2] > stretched[0] + 0.2
    assert [ax.get_ylabel() for ax in figure.axes[:2]] == ["0 ms", "2 ms"]
    assert f"× {factor:g}" in " ".join(text.get_text() for text in figure.texts)


def test_everything_lies_inside_its_strip(row):
    figure = draw_snapshots("row", {"dem": row, "continuum-jointed": row})
    assert len(figure.axes) == 2 * 2 + 1
    assert [ax.get_ylabel() for ax in figure.axes[2:4]] == ["2 ms\ndem", "2 ms\ncontinuum-jointed"]
    for ax in figure.axes[:-1]:
        drawn = np.concatenate([path.vertices for path in ax.collections[0].get_paths()])
        (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
        assert left < drawn[:, 0].min() and drawn[:, 0].max() < right
        assert low < drawn[:, 1].min() and drawn[:, 1].max() < high
        width, height = ax.get_window_extent().size
        assert (right - left) / (high - low) == pytest.approx(width / height)


def test_the_svg_holds_a_group_for_each_instant(row, tmp_path):
    svg = save(draw_snapshots("row", {"dem": row}), tmp_path, "row", "A row").svg
    assert 'id="row-0-dem"' in svg and 'id="row-1-dem"' in svg
    assert "compression positive" in svg
    assert "<image" not in svg
