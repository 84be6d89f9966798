"""A scene by both engines in three dimensions, by PyVista."""

from typing import NamedTuple

import numpy as np
import pyvista
from matplotlib.ticker import MaxNLocator

from cases.schema.scene import Scene
from compare.figures import fonts
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.surface import Y, solid, surface_of
from compare.figures.animation.view_settings import DISPLACEMENT, STRESS, ViewSettings, caption
from compare.figures.print.layout import wrapped
from compare.figures.style import FIELD, UNSIGNED, style
from results.snapshots import Snapshots

SIZE = 1280, 720  # pixels
BAR = 0.5, 0.06, 0.45, 0.06  # left, bottom, width and height of the colours, of the picture
LONGEST, WIDE = 110, 0x2E7F  # letters per line; last character not wider than Latin ones
SHOWN = 1.1  # size of the picture relative to the visible bodies
CELLS = {
    "triangle": pyvista.CellType.TRIANGLE,
    "quad": pyvista.CellType.QUAD,
    "tetra": pyvista.CellType.TETRA,
    "hexahedron": pyvista.CellType.HEXAHEDRON,
}

APART = 3.0  # least distance of two pillars' axes, in thicknesses as drawn
BESIDE = 1.1  # distance of two rock masses, in widths as drawn
TILT = 0.35, 0.3  # offset of the viewer of pillars to the right and up, of the distance
ABOVE = 0.04  # height of the name above a rock mass, relative to its size
TALL = 1.5  # picture's height over that of a rock mass: text above, colours below


class View3D:
    """The pillars, one above the other, or the rock masses, side by side, at any instant.

    grids : by engine, with the points at the drawn nodes (m), `displacement` (m) of points, and the
    quantity shown by the colours, SI, under its name: `axial stress` of cells, `velocity across`
    and `displacement magnitude` of points. Positions and drawn thickness of bodies are set by their
    actors.
    """

    def __init__(
        self, simulated: SceneSnapshots, settings: ViewSettings, window: bool = False
    ) -> None:
        self.settings, self.simulated = settings, simulated
        self.layout = layout_of(simulated, settings)
        self.found = self.layout.found
        self.time = simulated.time
        self.plotter = pyvista.Plotter(off_screen=not window, window_size=list(SIZE))
        self.plotter.set_background("white")
        self.plotter.enable_anti_aliasing("ssaa")
        self.grids, self.edges = {}, {}
        for i, (name, s) in enumerate(self.found.items()):
            self.grids[name] = pyvista.UnstructuredGrid({CELLS[s.kind]: s.cells}, s.points.copy())
            self.grids[name]["block"] = s.block
            lines = np.insert(surface_of(s).edges, 0, 2, axis=1)
            self.edges[name] = pyvista.PolyData(s.points.copy(), lines=lines.ravel())
            self._add(name, i * self.layout.apart)
        self._label_bar()
        self._place_camera()
        self.show(0)

    def show(self, i: int) -> None:
        """Update the view to instant i."""
        for name, s in self.found.items():
            grid, edges = self.grids[name], self.edges[name]
            grid.points = edges.points = s.points + self.settings.scale * s.displacement[i]
            grid["displacement"] = s.displacement[i]
            grid[self.settings.quantity.name] = self._values(s, i)
        self._write(i)

    def picture(self, path: str, i: int) -> None:
        """Write the view of instant i as PNG."""
        self.show(i)
        self.plotter.screenshot(path)
        self.plotter.close()

    def add_slider(self, i: int) -> None:
        """Add a slider over time below the bodies, at instant i."""
        self.show(i)
        self.plotter.add_slider_widget(
            lambda ms: self.show(int(np.abs(1e3 * self.time - ms).argmin())),
            [float(1e3 * t) for t in self.time[[0, -1]]],
            value=float(1e3 * self.time[i]),
            title="time (ms)",
            color="black",
            pointa=(0.05, 0.1),
            pointb=(0.45, 0.1),
        )

    def open(self) -> None:
        """Open the window until it is closed."""
        self.plotter.show()

    def _values(self, s: Snapshots, i: int | slice) -> np.ndarray:
        """Return the quantity shown by the colours, of cells or points, SI."""
        if self.settings.quantity == STRESS:
            assert s.stress is not None
            return s.stress[i]
        if self.settings.quantity == DISPLACEMENT:
            return np.linalg.norm(s.displacement[i], axis=-1)
        return s.velocity[i] @ self.settings.up

    @property
    def _least(self) -> float:
        """The lower limit of the colours, SI: 0 for an unsigned quantity."""
        return -self._peak if self.settings.quantity.sign else 0.0

    @property
    def _peak(self) -> float:
        """The upper limit of the colours, SI."""
        every = [self._values(s, slice(None)) for s in self.found.values()]
        return max(float(np.abs(x).max()) for x in every) or 1.0

    def _label_bar(self) -> None:
        """Write the quantity above the colour bar, and numbers below it."""
        quantity = self.settings.quantity
        least, peak = quantity.factor * self._least, quantity.factor * self._peak
        left, bottom, width, height = BAR
        self._say(quantity.label, (left + width / 2, bottom + height + 0.012), "center")
        for value in MaxNLocator(4, symmetric=least < 0).tick_values(least, peak):
            if least <= value <= peak:
                place = (left + width * (value - least) / (peak - least), bottom - 0.032)
                self._say(f"{value:.3g}", place, "center")

    def _say(self, text: str, place: tuple[float, float], side: str) -> None:
        """Write at a place in fractions of the picture, aligned left, centred or right."""
        actor = self.plotter.add_text(
            text,
            position=place,
            viewport=True,
            font_size=9,
            color="black",
            font_file=font_for(text),
            name=f"{text} at {place[0]:.4f}",
        )
        actor.prop.justification_horizontal = side

    def _add(self, name: str, place: np.ndarray) -> None:
        quantity, grid = self.settings.quantity, self.grids[name]
        grid[quantity.name] = self._values(self.found[name], 0)
        place_of_bar = dict(zip(("position_x", "position_y", "width", "height"), BAR, strict=True))
        body = self.plotter.add_mesh(
            grid,
            scalars=quantity.name,
            cmap=FIELD if quantity.sign else UNSIGNED,
            clim=(self._least, self._peak),
            # The labels and numbers of the bar are written by _label_bar.
            scalar_bar_args={"title": " ", "n_labels": 0, **place_of_bar},
            ambient=0.7,  # a little shade shows the form and leaves the colours as in the bar
            diffuse=0.35,
        )
        body.mapper.SetResolveCoincidentTopologyToPolygonOffset()  # otherwise the edges flicker
        lines = self.plotter.add_mesh(self.edges[name], color="#333333", line_width=1)
        for actor in (body, lines):
            actor.position = place
            actor.scale = self.layout.stretch
        self.plotter.add_point_labels(
            [place + self.layout.name],
            [name],
            text_color=style(name).colour,
            font_size=18,
            shape=None,
            show_points=False,
            always_visible=True,
        )

    def _place_camera(self) -> None:
        """Point the camera at the middle of all bodies."""
        layout, camera = self.layout, self.plotter.camera
        middle, (wide, tall) = layout.middle + layout.apart * (len(self.found) - 1) / 2, layout.size
        towards = layout.towards / np.linalg.norm(layout.towards)
        camera.focal_point = middle
        camera.position = middle + 2 * wide * towards
        camera.up = self.settings.up
        camera.enable_parallel_projection()
        camera.parallel_scale = SHOWN * max(wide * SIZE[1] / SIZE[0], tall) / 2
        self.plotter.renderer.ResetCameraClippingRange()

    def _write(self, i: int) -> None:
        about = caption(self.simulated.scene, self.settings)
        when = f"t = {1e3 * self.time[i]:.4g} ms, {about}"
        lines = [self.simulated.title, when, *self.simulated.missing]
        text = "\n".join(part for line in lines for part in wrapped(line, _fits))
        self.plotter.add_text(
            text,
            position="upper_left",
            font_size=11,
            color="black",
            font_file=font_for(text),
            name="about",
        )


