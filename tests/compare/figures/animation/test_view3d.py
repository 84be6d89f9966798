"""The pillars in three dimensions: points and colours are the results', and they are seen."""

import sys
from itertools import combinations

import numpy as np
import pytest
from PIL import Image

from cases import SceneError
from compare.figures.animation import offscreen
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.surface import solid
from compare.figures.animation.view_settings import STRESS, settings_for

pytest.importorskip("pyvista")


@pytest.fixture
def stage(simulated, monkeypatch):
    """The stage of a short pillar's simulated, off screen, and its simulated."""
    if sys.platform.startswith("linux"):
        try:
            monkeypatch.setenv(offscreen.CHOICE, offscreen._window())
        except SceneError:
            pytest.skip("VTK cannot render here")
    from compare.figures.animation.view3d import View3D

    taken = simulated()
    made = View3D(taken, settings_for(taken.scene, taken.found))
    yield made
    made.plotter.close()


def test_points_and_scalars_are_the_results(stage, simulated):
    """Bit by bit, at every instant, and the grid's cells are the engine's."""
    for i in (0, 20, 40):
        stage.show(i)
        for name, s in simulated().found.items():
            box, grid = solid(s, 0.5), stage.grids[name]
            expected = box.points + stage.settings.scale * box.displacement[i]
            np.testing.assert_array_equal(grid.points, expected)
            np.testing.assert_array_equal(grid.point_data["displacement"], box.displacement[i])
            np.testing.assert_array_equal(grid.cell_data[STRESS.name], s.stress[i])
            np.testing.assert_array_equal(grid.cell_data["block"], s.block)
            np.testing.assert_array_equal(grid.cells.reshape(-1, 9)[:, 1:], box.cells)
            np.testing.assert_array_equal(stage.edges[name].points, expected)


def test_volumes_are_those_of_the_pillar(stage):
    """VTK's own measure of the cells: none is inside out, none is missing."""
    for grid in stage.grids.values():
        assert grid.volume == pytest.approx(10.0 * 0.5**2)


def test_the_slider_moves_everything_to_its_time(stage, simulated):
    stage.add_slider(10)
    widgets = getattr(stage.plotter, "widgets", stage.plotter)  # of newer PyVista
    (slider,) = widgets.slider_widgets
    assert slider.GetRepresentation().GetValue() == pytest.approx(5.0)  # ms
    slider.GetRepresentation().SetValue(1e3 * stage.time[20] + 0.1)
    slider.InvokeEvent("EndInteractionEvent")
    np.testing.assert_array_equal(
        stage.grids["dem"][STRESS.name], simulated().found["dem"].stress[20]
    )


def test_numbers_and_title_of_the_colours_lie_beside_them(stage):
    """VTK's own title overlaps its numbers, which are in Pa with powers of ten."""
    from compare.figures.animation.view3d import BAR, SIZE

    stage.plotter.render()
    left, low, width, height = (part * SIZE[i % 2] for i, part in enumerate(BAR))
    boxes = {"bar": (left, left + width, low, low + height)}
    for text in stage.plotter.renderer.actors.values():
        if hasattr(text, "GetBoundingBox") and text.GetInput().strip():
            box = [0.0] * 4
            text.GetBoundingBox(stage.plotter.renderer, box)
            place = text.GetActualPositionCoordinate()
            x, y = place.GetComputedDisplayValue(stage.plotter.renderer)
            boxes[text.GetInput()] = (x + box[0], x + box[1], y + box[2], y + box[3])
    assert {"axial stress (MPa), compression positive", "0"} < set(boxes) and len(boxes) >= 5
    for x0, x1, y0, y1 in boxes.values():
        assert x0 >= 0 and x1 <= SIZE[0] and y0 >= 0 and y1 <= SIZE[1]
    for (one, a), (other, b) in combinations(boxes.items(), 2):
        apart = a[1] <= b[0] or b[1] <= a[0] or a[3] <= b[2] or b[3] <= a[2]
        assert apart, (one, other)


def colours_of(path):
    """How many pixels are red, how many blue, of a picture of this size."""
    with Image.open(path) as file:
        assert file.size == (1280, 720)
        seen = np.asarray(file.convert("RGB")).astype(int)[:600]  # above the bar of colours
    red_over_blue = seen[..., 0] - seen[..., 2]
    return (red_over_blue > 60).sum(), (red_over_blue < -60).sum()


@pytest.mark.parametrize("engines", [("dem", "continuum-jointed"), ("dem",)])
def test_a_picture_without_a_display_shows_the_wave(simulated, engines, tmp_path):
    """Compression red and tension blue, by a process of its own."""
    taken = simulated()
    reasons = {"continuum-jointed": "a reason"} if len(engines) == 1 else {}
    some = SceneSnapshots(taken.scene, {n: taken.found[n] for n in engines}, reasons, taken.results)
    settings = settings_for(taken.scene, taken.found)
    try:
        offscreen.draw(tmp_path / "wave.png", some, settings, 18)
    except SceneError as error:
        assert offscreen.NEEDED in str(error)
        pytest.skip("VTK cannot render here")
    red, blue = colours_of(tmp_path / "wave.png")
    assert red > 1000 * len(engines) and blue > 1000 * len(engines)


def test_where_vtk_cannot_draw_a_line_says_what_it_needs(monkeypatch):
    monkeypatch.setattr(offscreen, "WINDOWS", {"vtkEGLRenderWindow": ("libNoSuchThing.so.1",)})
    with pytest.raises(SceneError, match="needs EGL or OSMesa"):
        offscreen._window()


def test_a_renderer_that_ends_its_process_is_reported(simulated, monkeypatch, tmp_path):
    """As VTK does where a library is there but no driver."""
    monkeypatch.setattr(offscreen, "_draw", _end)
    taken = simulated()
    with pytest.raises(SceneError, match="needs EGL or OSMesa"):
        offscreen.draw(tmp_path / "wave.png", taken, settings_for(taken.scene, taken.found), 1)


def _end(*arguments):
    import os

    os.abort()


def test_a_display_is_what_the_environment_names(monkeypatch):
    if not sys.platform.startswith("linux"):
        pytest.skip("others always have one")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert not offscreen.has_display()
    monkeypatch.setenv("DISPLAY", ":0")
    assert offscreen.has_display()
