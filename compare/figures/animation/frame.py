"""One frame of an animation: the bodies by each engine, the wave along a pillar, the clock."""

from math import ceil, log10
from textwrap import wrap
from typing import Any, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator

from jointwave.cases.effects import is_spatial
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures import fonts
from jointwave.compare.figures.animation.bodies import TOWARDS, Box, FrontView, SpaceView
from jointwave.compare.figures.animation.polygons import Polygons, polygons_of
from jointwave.compare.figures.animation.rendered import RenderedView, can_render
from jointwave.compare.figures.animation.settings import ViewSettings, caption
from jointwave.compare.figures.animation.snapshots import SceneSnapshots
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.panels import panels
from jointwave.compare.figures.style import FIELD, RC, UNSIGNED, style
from jointwave.compare.figures.units import UNITS, unit_for
from jointwave.compare.misfit.pairs import Comparison

SIZE = 12.8, 7.2  # inches
LEFT, RIGHT, FOOT, GAP, NAME, LINE = 1.05, 0.25, 0.5, 0.55, 0.3, 0.2  # inches
BAR = 3.2, 0.13  # inches of the bar of colours
HIGHEST = 2.4  # inches of all pillars
LETTERS, WIDE = 85, 0x2E7F  # per line; last character that is not twice as wide as Latin ones
LOUDEST = 99.8  # percentile of an unsigned quantity shown by the last colour


class View(Protocol):
    """A body in a figure."""

    def show(self, i: int) -> None:
        """Update the picture to an instant."""