def _fits(line: str) -> bool:
    """Return whether a line fits the picture; wide letters count twice."""
    return len(line) + sum(ord(letter) > WIDE for letter in line) <= LONGEST


def font_for(text: str) -> str:
    """Return the file of a font with all letters of a text: VTK uses a single one."""
    files = [fonts.file_of(family) for family in fonts.families()]
    return min(files, key=lambda file: len(fonts.missing(file, text)))


class Layout(NamedTuple):
    """Positions of the bodies of a view, m.

    found : by engine, the snapshots whose cells are drawn. stretch : of a body by axis [3]. middle
    : of the first body [3]. apart : offset of successive bodies [3]. name : position of a body's
    name relative to the body [3]. towards : direction to the viewer [3]. size : width and height
    that the picture must show.
    """

    found: dict[str, Snapshots]
    stretch: tuple[float, float, float]
    middle: np.ndarray
    apart: np.ndarray
    name: np.ndarray
    towards: np.ndarray
    size: tuple[float, float]


def layout_of(simulated: SceneSnapshots, settings: ViewSettings) -> Layout:
    """Return the layout of both engines' bodies: pillars one above the other, rock masses side by
    side."""
    if isinstance(simulated.scene, Scene):
        return _of_pillars(simulated.scene, simulated.found, settings)
    return _of_rock_masses(simulated.found, settings)


def _of_pillars(scene: Scene, found: dict[str, Snapshots], settings: ViewSettings) -> Layout:
    side, length, up = scene.pillar.side, scene.pillar.length, settings.up
    found = {name: solid(s, side) for name, s in found.items()}
    drawn = [s.points + settings.scale * s.displacement for s in found.values()]
    reach = max(float(np.ptp(x @ up)) for x in drawn)
    apart = settings.stretch * max(APART * side, reach + side)
    right, above = TILT
    return Layout(
        found,
        (settings.stretch, 1.0, settings.stretch),
        Y * length / 2,
        -apart * up,
        0.8 * settings.stretch * side * up,
        np.cross(Y, up) + right * Y + above * up,
        (length, apart * len(found)),
    )


def _of_rock_masses(found: dict[str, Snapshots], settings: ViewSettings) -> Layout:
    points = np.concatenate([s.points for s in found.values()])
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall, _ = high - low
    return Layout(
        found,
        (1.0, 1.0, 1.0),
        (low + high) / 2,
        np.array([BESIDE * wide, 0.0, 0.0]),
        np.array([low[0], high[1] + ABOVE * max(wide, tall), 0.0]),
        np.cross([1.0, 0.0, 0.0], settings.up),
        (BESIDE * wide * len(found), TALL * tall),
    )
