"""The picture and the view of a rock mass: blocks where they are, coloured by their motion."""

import sys

import numpy as np
import pytest

from cases import SceneError
from cases.read import load_tables
from compare.figures.animation import offscreen
from compare.figures.animation.frame import PlaneFrame, cells_at, speeds
from compare.figures.animation.snapshots import SceneSnapshots, at_instants, until
from compare.figures.animation.view_settings import DISPLACEMENT, scale_of, settings_for
from results.snapshots import snapshots

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


def test_cells_are_displaced_and_have_the_speed_of_their_corners(simulated):
    found = simulated.found["dem"]
    np.testing.assert_allclose(speeds(found), [[0, 0], [0, 2.0]])
    at = cells_at(found, 1, 1000.0)
    np.testing.assert_allclose(at[0], SQUARE)
    np.testing.assert_allclose(at[1], SQUARE + np.array([1.06, 0.08]))


def test_displacements_are_drawn_as_they_can_be_seen(simulated):
    """4 % of 2 m over 1e-4 m is 800; of 1, 2, 5 times a power of ten at most that is 500."""
    assert scale_of(simulated.found) == 500


def test_the_picture_shows_the_block_that_moves_where_it_is(simulated):
    settings = settings_for(simulated.scene, simulated.found, 1000.0)
    frame = PlaneFrame(simulated, settings, dots=50)
    start, end = frame.image(0).astype(int), frame.image(1).astype(int)
    assert start.shape == (360, 640, 4)
    (ax,) = (ax for ax in frame.figure.axes if ax.get_title() or ax.get_xlabel() == "x (m)")
    height = start.shape[0]

    def colour(image, x, y):
        across, up = ax.transData.transform((x, y))
        return image[height - 1 - int(up), int(across), :3]

    assert (colour(start, 1.5, 0.5) == colour(start, 0.5, 0.5)).all()
    assert (colour(end, 0.5, 0.5) == colour(start, 0.5, 0.5)).all()
    assert (colour(end, 1.5, 0.5) != colour(start, 1.5, 0.5)).any()
    assert (colour(end, 2.04, 0.5) == colour(end, 1.5, 0.5)).all()  # beyond where it was
    assert (colour(start, 2.04, 0.5) == 255).all()
    assert "t = 10.000 ms" in frame.clock.get_text()


def test_instants_are_asked_of_a_rock_mass_as_of_a_pillar():
    asked = at_instants(load_tables(TABLES), 5)
    assert asked.record.fields == 0.0025 and asked.interval <= 0.0025


def test_a_rock_mass_is_cut_short_as_a_pillar_is():
    assert until(load_tables(TABLES), 0.004).time.duration == 0.004
    sparse = load_tables(TABLES | {"record": {"points": [[0.5, 0.5]], "interval": 0.005}})
    with pytest.raises(SceneError, match=r"record\.interval = 0\.005: must not exceed"):
        until(sparse, 0.004)


@pytest.fixture
def view(simulated, monkeypatch):
    """The two squares by two engines in a view, off screen, displacements 1000 times as large."""
    pytest.importorskip("pyvista")
    if sys.platform.startswith("linux"):
        try:
            monkeypatch.setenv(offscreen.CHOICE, offscreen._window())
        except SceneError:
            pytest.skip("VTK cannot render here")
    from compare.figures.animation.view3d import View3D

    found = {"dem": simulated.found["dem"], "continuum-jointed": simulated.found["dem"]}
    both = simulated._replace(found=found, reasons={})
    made = View3D(both, settings_for(both.scene, found, 1000.0))
    yield made
    made.plotter.close()


def test_the_view_has_blocks_where_they_are_with_the_size_of_their_displacement(view):
    view.show(1)
    moved = np.concatenate([SQUARE, SQUARE + np.array([1.06, 0.08])])
    for grid, edges in zip(view.grids.values(), view.edges.values(), strict=True):
        np.testing.assert_allclose(grid.points[:, :2], moved)
        np.testing.assert_array_equal(edges.points, grid.points)
        np.testing.assert_allclose(grid.point_data[DISPLACEMENT.name], 4 * [0.0] + 4 * [1e-4])
        assert grid.area == pytest.approx(2.0) and edges.n_lines == 8
    assert view.settings.quantity.label == "displacement magnitude (mm)"


def test_the_view_looks_along_z_at_both_engines_side_by_side(view):
    """The picture has all blocks, 2.2 m from one engine's to the other's, at one scale."""
    view.show(1)
    camera = view.plotter.camera
    assert camera.direction == pytest.approx((0.0, 0.0, -1.0)) and camera.up == (0.0, 1.0, 0.0)
    pixels = np.asarray(view.plotter.screenshot(return_img=True)).astype(int)
    metre = pixels.shape[0] / (2 * camera.parallel_scale)

    def colour(x, y):
        off = metre * (np.array([x, y]) - camera.focal_point[:2])
        return pixels[round(pixels.shape[0] / 2 - off[1]), round(pixels.shape[1] / 2 + off[0])]

    for left in (0.0, 2.2):
        still, moved = colour(left + 0.5, 0.5), colour(left + 1.56, 0.58)
        assert moved[0] > 90 and moved[2] < 90 and still.min() > 150  # dark red, pale yellow
        assert (colour(left + 1.03, 0.5) == 255).all()  # the gap that has opened
