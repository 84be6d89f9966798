"""One frame of an animation of a rock mass: its blocks by each engine, and the clock."""

from textwrap import fill

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from compare.figures import fonts
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.view_settings import ViewSettings
from compare.figures.style import RC, UNSIGNED, style
from compare.figures.units import unit_for
from results.snapshots import Snapshots

SIZE = 12.8, 7.2  # inches
AROUND = 0.05  # of the domain's size
LETTERS = 160  # per line
LOUDEST = 99.8  # percentile of speeds shown by the last colour


class PlaneFrame:
    """The frame of every instant, as pixels."""

    def __init__(self, simulated: SceneSnapshots, settings: ViewSettings, dots: int = 100) -> None:
        self.simulated, self.time, self.scale = simulated, simulated.time, settings.scale
        self.speeds = {name: speeds(s) for name, s in simulated.found.items()}
        peak = max(float(np.percentile(x, LOUDEST)) for x in self.speeds.values()) or 1.0
        self.unit = unit_for("m/s", 1.001 * peak)
        self.colour = ScalarMappable(Normalize(0.0, peak / self.unit.size), UNSIGNED)
        with matplotlib.rc_context(RC | {"font.size": 10.0, "font.family": fonts.families()}):
            self.figure = Figure(figsize=SIZE, dpi=dots)
            self.canvas = FigureCanvasAgg(self.figure)
            self._lay_out()

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
