"""One frame of an animation: the pillars and the wave along them, or a rock mass; the clock."""

from functools import cached_property
from math import ceil, log10
from textwrap import fill
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator

from compare.figures import fonts
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.surface import Wave
from compare.figures.animation.view_settings import ViewSettings, caption
from compare.figures.export import blank
from compare.figures.panels import Panel, panels
from compare.figures.print.layout import wrapped
from compare.figures.style import FIELD, RC, UNSIGNED, style
from compare.figures.units import UNITS, unit_for
from compare.misfit.pairs import Comparison
from results.snapshots import Snapshots

SIZE = 12.8, 7.2  # inches
LEFT, RIGHT = 0.85, 0.25  # inches beside the axes
HEAD, NAME, GAP, FOOT = 0.85, 0.28, 0.5, 0.5  # inches above all, a strip, diagrams; below all
LINE, CLOCK = 0.2, 2.0  # inches of an additional line of text, and of the clock
HIGHEST = {1: 2.4, 2: 1.2}  # inches of a strip, by their number
MARGIN = 0.03  # of a strip's extent, around it
DENSE = 2.5  # points: closer edges would hide the colours
EDGE = "#333333"

AROUND = 0.05  # of the domain's size
LETTERS = 160  # per line
LOUDEST = 99.8  # percentile of speeds shown by the last colour


def _rc() -> dict[Any, Any]:
    return RC | {"font.size": 10.0, "font.family": fonts.families()}