class Frame:
    """The frame of every instant: of a pillar with the wave along it and a waveform, of a rock mass
    its bodies side by side.

    in_space : whether pillars that move along their axis only are drawn in space as well.
    """

    def __init__(
        self,
        simulated: SceneSnapshots,
        settings: ViewSettings,
        dots: int = 100,
        in_space: bool = False,
    ) -> None:
        self.simulated, self.settings, self.time = simulated, settings, simulated.time
        scene = simulated.scene
        self.in_space = isinstance(scene, Scene) and (in_space or is_spatial(scene))
        self.bodies = {n: polygons_of(s, scene, settings) for n, s in simulated.found.items()}
        self.colours = colours_of(list(self.bodies.values()), settings)
        self.views: dict[str, View] = {}
        rc: dict[Any, Any] = RC | {"font.size": 10.0, "font.family": fonts.families()}
        with blank(SIZE[1], SIZE[0], True, rc, dots) as self.figure:
            top = SIZE[1] - self._add_head()
            (self._add_pillars if isinstance(scene, Scene) else self._add_masses)(top)

    def show(self, i: int) -> None:
        """Update all moving parts to instant i."""
        for view in self.views.values():
            view.show(i)
        self.clock.set_text(f"t = {1e3 * self.time[i]:.{self.decimals}f} ms")
        if isinstance(self.simulated.scene, Scene):
            for name, line in self.profiles.items():
                line.set_ydata(self.along[name].iloc[i])
            for name, curve in self.waveforms.items():
                shown = curve[curve.index <= self.time[i] * (1 + 1e-9)]
                self.traces[name].set_data(1e3 * shown.index, shown.values)
            self.cursor.set_xdata([1e3 * self.time[i]] * 2)

    def image(self, i: int) -> np.ndarray:
        """Return the frame of instant i, uint8 array [height, width, 4]."""
        self.show(i)
        self.figure.canvas.draw()
        return np.array(self.figure.canvas.buffer_rgba())  # type: ignore[attr-defined]

    def _axes(self, left: float, bottom: float, width: float, height: float) -> Axes:
        """Return axes at a place in inches."""
        return self.figure.add_axes(_box(left, bottom, width, height))

    def _add_head(self) -> float:
        """Add title, clock and colours; return their height, inches."""
        (across, up), scene = SIZE, self.simulated.scene
        sentences = [self.simulated.title, caption(scene, self.settings), *self.simulated.missing]
        lines = [line for sentence in sentences for line in _lines(sentence)]
        low = up - 0.5 - LINE * len(lines)
        head = self.figure.text(LEFT / across, 1 - 0.15 / up, "\n".join(lines), va="top")
        head.set(parse_math=False, linespacing=1.4)
        step = 1e3 * (self.time[1] - self.time[0])
        self.decimals = max(0, ceil(-log10(step)) + 1)
        place = 1 - RIGHT / across, 1 - 0.15 / up
        self.clock = self.figure.text(*place, "", ha="right", va="top", fontsize=14)
        bar = self._axes(across - RIGHT - BAR[0], low + 0.12, *BAR)
        self.figure.colorbar(self.colours, cax=bar, orientation="horizontal", ticks=MaxNLocator(5))
        place = (across - RIGHT - BAR[0] - 0.15) / across, (low + 0.12) / up
        self.figure.text(*place, self.settings.quantity.label, ha="right")
        return up - low + 0.15

    def _add_view(self, name: str, box: Box) -> Axes | None:
        """Add a body to a box in inches, below its name; return its axes if they are in metres."""
        left, bottom, _, height = _box(*box)
        at = left, bottom + height + 0.06 / SIZE[1]
        self.figure.text(*at, name, color=style(name).colour, fontweight="bold")
        body = self.bodies[name]
        if not self.in_space:
            self.views[name] = front = FrontView(self.figure, _box(*box), body, self.colours)
            return front.ax
        if can_render():
            self.views[name] = RenderedView(self._axes(*box), body, self.colours)
        else:
            self.views[name] = SpaceView(self.figure, _box(*box), body, self.colours)
        return None

    def _add_masses(self, top: float) -> None:
        count, width = len(self.bodies), SIZE[0] - LEFT - RIGHT
        for k, name in enumerate(self.bodies):
            box = LEFT + k * width / count, FOOT, (width - LEFT) / count, top - FOOT - NAME
            ax = self._add_view(name, box)
            assert ax is not None
            ax.set(aspect="equal", anchor="N", xlabel="x (m)", ylabel="y (m)" * (k == 0))

    def _add_pillars(self, top: float) -> None:
        width, count = SIZE[0] - LEFT - RIGHT, len(self.bodies)
        low, high = np.stack([body.reach() for body in self.bodies.values()], axis=1)
        low, high = low.min(axis=0), high.max(axis=0)
        right, away, up = high - low
        if self.in_space:  # as seen from above and aside
            aside, _, above = TOWARDS
            right, up = right + aside * away, up + above * (aside * right + away)
        height = min(width * up / right, HIGHEST / count)
        for name in self.bodies:
            top -= NAME + height
            ax = self._add_view(name, (LEFT, top, width, height))
            if ax is not None:
                ax.set(aspect="equal", xlim=(low[0], high[0]))
                ax.set_axis_off()
        rest = top - FOOT - 2 * GAP
        profile = self._axes(LEFT, top - GAP / 2 - 0.55 * rest, width, 0.55 * rest)
        self._add_profile(profile)
        shown = (0.0, self.simulated.scene.pillar.length) if self.in_space else (low[0], high[0])
        profile.set_xlim(*shown)
        self._add_waveform(self._axes(LEFT, FOOT, width, 0.45 * rest))

    def _add_profile(self, ax: Axes) -> None:
        scene, quantity = self.simulated.scene, self.settings.quantity
        self.along = {name: body.profile() for name, body in self.bodies.items()}
        self.profiles = {}
        for name, values in self.along.items():
            zero = np.zeros(values.shape[1])
            (self.profiles[name],) = ax.plot(values.columns, zero, **style(name).of_line())
        for layer in scene.soft_layers:
            ax.axvline(layer.y, color="#999999", linewidth=0.8, linestyle=":")
        reach = 1.08 * float(self.colours.get_clim()[1] or 1.0)
        ax.set_ylim(-reach, reach)
        ax.set_xlabel("y (m)" + "; dotted: soft layers" * bool(scene.soft_layers))
        ax.set_ylabel(f"{quantity.name}\n({quantity.unit})")

    def _add_waveform(self, ax: Axes) -> None:
        """Add the first receiver's waveform as it was recorded, to be drawn up to each instant."""
        first = panels([Comparison(self.simulated.scene, self.simulated.results)])[0][0]
        curves = first.curves
        peak = max(float(np.abs(curve.values).max()) for curve in curves.values())
        unit = unit_for(UNITS[first.quantity], 1.001 * peak)
        self.waveforms = {name: curve / unit.size for name, curve in curves.items()}
        self.traces = {n: ax.plot([], [], **style(n).of_line())[0] for n in self.waveforms}
        self.cursor = ax.axvline(0.0, color="#000000", linewidth=1.2)
        reach = 1.08 * peak / unit.size or 1.0
        ax.set(xlim=1e3 * self.time[[0, -1]], ylim=(-reach, reach))
        ax.set_ylabel(f"{first.place.named}\n({unit.name})")
        ax.set_xlabel(f"time (ms); at y = {first.place.at[0]:g} m")


def colours_of(bodies: list[Polygons], settings: ViewSettings) -> ScalarMappable:
    """Return the colours of a quantity, symmetric around zero where it has a sign."""
    every = [np.abs(body.values) for body in bodies]
    if settings.quantity.sign:
        peak = max(float(values.max()) for values in every) or 1.0
        return ScalarMappable(Normalize(-peak, peak), FIELD)
    peak = max(float(np.percentile(values, LOUDEST)) for values in every) or 1.0
    return ScalarMappable(Normalize(0.0, peak), UNSIGNED)


def _box(left: float, bottom: float, width: float, height: float) -> Box:
    """Return a place in fractions of the figure of one in inches."""
    across, up = SIZE
    return left / across, bottom / up, width / across, height / up


def _lines(text: str) -> list[str]:
    """Return a text in lines that leave room for the clock."""
    return wrap(text, LETTERS // (1 + any(ord(letter) > WIDE for letter in text)))
