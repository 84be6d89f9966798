"""Space-time diagrams: y along the pillar over time, the motion as colour, by an engine, and the
differences between engines or from exact solutions.
"""

from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, in_order
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import FORCES, MOTION, ROTATION, axis_of, loudest
from jointwave.compare.figures.style import DIFFERENCE, FIELD
from jointwave.compare.figures.units import UNITS, Unit, unit_for
from jointwave.compare.misfit.metrics import motion
from jointwave.compare.misfit.pairs import pairs
from jointwave.compare.misfit.ranking import own_exact

LEAST = 1e-9  # SI: smaller values count as no motion
HEIGHT = 3.2  # inches
LAYER: dict[str, Any] = {"color": "#111111", "linewidth": 1.1, "linestyle": (0, (4, 3))}


class Diagram(NamedTuple):
    """One diagram: its name and its values [places, times] in `unit`; `share` : of a difference,
    the largest over the largest value of what it is taken from."""

    name: str
    values: np.ndarray
    unit: Unit
    share: float | None = None

    @property
    def heading(self) -> str:
        """Name and unit, and in the last line the range, or the size of a difference."""
        if self.share is None:
            inner = self.values[1:-1]  # the ends' stress is that of the load
            least, most = (f"{x + 0.0:.4g}".replace("-", "−") for x in (inner.min(), inner.max()))
            return f"{self.name}\n({self.unit.name})\nbetween the ends {least} to {most}"
        one, other = self.name.split(" − ")
        share = f"at most {100 * self.share:.2g} % of the largest"
        return f"{one}\n− {other} ({self.unit.name})\n{share}"


class Diagrams(NamedTuple):
    """The diagrams of one figure of a variant over time [n] (s) and y [m] (m).

    exact : whether they are the differences of engines from the exact solutions of their models.
    words : the quantity and its component.
    """

    exact: bool
    words: str
    time: np.ndarray
    y: np.ndarray
    diagrams: list[Diagram]

    def table(self) -> pd.DataFrame:
        """Return every drawn value: a row per place and time."""
        y, time = np.meshgrid(self.y, self.time, indexing="ij")
        columns = {f"{d.name} ({d.unit.name})": d.values.ravel() for d in self.diagrams}
        return pd.DataFrame({"y (m)": y.ravel(), "time (s)": time.ravel(), **columns})


def diagrams_of(scene: Scene, fields: dict[str, xr.Dataset]) -> list[Diagrams]:
    """Return the diagrams of the first engine and of the differences between engines, then those of
    the differences from the exact solution of each engine's own model.

    Empty without motion. fields : of one variant, by name, as returned by `along_pillar`.
    """
    engines = [name for name in in_order(fields) if name in ENGINES]
    if not engines:
        return []
    first = fields[engines[0]]
    quantity, component = loudest(first, (FORCES, MOTION, ROTATION), least=LEAST)
    values = {
        name: np.atleast_3d(motion(result, quantity))[..., component or 0]
        for name, result in fields.items()
    }
    if not any(v.any() for v in values.values()):
        return []
    between = [(p.one, p.other) for p in pairs() if {p.one, p.other} <= set(engines)]
    own = [(one, other) for one in engines if (other := own_exact(one, fields, scene))]
    shown = [_diagram(engines[0], values[engines[0]], quantity)]
    shown += [_difference(*pair, values, quantity) for pair in between]
    errors = [_difference(*pair, values, quantity) for pair in own]
    words = f"{quantity} {axis_of(quantity, component)}".rstrip()
    places = first[first[quantity].dims[0]].values
    return [
        Diagrams(exact, words, first.time.values, places, found)
        for exact, found in ((False, shown), (True, errors))
        if found
    ]


def _difference(one: str, other: str, values: dict[str, np.ndarray], quantity: str) -> Diagram:
    found = values[one] - values[other]
    scale = float(np.abs(values[other]).max())
    share = float(np.abs(found).max()) / scale if scale else 0.0
    return _diagram(f"{one} − {other}", found, quantity, share)


def _diagram(name: str, values: np.ndarray, quantity: str, share: float | None = None) -> Diagram:
    """Return the diagram of SI values; share : for a difference."""
    unit = unit_for(UNITS[quantity], float(np.abs(values).max()))
    return Diagram(name, values / unit.size, unit, share)


def space_time(name: str, scene: Scene, variant: str, shown: Diagrams) -> SceneFigure:
    """Return the figure of one variant's diagrams; those of numerical errors are folded.

    name : unique on the page. variant : its name there.
    """
    words = f"{shown.words} along the pillar over time, {variant}"
    title = f"Numerical error of {words}" if shown.exact else f"{words[0].upper()}{words[1:]}"
    caption, draw = _caption(scene, variant, shown), partial(_draw, scene, shown)
    return SceneFigure(name, title, caption, draw, shown.table(), shown.exact)


def _caption(scene: Scene, variant: str, shown: Diagrams) -> str:
    """Describe the colours, and the places and times of their values."""
    sign = "Compression is red, tension blue. " if shown.words == "stress" else ""
    layers = " Dashed: the soft layer." if scene.soft_layers else ""
    if shown.exact:
        sign = "Each engine minus the exact solution of its own model. "
    return (
        f"{sign}Drawn from {len(shown.y)} places and {len(shown.time)} times of the variant "
        f"{variant!r}, minus its static state; a difference has its own colour scale, up to its "
        f"largest value.{layers}"
    )


def _draw(scene: Scene, shown: Diagrams) -> Figure:
    columns = max(len(shown.diagrams), 2)
    with blank(HEIGHT) as figure:
        axes = figure.subplots(1, columns, sharex=True, sharey=True, squeeze=False)[0]
        for ax, diagram in zip(axes, shown.diagrams, strict=False):
            mesh = _draw_diagram(ax, diagram, shown)
            ticks = MaxNLocator(4, symmetric=True)  # few, so that long numbers do not overlap
            figure.colorbar(mesh, ax=ax, location="bottom", aspect=40, ticks=ticks)
            for layer in scene.soft_layers:
                ax.axhline(layer.y, **LAYER)
        for ax in axes[len(shown.diagrams) :]:
            ax.set_visible(False)
        axes[0].set_ylabel("y (m)")
    return figure


def _draw_diagram(ax: Axes, diagram: Diagram, shown: Diagrams) -> QuadMesh:
    limit = float(np.abs(diagram.values).max()) or 1.0
    mesh = ax.pcolormesh(
        1e3 * shown.time,
        shown.y,
        diagram.values,
        vmin=-limit,
        vmax=limit,
        cmap=FIELD if diagram.share is None else DIFFERENCE,
        shading="nearest",  # a smooth image takes four times the bytes
        rasterized=True,
    )
    ax.set(xlim=1e3 * shown.time[[0, -1]], ylim=shown.y[[0, -1]], xlabel="time (ms)")
    ax.set_title(diagram.heading)
    return mesh
