"""Space-time diagrams: y along the pillar over time, the motion as colour, by an engine, and the
differences between engines or from exact solutions.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.ticker import MaxNLocator

from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, in_order, label_of
from jointwave.compare.figures.export import SceneFigure, blank
from jointwave.compare.figures.receivers import FORCES, MOTION, ROTATION, by_component, peaks
from jointwave.compare.figures.style import DIFFERENCE, FIELD, UNITS, Unit, unit_for
from jointwave.compare.misfit.pairs import pairs
from jointwave.compare.misfit.ranking import own_exact

LEAST = 1e-9  # SI: smaller values count as no motion
HEIGHT = 2.9  # inches
CAPTION = (
    "Motion relative to the static state: compression is red, tension blue. A difference has its "
    "own colour scale, up to its largest value. A soft layer is dashed."
)


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


def diagrams_of(scene: Scene, fields: dict[str, xr.Dataset]) -> list[Diagrams]:
    """Return the diagrams of the first engine and of the differences between engines, then those of
    the differences from the exact solution of each engine's own model.

    Empty without motion. fields : of one variant, by name, as returned by `along_pillar`.
    """
    engines = [name for name in in_order(fields) if name in ENGINES]
    if not engines:
        return []
    first = fields[engines[0]]
    found = peaks([first], (FORCES, MOTION, ROTATION), least=LEAST)
    quantity, component = max(found, key=lambda one: found[one])
    values = {n: by_component(one, quantity)[component] for n, one in fields.items()}
    if not any(v.any() for v in values.values()):
        return []

    def diagram(one: str, other: str = "") -> Diagram:
        shown, share = values[one], None
        if other:
            shown, scale = shown - values[other], float(np.abs(values[other]).max())
            share = float(np.abs(shown).max()) / scale if scale else 0.0
        unit = unit_for(UNITS[quantity], float(np.abs(shown).max()))
        name = " − ".join(map(label_of, filter(None, (one, other))))
        return Diagram(name, shown / unit.size, unit, share)

    between = [diagram(p.one, p.other) for p in pairs() if {p.one, p.other} <= set(engines)]
    errors = [diagram(n, own) for n in engines if (own := own_exact(n, fields, scene))]
    places = first[first[quantity].dims[0]].values
    about = f"{quantity} {component}".rstrip(), first.time.values, places
    shown = [Diagrams(False, *about, [diagram(engines[0]), *between])]
    return [*shown, Diagrams(True, *about, errors)] if errors else shown


def space_time(name: str, scene: Scene, variant: str, shown: Diagrams) -> SceneFigure:
    """Return the figure of one variant's diagrams; those of numerical errors are folded.

    name : unique on the page. variant : its name there.
    """
    title = f"{shown.words} along the pillar over time, {variant}"
    title = f"Numerical error of {title}" if shown.exact else f"{title[0].upper()}{title[1:]}"
    columns, ms = max(len(shown.diagrams), 2), 1e3 * shown.time
    with blank(HEIGHT) as figure:
        axes = figure.subplots(1, columns, sharex=True, sharey=True, squeeze=False)[0]
        for ax, diagram in zip(axes, shown.diagrams, strict=False):
            limit = float(np.abs(diagram.values).max()) or 1.0
            mesh = ax.pcolormesh(
                *(ms, shown.y, diagram.values),
                vmin=-limit,
                vmax=limit,
                cmap=FIELD if diagram.share is None else DIFFERENCE,
                shading="nearest",  # a smooth image takes four times the bytes
                rasterized=True,
            )
            ax.set(xlim=ms[[0, -1]], ylim=shown.y[[0, -1]], xlabel="time (ms)")
            ax.set_title(diagram.heading)
            ticks = MaxNLocator(4, symmetric=True)  # few, so that long numbers do not overlap
            figure.colorbar(mesh, ax=ax, location="bottom", aspect=40, ticks=ticks)
            for layer in scene.soft_layers:
                ax.axhline(layer.y, color="#111111", linewidth=1.1, linestyle=(0, (4, 3)))
        for ax in axes[len(shown.diagrams) :]:
            ax.set_visible(False)
        axes[0].set_ylabel("y (m)")
    y, time = np.meshgrid(shown.y, shown.time, indexing="ij")
    values = {f"{d.name} ({d.unit.name})": d.values.ravel() for d in shown.diagrams}
    table = pd.DataFrame({"y (m)": y.ravel(), "time (s)": time.ravel(), **values})
    return SceneFigure(name, title, CAPTION, figure, table, shown.exact)