class Frame:
    """The frame of every instant, as pixels; static parts are drawn once."""

    def __init__(self, simulated: SceneSnapshots, settings: ViewSettings, dots: int = 100) -> None:
        self.simulated, self.settings = simulated, settings
        side = simulated.scene.pillar.side
        self.waves = {name: Wave(s, settings, side) for name, s in simulated.found.items()}
        self.time = simulated.time
        peak = max(float(np.abs(w.profile).max()) for w in self.waves.values())
        self.peak = peak * settings.quantity.factor or 1.0
        self.colour = ScalarMappable(Normalize(-self.peak, self.peak), FIELD)
        with blank(SIZE[1], SIZE[0], True, _rc(), dots) as self.figure:
            self._lay_out()
        self.canvas = cast(FigureCanvasAgg, self.figure.canvas)
        self.canvas.draw()
        self.background = self.canvas.copy_from_bbox(self.figure.bbox)

    def show(self, i: int) -> None:
        """Update all moving parts to instant i."""
        for name, wave in self.waves.items():
            polygons, faces, edges = wave.drawn(i)
            values = self.settings.quantity.factor * wave.values[i, faces]
            self.faces[name].set_verts(list(polygons))
            self.faces[name].set_array(values)
            self.edges[name].set_segments(list(edges))
            self.profiles[name].set_ydata(self.settings.quantity.factor * wave.profile[i])
        until = self.time[i] * (1 + 1e-9)
        for name, curve in self.waveforms.items():
            shown = curve[curve.index <= until]
            self.traces[name].set_data(1e3 * shown.index, shown.values)
        self.cursor.set_xdata([1e3 * self.time[i]] * 2)
        self.clock.set_text(f"t = {1e3 * self.time[i]:.{self.decimals}f} ms")

    def image(self, i: int) -> np.ndarray:
        """Return the frame of instant i, uint8 array [height, width, 4]."""
        self.show(i)
        self.canvas.restore_region(self.background)
        for artist in self.animated:
            (artist.axes or self.figure).draw_artist(artist)
        return np.array(self.canvas.buffer_rgba())

    @property
    def animated(self) -> list[Artist]:
        """Artists that are redrawn for each instant, in order."""
        lines = sorted([*self.profiles.values(), *self.traces.values()], key=Line2D.get_zorder)
        return [*self.faces.values(), *self.edges.values(), *lines, self.cursor, self.clock]

    def _lay_out(self) -> None:
        (low, high), width = self._extent(), SIZE[0] - LEFT - RIGHT
        reach = high - low
        height = min(width * self.settings.stretch * reach[1] / reach[0], HIGHEST[len(self.waves)])
        width = height * reach[0] / reach[1] / self.settings.stretch
        place = LEFT + (SIZE[0] - LEFT - RIGHT - width) / 2, width
        top = SIZE[1] - self._add_head()
        self.faces: dict[str, PolyCollection] = {}
        self.edges: dict[str, LineCollection] = {}
        for name in self.waves:
            top -= NAME + height
            ax = self._axes(*place, top, height)
            ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
            self._add_strip(ax, name, 72 * width / reach[0])
        for sentence in self.simulated.missing:
            words = self._in_lines(sentence, SIZE[0] - LEFT - RIGHT, 10.0)
            top -= NAME + LINE * words.count("\n")
            self._say(LEFT, top + 0.05, words, color="#555555")
        rest = top - FOOT - 2 * GAP
        self._add_profile(self._axes(*place, top - GAP / 2 - 0.55 * rest, 0.55 * rest), low, high)
        self._add_waveform(self._axes(LEFT, SIZE[0] - LEFT - RIGHT, FOOT, 0.45 * rest))

    def _extent(self) -> tuple[np.ndarray, np.ndarray]:
        reaches = [wave.reach() for wave in self.waves.values()]
        low = np.min([r[0] for r in reaches], axis=0)
        high = np.max([r[1] for r in reaches], axis=0)
        margin = MARGIN * (high - low) * [0.3, 1]
        return low - margin, high + margin

    def _axes(self, left: float, width: float, bottom: float, height: float) -> Axes:
        """Return axes at a place in inches."""
        across, up = SIZE
        return self.figure.add_axes((left / across, bottom / up, width / across, height / up))

    def _say(self, x: float, y: float, text: str, **settings) -> Text:
        """Write at a place in inches; dollar signs are literal."""
        return self.figure.text(x / SIZE[0], y / SIZE[1], text, parse_math=False, **settings)

    def _add_strip(self, ax: Axes, name: str, points_per_metre: float) -> None:
        ax.set_axis_off()
        ax.set_title(name, color=style(name).colour, pad=2, **_bold(name))
        spacing = self.simulated.scene.pillar.block * points_per_metre
        width = 0.5 if spacing > DENSE else 0.0
        filled = PolyCollection([], edgecolors="face", linewidths=0.3, cmap=FIELD)
        filled.set_norm(self.colour.norm)
        self.faces[name] = filled
        self.edges[name] = LineCollection([], colors=EDGE, linewidths=width, snap=False)
        for collection in (self.faces[name], self.edges[name]):
            collection.set_animated(True)
            ax.add_collection(collection, autolim=False)

    def _add_profile(self, ax: Axes, low: np.ndarray, high: np.ndarray) -> None:
        self.profiles: dict[str, Line2D] = {}
        for name, wave in self.waves.items():
            settings = style(name).of_line()
            (line,) = ax.plot(wave.y, np.zeros_like(wave.y), label=name, animated=True, **settings)
            self.profiles[name] = line
        for layer in self.simulated.scene.soft_layers:
            ax.axvline(layer.y, color="#999999", linewidth=0.8, linestyle=":")
        ax.axvline(self.panel.place.at[0], color="#444444", linewidth=0.8, linestyle="--")
        ax.set(xlim=(low[0], high[0]), ylim=(-1.08 * self.peak, 1.08 * self.peak))
        ax.set_xlabel("y (m)" + "; dotted: soft layers" * bool(self.simulated.scene.soft_layers))
        ax.set_ylabel(f"{self.settings.quantity.name}\n({self.settings.quantity.unit})")

    def _add_waveform(self, ax: Axes) -> None:
        """Add the first receiver's waveform as it was recorded, to be drawn up to each instant."""
        first, curves = self.panel, self.panel.curves
        peak = max(float(np.abs(curve.values).max()) for curve in curves.values())
        unit = unit_for(UNITS[first.quantity], 1.001 * peak)
        self.waveforms = {name: curve / unit.size for name, curve in curves.items()}
        self.traces: dict[str, Line2D] = {}
        for name in self.waveforms:
            (self.traces[name],) = ax.plot([], [], animated=True, **style(name).of_line())
        self.cursor = ax.axvline(0.0, color="#000000", linewidth=1.2, animated=True)
        reach = 1.08 * peak / unit.size or 1.0
        ax.set(xlim=1e3 * self.time[[0, -1]], ylim=(-reach, reach))
        ax.set_ylabel(f"{first.place.named}\n({unit.name})")
        ax.set_xlabel(f"time (ms); at y = {first.place.at[0]:g} m, where the line above is dashed")

    @cached_property
    def panel(self) -> Panel:
        """The component with the largest motion at the first receiver."""
        return panels([Comparison(self.simulated.scene, self.simulated.results)])[0][0]

    def _in_lines(self, text: str, width: float, size: float, **settings) -> str:
        """Return a text in lines of at most `width` inches; size : of its letters, points."""
        measure = self.figure.text(0, 0, "", fontsize=size, parse_math=False, **settings)

        def fits(line: str) -> bool:
            measure.set_text(line)
            return bool(measure.get_window_extent().width <= width * self.figure.dpi)

        lines = wrapped(text, fits)
        measure.remove()
        return "\n".join(lines)

    def _add_head(self) -> float:
        """Add title, clock and colours; return their height, inches."""
        (across, up), title = SIZE, self.simulated.title
        bold = _bold(title)
        title = self._in_lines(title, across - LEFT - RIGHT - CLOCK, 12.0, **bold)
        self._say(LEFT, up - 0.15, title, fontsize=12, va="top", **bold)
        height = HEAD + LINE * title.count("\n")
        low = up - height
        self._say(LEFT, low + 0.23, caption(self.simulated.scene, self.settings), color="#333333")
        step = 1e3 * (self.time[1] - self.time[0])
        self.decimals = max(0, ceil(-log10(step)) + 1)
        place = {"ha": "right", "fontsize": 14, "animated": True, **_bold("t = 0")}
        self.clock = self._say(across - RIGHT, up - 0.36, "", **place)
        bar = self._axes(across - RIGHT - 3.2, 3.2, low + 0.2, 0.13)
        few = MaxNLocator(5)
        self.figure.colorbar(self.colour, cax=bar, orientation="horizontal", ticks=few)
        self._say(across - RIGHT - 3.45, low + 0.2, self.settings.quantity.label, ha="right")
        return height


