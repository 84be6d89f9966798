"""The frame of an animation: the bodies of each engine, the wave along a pillar, the clock."""

from math import ceil, log10
from textwrap import wrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import label_of
from jointwave.compare.figures.animation import bodies, snapshots
from jointwave.compare.figures.export import blank, label_ends
from jointwave.compare.figures.receivers import panels
from jointwave.compare.figures.style import RC, UNITS, style, unit_for
from jointwave.compare.misfit.pairs import Comparison
from jointwave.results.snapshots import Snapshots

SIZE, PIXELS = (12.8, 7.2), (1280, 720)  # inches
BODIES = 2.8  # largest total height of pillars, inches
LETTERS = 75  # per line of the title, left of the clock
TOWARDS = 0.05, -1.0, 0.35  # direction to the viewer of a window, in the axes of a body
HEAD, STRIP = 0.7, 0.95  # heights of the header and of a pillar, inches


class Frame:
    """The frame of an instant: the bodies and, for a pillar, the wave along it and a waveform.

    scale, quantity : see `settings_for`.
    """

    def __init__(
        self,
        simulated: snapshots.SceneSnapshots,
        scale: float | None = None,
        quantity: snapshots.Quantity | None = None,
    ) -> None:
        self.simulated, self.time = simulated, simulated.time
        scene, found = simulated.scene, simulated.found
        self.settings = settings = snapshots.settings_for(scene, found, scale, quantity)
        self.bodies = {name: bodies.body_of(s, settings) for name, s in found.items()}
        values = [body.values for body in self.bodies.values()]
        self.colours, beyond = bodies.colours_of(values, settings.quantity.sign)
        self.views: dict[str, bodies.BodyView] = {}
        self.along: dict[str, pd.DataFrame] = {}
        self.profiles: dict[str, Line2D] = {}
        self.waveforms = pd.DataFrame()
        self.traces: dict[str, Line2D] = {}
        rc: dict[Any, Any] = RC | {"font.size": 10.0, "figure.figsize": SIZE, "figure.dpi": 100.0}
        with blank(SIZE[1], rc=rc) as self.figure:
            self.figure.suptitle("\n".join(self._title()), x=0.01, ha="left", parse_math=False)
            if scene.is_column:
                self._add_pillars()
            else:
                axes = self.figure.subplots(1, len(found), sharey=True, squeeze=False)[0]
                self._add_bodies(axes, bodies.ABOVE if scene.in_space else bodies.FRONT)
                up, of = ("z", " at y = 0") if scene.in_space else ("y", "")
                for ax in axes:
                    ylabel = f"{up} (m){of}" * (ax is axes[0])
                    ax.set(anchor="N", xlabel=f"x (m){of}", ylabel=ylabel)
                    label_ends(ax)
            label = settings.quantity.label
            label += f"; {100 * beyond:.2g} % is beyond" if beyond else ""
            look: dict[str, Any] = {"aspect": 50, "panchor": False, "label": label}
            self.figure.colorbar(self.colours, ax=self.figure.axes, **look)
            self.show(0)
            faces = [view.faces for view in self.views.values()]
            moving = [*faces, self.clock, *self.profiles.values(), *self.traces.values()]
            self.moving: list[Artist] = sorted(moving, key=lambda artist: artist.get_zorder())
            for artist in self.moving:
                artist.set_animated(True)
            self.figure.canvas.draw()
            self.figure.set_layout_engine("none")  # moving parts do not change the layout
            self.background = self.figure.canvas.copy_from_bbox(self.figure.bbox)  # type: ignore[attr-defined]

    def show(self, i: int) -> None:
        """Update all moving parts to instant i."""
        for view in self.views.values():
            view.show(i)
        step = 1e3 * (self.time[1] - self.time[0])
        self.clock.set_text(f"t = {1e3 * self.time[i]:.{max(0, ceil(-log10(step)) + 1)}f} ms")
        for name, line in self.profiles.items():
            line.set_ydata(self.along[name].iloc[i])
        for name, curve in self.waveforms.items():
            shown = curve[curve.index <= self.time[i] * (1 + 1e-9)]
            self.traces[name].set_data(1e3 * shown.index, shown.values)

    def image(self, i: int) -> np.ndarray:
        """Return the frame of instant i, uint8 array [height, width, 4]."""
        self.show(i)
        canvas: Any = self.figure.canvas
        canvas.restore_region(self.background)
        for artist in self.moving:
            self.figure.draw_artist(artist)
        return np.array(canvas.buffer_rgba())

    def _title(self) -> list[str]:
        """Return the lines of the title: scene, exaggeration, and engines that do not apply."""
        scene, caption = self.simulated.scene, self.settings.caption
        stress = self.settings.quantity in (snapshots.STRESS, snapshots.PRINCIPAL)
        if stress and (scene.gravity or scene.prestress):
            caption += ", stress change from the static state"
        missing = [
            f"{label_of(name)} does not apply: {why}"
            for name, why in self.simulated.reasons.items()
        ]
        title = ", ".join(part for part in (scene.title, scene.name) if part)
        return [line for words in (title, caption, *missing) for line in wrap(words, LETTERS)]

    def _add_bodies(self, axes: list[Axes], per_away: tuple[float, float]) -> None:
        """Draw each body into its axes, with its name as title."""
        for ax, (name, body) in zip(axes, self.bodies.items(), strict=True):
            self.views[name] = bodies.BodyView(ax, body, self.colours, per_away)
            ax.set_title(label_of(name), color=style(name).colour, fontweight="bold")
        corner: dict[str, Any] = {"transform": self.figure.transFigure, "in_layout": False}
        self.clock = axes[-1].text(0.99, 0.99, "", ha="right", va="top", fontsize=14, **corner)

    def _add_pillars(self) -> None:
        """Draw the pillars one below the other, then the colours' quantity along them, and the
        first receiver's waveform, which `show` draws up to an instant."""
        count = len(self.bodies)
        *axes, profile, waveform = self.figure.subplots(count + 2, 1)
        self._add_bodies(axes, bodies.OBLIQUE)
        low = np.min([view.low for view in self.views.values()], axis=0)
        high = np.max([view.high for view in self.views.values()], axis=0)
        height = min(SIZE[0] * (high - low)[1] / (high - low)[0], BODIES / count)
        rest = (SIZE[1] - 2.0 - count * height) / 2
        profile.get_gridspec().set_height_ratios([*[height] * count, rest, rest])
        for ax in axes:
            ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
            ax.set_axis_off()
        soft_layers, quantity = self.simulated.scene.soft_layers, self.settings.quantity
        for name, body in self.bodies.items():
            self.along[name] = along = body.profile()
            (line,) = profile.plot(along.columns, along.iloc[0], **style(name).of_line())
            self.profiles[name] = line
        for layer in soft_layers:
            profile.axvline(layer.y, color="#999999", linewidth=0.8, linestyle=":")
        most = max(float(along.abs().max(axis=None)) for along in self.along.values())
        reach = 1.08 * most or 1.0
        dotted = f"; dotted: soft layer{'s' * (len(soft_layers) > 1)}" * bool(soft_layers)
        profile.set(xlim=(low[0], high[0]), ylim=(-reach if quantity.sign else 0.0, reach))
        profile.set(xlabel=f"y (m){dotted}", ylabel=quantity.name.replace(" (", "\n("))
        first = panels([Comparison(self.simulated.scene, self.simulated.results)])[0][0]
        peak = float(first.curves.abs().max(axis=None))
        unit = unit_for(UNITS[first.place.quantity], 1.001 * peak)
        self.waveforms = first.curves / unit.size
        self.traces = {n: waveform.plot([], [], **style(n).of_line())[0] for n in self.waveforms}
        reach = 1.08 * peak / unit.size or 1.0
        waveform.set(xlim=1e3 * self.time[[0, -1]], ylim=(-reach, reach))
        waveform.set_ylabel(f"{first.place.named}\n({unit.name})")
        waveform.set_xlabel(f"time (ms); at y = {first.place.at[0]:g} m")


