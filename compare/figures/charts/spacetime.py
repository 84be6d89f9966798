"""Space-time diagrams: the motion of an engine as colour over time and y along the pillar, and the
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

LEAST = 1e-9  # SI; smaller values count as no motion
HEIGHT = 2.9  # inches
CAPTION = (
    "Motion relative to the static state: compression is red, tension blue. A difference has its "
    "own colour scale, up to its largest value. A soft layer is dashed."
)


class Diagram(NamedTuple):
    """A diagram: name, heading with unit and range, values [positions, times], unit, colour map."""

    name: str
    heading: str
    values: np.ndarray
    unit: Unit
    colours: str


def space_time(
    name: str, scene: Scene, variant: str, fields: dict[str, xr.Dataset]
) -> list[SceneFigure]:
    """Return the figures of one variant: the first engine with the differences between engines;
    and, folded, the differences of engines from the exact solutions of their own models.

    Empty without motion. name, variant : on the page. fields : results of `along_pillar` by name.
    """
    engines = [engine for engine in in_order(fields) if engine in ENGINES]
    if not engines:
        return []
    first = fields[engines[0]]
    found = peaks([first], (FORCES, MOTION, ROTATION), least=LEAST)
    quantity, component = max(found, key=lambda one: found[one])
    values = {n: by_component(one, quantity)[component] for n, one in fields.items()}
    if not any(v.any() for v in values.values()):
        return []

    def diagram(one: str, other: str = "") -> Diagram:
        """Return the motion of one solution, or its difference from another."""
        shown = values[one] - values[other] if other else values[one]
        largest = float(np.abs(shown).max())
        unit = unit_for(UNITS[quantity], largest)
        shown = shown / unit.size
        if not other:
            inner = shown[1:-1]  # at the ends stress is prescribed by the load
            least, most = (f"{x + 0.0:.4g}".replace("-", "−") for x in (inner.min(), inner.max()))
            size = f"\n({unit.name})\nbetween the ends {least} to {most}"
            return Diagram(label_of(one), label_of(one) + size, shown, unit, FIELD)
        scale = float(np.abs(values[other]).max())
        size = f"at most {100 * largest / scale if scale else 0.0:.2g} % of the largest"
        heading = f"{label_of(one)}\n− {label_of(other)} ({unit.name})\n{size}"
        name = f"{label_of(one)} − {label_of(other)}"
        return Diagram(name, heading, shown, unit, DIFFERENCE)

    between = [diagram(p.one, p.other) for p in pairs() if {p.one, p.other} <= set(engines)]
    errors = [diagram(n, own) for n in engines if (own := own_exact(n, fields, scene))]
    words = f"{quantity} {component}".rstrip() + f" along the pillar over time, {variant}"
    places = first.time.values, first[first[quantity].dims[0]].values
    shown = [diagram(engines[0]), *between]
    drawn = [_figure(name, f"{words[0].upper()}{words[1:]}", scene, *places, shown)]
    if errors:
        title = f"Numerical error of {words}"
        drawn.append(_figure(f"{name}-exact", title, scene, *places, errors)._replace(folded=True))
    return drawn


def _figure(
    name: str, title: str, scene: Scene, time: np.ndarray, y: np.ndarray, shown: list[Diagram]
) -> SceneFigure:
    """Return the figure of diagrams over time [n], s, and y [m], m."""
    columns, ms = max(len(shown), 2), 1e3 * time
    with blank(HEIGHT) as figure:
        axes = figure.subplots(1, columns, sharex=True, sharey=True, squeeze=False)[0]
        for ax, diagram in zip(axes, shown, strict=False):
            limit = float(np.abs(diagram.values).max()) or 1.0
            mesh = ax.pcolormesh(
                *(ms, y, diagram.values),
                vmin=-limit,
                vmax=limit,
                cmap=diagram.colours,
                shading="nearest",  # a smooth image takes four times the bytes
                rasterized=True,
            )
            ax.set(xlim=ms[[0, -1]], ylim=y[[0, -1]], xlabel="time (ms)")
            ax.set_title(diagram.heading)
            ticks = MaxNLocator(4, symmetric=True)  # few, so that long numbers do not overlap
            figure.colorbar(mesh, ax=ax, location="bottom", aspect=40, ticks=ticks)
            for layer in scene.soft_layers:
                ax.axhline(layer.y, color="#111111", linewidth=1.1, linestyle=(0, (4, 3)))
        for ax in axes[len(shown) :]:
            ax.set_visible(False)
        axes[0].set_ylabel("y (m)")
    index = pd.MultiIndex.from_product([y, time], names=["y (m)", "time (s)"])
    values = {f"{d.name} ({d.unit.name})": d.values.ravel() for d in shown}
    return SceneFigure(name, title, CAPTION, figure, pd.DataFrame(values, index).reset_index())