def _bold(text: str) -> dict[str, Any]:
    """Return the settings of bold text; fonts of non-Latin scripts may lack it."""
    if fonts.missing(fonts.file_of(fonts.LATIN), text):
        return {}
    return {"fontweight": "bold", "fontfamily": fonts.LATIN}


class PlaneFrame:
    """The frame of every instant of a rock mass, its blocks by each engine, as pixels."""

    def __init__(self, simulated: SceneSnapshots, settings: ViewSettings, dots: int = 100) -> None:
        self.simulated, self.time, self.scale = simulated, simulated.time, settings.scale
        self.speeds = {name: speeds(s) for name, s in simulated.found.items()}
        peak = max(float(np.percentile(x, LOUDEST)) for x in self.speeds.values()) or 1.0
        self.unit = unit_for("m/s", 1.001 * peak)
        self.colour = ScalarMappable(Normalize(0.0, peak / self.unit.size), UNSIGNED)
        with blank(SIZE[1], SIZE[0], True, _rc(), dots) as self.figure:
            self._lay_out()
        self.canvas = cast(FigureCanvasAgg, self.figure.canvas)

    def image(self, i: int) -> np.ndarray:
        """Return the frame of instant i, uint8 array [height, width, 4]."""
        for name, faces in self.faces.items():
            faces.set_verts(list(cells_at(self.simulated.found[name], i, self.scale)))
            faces.set_array(self.speeds[name][i] / self.unit.size)
        self.clock.set_text(f"t = {1e3 * self.time[i]:.3f} ms")
        self.canvas.draw()
        return np.array(self.canvas.buffer_rgba())

    def _lay_out(self) -> None:
        axes = self.figure.subplots(1, len(self.speeds), sharey=True, squeeze=False)[0]
        self.figure.subplots_adjust(left=0.07, right=0.98, bottom=0.2, top=0.86)
        self.faces: dict[str, PolyCollection] = {}
        for ax, name in zip(axes, self.speeds, strict=True):
            self._add_rock(ax, name)
        axes[0].set_ylabel("y (m)")
        bar = self.figure.add_axes((0.3, 0.09, 0.4, 0.02))
        self.figure.colorbar(self.colour, cax=bar, orientation="horizontal")
        bar.set_title(f"particle speed ({self.unit.name})", fontsize=10, pad=3)
        self._say(0.07, 0.955, self.simulated.title)
        self._say(0.07, 0.92, f"displacements exaggerated {self.scale:g} times")
        self._say(0.07, 0.01, fill("; ".join(self.simulated.missing), LETTERS))
        self.clock = self._say(0.85, 0.955, "")

    def _add_rock(self, ax: Axes, name: str) -> None:
        points = self.simulated.found[name].points
        low, high = points.min(axis=0)[:2], points.max(axis=0)[:2]
        margin = AROUND * (high - low).max()
        faces = PolyCollection([], cmap=UNSIGNED, edgecolors="face", linewidths=0.2)
        faces.set_norm(self.colour.norm)
        ax.add_collection(faces)
        ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
        ax.set_aspect("equal")
        ax.set_xlabel("x (m)")
        ax.set_title(name, color=style(name).colour)
        self.faces[name] = faces

    def _say(self, x: float, y: float, text: str):
        return self.figure.text(x, y, text, parse_math=False, va="bottom")


def speeds(s: Snapshots) -> np.ndarray:
    """Return the mean particle speed of every cell [snapshots, cells], m/s."""
    return np.linalg.norm(s.velocity, axis=2)[:, s.cells].mean(axis=2)


def cells_at(s: Snapshots, i: int, scale: float) -> np.ndarray:
    """Return the corners of every cell at instant i [cells, corners, 2], m, with displacements
    exaggerated `scale` times."""
    return (s.points + scale * s.displacement[i])[s.cells][..., :2]
