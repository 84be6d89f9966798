"""What space-time diagrams show: solutions along the pillar, and their differences, in numbers."""

from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from compare.pairs import BETWEEN, PAIRS
from compare.panels import FORCES, UNITS
from compare.pictures.along import referees
from compare.pictures.units import Unit, unit_for
from compare.style import in_order, is_engine

#: Diverging, even to the eye and told apart under every colour blindness (ColorBrewer).
FIELD, DIFFERENCE = "RdBu_r", "PuOr_r"


class Quantity(NamedTuple):
    """What is drawn: a variable of the results, its component (None: its only one), and words."""

    variable: str
    component: int | None
    words: str

    def of(self, result: xr.Dataset) -> np.ndarray:
        """Return the values [sections, times] of a result, SI."""
        values = result[self.variable].values
        return values if self.component is None else values[..., self.component]


class Diagram(NamedTuple):
    """One diagram: what it is called, its values [sections, times] in `unit`, the colours and
    what their ends stand for; `share` : the largest difference over the largest value, else None.
    """

    name: str
    values: np.ndarray
    unit: Unit
    colours: str
    limit: float
    share: float | None = None

    @property
    def heading(self) -> str:
        """Name and unit, and in a second line the size of a difference."""
        if self.share is None:
            return f"{self.name} ({self.unit.name})"
        share = f"at most {100 * self.share:.2g} % of the largest"
        return f"{self.name}\n({self.unit.name}), {share}"


class Diagrams(NamedTuple):
    """The diagrams of one picture over time [n] (s) and y [m] (m).

    engine : whose, empty for differences between engines. variant : of the scene.
    """

    engine: str
    variant: str
    quantity: Quantity
    time: np.ndarray
    y: np.ndarray
    diagrams: list[Diagram]

    def table(self) -> pd.DataFrame:
        """Return every drawn value: a row a section and time."""
        y, time = np.meshgrid(self.y, self.time, indexing="ij")
        columns = {f"{d.name} ({d.unit.name})": d.values.ravel() for d in self.diagrams}
        return pd.DataFrame({"y (m)": y.ravel(), "time (s)": time.ravel(), **columns})


def diagrams_of(fields: dict[str, xr.Dataset]) -> list[Diagrams]:
    """Return the diagrams of each engine, its exact solution and their difference, and of the
    differences between engines. Those of a field without any wave are left out.

    fields : by name, as `along_pillar` returns them.
    """
    engines = [name for name in in_order(set(fields)) if is_engine(name)]
    if not engines:
        return []
    quantity = _quantity(fields[engines[0]])
    values = {name: quantity.of(result) for name, result in fields.items()}
    groups = {engine: _of_engine(engine, values, quantity) for engine in engines}
    between = [p for p in PAIRS if p.kind == BETWEEN and p.one in fields and p.other in fields]
    groups[""] = [_difference(p.one, p.other, values, quantity) for p in between]
    first = fields[engines[0]]
    places = first[first[quantity.variable].dims[0]].values
    return [
        Diagrams(engine, first.attrs["variant"], quantity, first.time.values, places, shown)
        for engine, shown in groups.items()
        if shown and any(d.values.any() for d in shown)
    ]


def _quantity(result: xr.Dataset) -> Quantity:
    """Return the largest of the stress and the components of shear; of rotation, where the wave
    strains no section."""
    peaks = {(q, c): peak for q in FORCES for c, peak in _peaks(result, q)}
    if not any(peak > 1e-9 for peak in peaks.values()) and "rotation" in result:
        peaks = {("rotation", c): peak for c, peak in _peaks(result, "rotation")}
    variable, component = max(peaks, key=lambda key: peaks[key])
    axis = "" if component is None else f" {('xz' if variable == 'shear' else 'xyz')[component]}"
    return Quantity(variable, component, f"{variable}{axis}")


def _peaks(result: xr.Dataset, variable: str) -> list[tuple[int | None, float]]:
    """Return the largest magnitude of each component of a variable, none where it is absent."""
    if variable not in result or not result[variable].size:
        return []
    values = np.abs(result[variable].values)
    if values.ndim == 2:
        return [(None, float(values.max()))]
    return list(enumerate(values.max(axis=(0, 1)).tolist()))


def _of_engine(engine: str, values: dict[str, np.ndarray], quantity: Quantity) -> list[Diagram]:
    """Return an engine's diagram and, with an exact solution, that and the difference."""
    exact = [pair.other for pair in referees(engine) if pair.other in values][:1]
    names = [engine, *exact]
    largest = max(float(np.abs(values[name]).max()) for name in names)
    unit = unit_for(UNITS[quantity.variable], largest)
    fields = [
        Diagram(name, unit.drawn(values[name]), unit, FIELD, largest / unit.size) for name in names
    ]
    return fields + [_difference(engine, other, values, quantity) for other in exact]


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
