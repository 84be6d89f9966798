"""The pillars of both engines in three dimensions, by PyVista."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pyvista
from matplotlib.ticker import MaxNLocator

from compare.figures import fonts
from compare.figures.animation.surface import Y, solid, surface_of
from compare.figures.animation.view_settings import STRESS, ViewSettings, caption
from compare.figures.print.layout import wrapped
from compare.figures.style import FIELD, style

if TYPE_CHECKING:
    from compare.figures.animation.snapshots import SceneSnapshots
    from results.snapshots import Snapshots

SIZE = 1280, 720  # pixels
APART = 3.0  # from one pillar's axis to the next, in thicknesses as drawn, at least
TILT = 0.35, 0.3  # how far the viewer stands to the right and above, of the distance
BAR = 0.5, 0.06, 0.45, 0.06  # left, bottom, width and height of the colours, of the picture
LONGEST, WIDE = 110, 0x2E7F  # letters in a line; the last that is no wider than Latin ones
SHOWN = 1.1  # of the pillar's length, that the picture is wide
CELLS = {
    "triangle": pyvista.CellType.TRIANGLE,
    "tetra": pyvista.CellType.TETRA,
    "hexahedron": pyvista.CellType.HEXAHEDRON,
}


class View3D:
    """The pillars, one above the other, at any instant.

    grids : by engine, with the points where the nodes are drawn (m), `displacement` (m) of points,
    and what the colours show, SI, under its name: `axial stress` of cells, `velocity across` of
    points. Where the pillars stand and how thick they are drawn is their actors' affair.
    """

    def __init__(
        self, simulated: SceneSnapshots, settings: ViewSettings, window: bool = False
    ) -> None:
        self.settings, self.simulated = settings, simulated
        side = simulated.scene.pillar.side
        self.found = {name: solid(s, side) for name, s in simulated.found.items()}
        self.time = simulated.time
        self.plotter = pyvista.Plotter(off_screen=not window, window_size=list(SIZE))
        self.plotter.set_background("white")
        self.plotter.enable_anti_aliasing("ssaa")
        self.grids, self.edges = {}, {}
        for i, (name, s) in enumerate(self.found.items()):
            self.grids[name], self.edges[name] = grid_of(s), edges_of(s)
            self._add(name, -i * self._apart * settings.up)
        self._label_bar()
        self._place_camera()
        self.show(0)

    def show(self, i: int) -> None:
        """Move everything to instant i."""
        for name, s in self.found.items():
            grid, edges = self.grids[name], self.edges[name]
            grid.points = edges.points = s.points + self.settings.scale * s.displacement[i]
            grid["displacement"] = s.displacement[i]
            grid[self.settings.quantity.name] = self._values(s, i)
        self._write(i)

    def picture(self, path: str, i: int) -> None:
        """Write what is seen of instant i as PNG."""
        self.show(i)
        self.plotter.screenshot(path)
        self.plotter.close()

    def add_slider(self, i: int) -> None:
        """Put a slider over time below the pillars, at instant i."""
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

    @property
    def _apart(self) -> float:
        """From one pillar's axis to the next, m as drawn."""
        drawn = [s.points + self.settings.scale * s.displacement for s in self.found.values()]
        reach = max(float(np.ptp(x @ self.settings.up)) for x in drawn)
        side = self.simulated.scene.pillar.side
        return self.settings.stretch * max(APART * side, reach + side)

    def _values(self, s: Snapshots, i: int | slice) -> np.ndarray:
        """Return what the colours show, of cells or points, SI."""
        if self.settings.quantity == STRESS:
            assert s.stress is not None
            return s.stress[i]
        return s.velocity[i] @ self.settings.up

    @property
    def _peak(self) -> float:
        """The largest that the colours show, SI."""
        every = [self._values(s, slice(None)) for s in self.found.values()]
        return max(float(np.abs(x).max()) for x in every) or 1.0

    def _label_bar(self) -> None:
        """Write what the colours show above their bar, and numbers below it."""
        quantity, peak = self.settings.quantity, self._peak * self.settings.quantity.factor
        left, bottom, width, height = BAR
        self._say(quantity.label, (left + width / 2, bottom + height + 0.012), "center")
        for value in MaxNLocator(4, symmetric=True).tick_values(-peak, peak):
            if abs(value) <= peak:
                place = (left + width * (value + peak) / (2 * peak), bottom - 0.032)
                self._say(f"{value:.3g}", place, "center")

    def _say(self, text: str, place: tuple[float, float], side: str) -> None:
        """Write at a place in parts of the picture, its left, middle or right end there."""
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
        quantity, grid, stretch = self.settings.quantity, self.grids[name], self.settings.stretch
        grid[quantity.name] = self._values(self.found[name], 0)
        place_of_bar = dict(zip(("position_x", "position_y", "width", "height"), BAR, strict=True))
        pillar = self.plotter.add_mesh(
            grid,
            scalars=quantity.name,
            cmap=FIELD,
            clim=(-self._peak, self._peak),
            # What the bar says is written by _label_bar, beside its numbers.
            scalar_bar_args={"title": " ", "n_labels": 0, **place_of_bar},
            ambient=0.7,  # a little shade shows the form and leaves the colours as in the bar
            diffuse=0.35,
        )
        pillar.mapper.SetResolveCoincidentTopologyToPolygonOffset()  # or the edges flicker
        lines = self.plotter.add_mesh(self.edges[name], color="#333333", line_width=1)
        for actor in (pillar, lines):
            actor.position = place
            actor.scale = stretch, 1.0, stretch
        above = 0.8 * stretch * self.simulated.scene.pillar.side * self.settings.up
        self.plotter.add_point_labels(
            [place + above],
            [name],
            text_color=style(name).colour,
            font_size=18,
            shape=None,
            show_points=False,
            always_visible=True,
        )

    def _place_camera(self) -> None:
        """Look at the middle from the side, a little from the right and from above."""
        length, camera = self.simulated.scene.pillar.length, self.plotter.camera
        middle = Y * length / 2 - self.settings.up * self._apart * (len(self.found) - 1) / 2
        right, above = TILT
        towards = np.cross(Y, self.settings.up) + right * Y + above * self.settings.up
        camera.focal_point = middle
        camera.position = middle + 2 * length * towards / np.linalg.norm(towards)
        camera.up = self.settings.up
        camera.enable_parallel_projection()
        tall = max(length * SIZE[1] / SIZE[0], self._apart * len(self.found))
        camera.parallel_scale = SHOWN * tall / 2
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
    """Return whether a line fits the picture; letters beyond Latin ones are twice as wide."""
    return len(line) + sum(ord(letter) > WIDE for letter in line) <= LONGEST


def font_for(text: str) -> str:
    """Return the file of a font that has a text's letters: VTK takes one for all of them."""
    files = [fonts.file_of(family) for family in fonts.families()]
    return min(files, key=lambda file: len(fonts.missing(file, text)))


def grid_of(s: Snapshots) -> pyvista.UnstructuredGrid:
    """Return the cells of snapshots with the points of the unloaded pillar and `block` of cells."""
    grid = pyvista.UnstructuredGrid({CELLS[s.kind]: s.cells}, s.points.copy())
    grid["block"] = s.block
    return grid


def edges_of(s: Snapshots) -> pyvista.PolyData:
    """Return the edges of the blocks."""
    edges = surface_of(s).edges
    lines = np.insert(edges, 0, 2, axis=1)
    return pyvista.PolyData(s.points.copy(), lines=lines.ravel())
