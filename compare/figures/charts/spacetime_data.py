"""Data of space-time diagrams: the motion along the pillar by an engine, and the differences
between engines or from exact solutions.
"""

from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from cases.schema.scene import Scene
from compare.engines import ENGINES
from compare.figures.style import DIFFERENCE, FIELD, in_order
from compare.figures.subplots import FORCES, MOTION, ROTATION, UNITS, axis_of, loudest
from compare.figures.units import Unit, unit_for
from compare.misfit.metrics import motion
from compare.misfit.pairs import pairs
from compare.misfit.ranking import own_exact

LEAST = 1e-9  # SI: smaller values count as no motion


class Quantity(NamedTuple):
    """The quantity drawn: a variable of the results, and its component (None: its only one)."""

    variable: str
    component: int | None

    @property
    def words(self) -> str:
        """Variable and component: "shear x"."""
        return f"{self.variable} {axis_of(*self)}".rstrip()

    def of(self, result: xr.Dataset) -> np.ndarray:
        """Return the motion [places, times] of a result, SI."""
        values = motion(result, self.variable)
        return values.reshape(*values.shape[:2], -1)[..., self.component or 0]


class Diagram(NamedTuple):
    """One diagram: its name, its values [places, times] in `unit`, the colours and the meaning of
    their ends; `share` : the largest difference over the largest value, else None.
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
            inner = self.values[1:-1]  # the ends' stress is that of the load
            least, most = (f"{x + 0.0:.4g}".replace("-", "−") for x in (inner.min(), inner.max()))
            return f"{self.name}\n({self.unit.name})\nbetween the ends {least} to {most}"
        one, other = self.name.split(" − ")
        share = f"at most {100 * self.share:.2g} % of the largest"
        return f"{one}\n− {other} ({self.unit.name})\n{share}"


class Diagrams(NamedTuple):
    """The diagrams of one figure of a variant over time [n] (s) and y [m] (m).

    exact : whether they are the differences of engines from the exact solutions of their models.
    """

    exact: bool
    quantity: Quantity
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
    engines = [name for name in in_order(set(fields)) if name in ENGINES]
    if not engines:
        return []
    first = fields[engines[0]]
    quantity = Quantity(*loudest(first, (FORCES, MOTION, ROTATION), least=LEAST))
    values = {name: quantity.of(result) for name, result in fields.items()}
    if not any(v.any() for v in values.values()):
        return []
    between = [p for p in pairs() if {p.one, p.other} <= set(engines)]
    shown = [_diagram(engines[0], values[engines[0]], quantity)]
    shown += [_difference(p.one, p.other, values, quantity) for p in between]
    own = {engine: own_exact(engine, fields, scene) for engine in engines}
    errors = [_difference(e, other, values, quantity) for e, other in own.items() if other]
    places = first[first[quantity.variable].dims[0]].values
    return [
        Diagrams(exact, quantity, first.time.values, places, found)
        for exact, found in ((False, shown), (True, errors))
        if found
    ]


def _difference(one: str, other: str, values: dict[str, np.ndarray], quantity: Quantity) -> Diagram:
    found = values[one] - values[other]
    scale = float(np.abs(values[other]).max())
    share = float(np.abs(found).max()) / scale if scale else 0.0
    return _diagram(f"{one} − {other}", found, quantity, share)


def _diagram(
    name: str, values: np.ndarray, quantity: Quantity, share: float | None = None
) -> Diagram:
    """Return the diagram of SI values; share : for a difference."""
    largest = float(np.abs(values).max())
    unit = unit_for(UNITS[quantity.variable], largest)
    colours = FIELD if share is None else DIFFERENCE
    return Diagram(name, unit.drawn(values), unit, colours, largest / unit.size, share)
