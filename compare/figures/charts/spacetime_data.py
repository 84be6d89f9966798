"""Data of space-time diagrams: the motion along the pillar by an engine, and the differences
between engines or from exact solutions.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from cases.schema.scene import Scene
from compare.figures.style import DIFFERENCE, FIELD, in_order, is_engine
from compare.figures.subplots import FORCES, MOTION, UNITS
from compare.figures.units import Unit, unit_for
from compare.misfit.metrics import motion
from compare.misfit.pairs import pairs
from compare.misfit.ranking import own_exact

LEAST = 1e-9  # SI: what is below does not move


class Quantity(NamedTuple):
    """What is drawn: a variable of the results, its component (None: its only one), and words."""

    variable: str
    component: int | None
    words: str

    def of(self, result: xr.Dataset) -> np.ndarray:
        """Return the motion [places, times] of a result, SI."""
        values = motion(result, self.variable)
        return values if self.component is None else values[..., self.component]


class Diagram(NamedTuple):
    """One diagram: what it is called, its values [places, times] in `unit`, the colours and what
    their ends stand for; `share` : the largest difference over the largest value, else None.
    """

    name: str
    values: np.ndarray
    unit: Unit
    colours: str
    limit: float
    share: float | None = None

    @property
    def heading(self) -> str:
        """Name and unit, and in the last line the range, or the size of a difference."""
        if self.share is None:
            least, most = (f"{x + 0.0:.4g}".replace("-", "−") for x in self._range)
            return f"{self.name}\n({self.unit.name})\nbetween the ends {least} to {most}"
        one, other = self.name.split(" − ")
        share = f"at most {100 * self.share:.2g} % of the largest"
        return f"{one}\n− {other} ({self.unit.name})\n{share}"

    @property
    def _range(self) -> tuple[float, float]:
        """Least and largest between the ends, whose stress is the load's and not a joint's."""
        inner = self.values[1:-1]
        return float(inner.min()), float(inner.max())


class Diagrams(NamedTuple):
    """The diagrams of one picture of a variant over time [n] (s) and y [m] (m).

    exact : whether they are the differences of engines from the exact solutions of their models.
    """

    exact: bool
    quantity: Quantity
    time: np.ndarray
    y: np.ndarray
    diagrams: list[Diagram]

    def table(self) -> pd.DataFrame:
        """Return every drawn value: a row a place and time."""
        y, time = np.meshgrid(self.y, self.time, indexing="ij")
        columns = {f"{d.name} ({d.unit.name})": d.values.ravel() for d in self.diagrams}
        return pd.DataFrame({"y (m)": y.ravel(), "time (s)": time.ravel(), **columns})


def diagrams_of(scene: Scene, fields: dict[str, xr.Dataset]) -> list[Diagrams]:
    """Return the diagrams of the first engine and of the differences between engines, then those of
    the differences from the exact solution of each engine's own model.

    Empty where nothing moves. fields : of one variant, by name, as `along_pillar` returns them.
    """
    engines = [name for name in in_order(set(fields)) if is_engine(name)]
    if not engines:
        return []
    first = fields[engines[0]]
    quantity = _quantity(first)
    values = {name: quantity.of(result) for name, result in fields.items()}
    if not any(v.any() for v in values.values()):
        return []
    between = [p for p in pairs() if {p.one, p.other} <= set(engines)]
    shown = [_field(engines[0], values, quantity)]
    shown += [_difference(p.one, p.other, values, quantity) for p in between]
    own = {engine: own_exact(engine, fields, scene) for engine in engines}
    errors = [_difference(e, other, values, quantity) for e, other in own.items() if other]
    places = first[first[quantity.variable].dims[0]].values
    return [
        Diagrams(exact, quantity, first.time.values, places, found)
        for exact, found in ((False, shown), (True, errors))
        if found
    ]


def _quantity(result: xr.Dataset) -> Quantity:
    """Return what moves most: of the stress and the components of shear where they are recorded,
    else of the velocity; of the rotation, where the wave strains and displaces nothing."""
    for group in (FORCES, MOTION, ("rotation",)):
        peaks = {(q, c): peak for q in group for c, peak in _peaks(result, q)}
        if max(peaks.values(), default=0.0) > LEAST:
            break
    variable, component = max(peaks, key=lambda key: peaks[key]) if peaks else ("stress", None)
    axes = list(result[variable][result[variable].dims[-1]].values)
    axis = "" if component is None or len(axes) == 1 else f" {axes[component]}"
    return Quantity(variable, component, f"{variable}{axis}")


def _peaks(result: xr.Dataset, variable: str) -> list[tuple[int | None, float]]:
    """Return the largest magnitude of each component's motion, none where it is not recorded."""
    if variable not in result or not result[variable].size:
        return []
    values = np.abs(motion(result, variable))
    if values.ndim == 2:
        return [(None, float(values.max()))]
    return list(enumerate(values.max(axis=(0, 1)).tolist()))


def _field(name: str, values: dict[str, np.ndarray], quantity: Quantity) -> Diagram:
    largest = float(np.abs(values[name]).max())
    unit = unit_for(UNITS[quantity.variable], largest)
    return Diagram(name, unit.drawn(values[name]), unit, FIELD, largest / unit.size)


def _difference(one: str, other: str, values: dict[str, np.ndarray], quantity: Quantity) -> Diagram:
    difference = values[one] - values[other]
    largest = float(np.abs(difference).max())
    scale = float(np.abs(values[other]).max())
    unit = unit_for(UNITS[quantity.variable], largest)
    return Diagram(
        f"{one} − {other}",
        unit.drawn(difference),
        unit,
        DIFFERENCE,
        largest / unit.size,
        largest / scale if scale else 0.0,
    )