def draw_snapshots(name: str, scene: AnyScene, s: Snapshots) -> Figure:
    """Return a figure of snapshots one below the other, with exaggerated displacements.

    The pillar of instant i is the SVG group NAME-i.
    """
    settings = snapshots.settings_for(scene, {"": s})
    body = bodies.body_of(s, settings)
    colours, _ = bodies.colours_of([body.values], settings.quantity.sign)
    with blank(HEAD + STRIP * len(s.time)) as figure:
        axes = figure.subplots(len(s.time), 1, squeeze=False)[:, 0]
        for i, (ax, time) in enumerate(zip(axes, s.time, strict=True)):
            view = bodies.BodyView(ax, body, colours, bodies.OBLIQUE)
            view.show(i)
            view.faces.set_gid(f"{name}-{i}")
            ax.set(xticks=[], yticks=[], frame_on=False)
            ax.set_ylabel(f"{1e3 * time:g} ms", rotation=0, ha="right", va="center")
        axes[-1].set_xlabel(f"y to the right; {settings.caption}")
        label = settings.quantity.label
        figure.colorbar(colours, ax=axes, label=label, location="top", shrink=0.4, aspect=30)
    return figure


def open_window(frame: Frame, i: int) -> None:
    """Open a window with a frame's bodies at instant i, one below the other, and a slider over all
    instants; return when it is closed."""
    import pyvista  # optional dependency

    shown, time = frame.bodies, frame.time
    plotter = pyvista.Plotter(window_size=[1280, 720])
    apart = np.array([0.0, 0.0, -1.3 * max(np.ptp(body.rest[:, 2]) for body in shown.values())])
    meshes = [pyvista.PolyData.from_regular_faces(b.rest, b.faces) for b in shown.values()]

    def show(ms: float) -> None:
        at = int(np.abs(1e3 * time - ms).argmin())
        for k, (body, mesh) in enumerate(zip(shown.values(), meshes, strict=True)):
            mesh.points = body.rest + body.motion[at] + k * apart
            mesh.cell_data["value"] = body.values[at]

    show(1e3 * time[i])
    for mesh in meshes:
        plotter.add_mesh(
            mesh,
            scalars="value",
            cmap=frame.colours.get_cmap(),
            clim=list(frame.colours.get_clim()),
            show_edges=True,
            edge_color=bodies.EDGE,
            scalar_bar_args={"title": frame.settings.quantity.label},
            lighting=False,  # colours as in the bar
        )
    plotter.add_text(" above ".join(map(label_of, shown)), font_size=11)
    first, last = (float(1e3 * t) for t in time[[0, -1]])
    plotter.add_slider_widget(show, [first, last], value=float(1e3 * time[i]), title="time (ms)")
    plotter.view_vector(TOWARDS, viewup=(0.0, 0.0, 1.0))
    plotter.enable_parallel_projection()
    plotter.camera.zoom(1.6)
    plotter.show()
