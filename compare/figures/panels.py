"""Contents of a figure's panels: at each receiver the component with the largest motion, minus its
static state; and the table of all their waveforms, as recorded.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import in_order
from jointwave.compare.figures.units import UNITS
from jointwave.compare.misfit.metrics import motion
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.places import Place, places_of, recorded
from jointwave.compare.misfit.ranking import finest
from jointwave.compare.misfit.weight import FAINT

FORCES, MOTION, ROTATION = ("stress", "shear"), ("velocity",), ("rotation",)
#: Quantities of panels at the receivers of a pillar, by their key of [record]: the first group that
#: moves; and at those of a rock mass: every component that moves.
OF_PILLAR = {"stress": (FORCES, ROTATION), "velocity": (MOTION, ROTATION)}
IN_PLANE = {"points": "velocity", "joints": "traction"}


class Panel(NamedTuple):
    """One panel: a place in one variant, the receiver-th of its quantity.

    component : the index of the one shown, None if the quantity has only one.
    """

    comparison: Comparison
    variant: str
    place: Place
    receiver: int
    component: int | None = None

    @property
    def quantity(self) -> str:
        """The quantity shown."""
        return self.place.quantity

    @property
    def heading(self) -> str:
        """Quantity, component and receiver, in words."""
        return self.place.heading

    @property
    def given(self) -> dict[str, pd.Series]:
        """External curves here: their own samples during the scene, by file."""
        along = not self.place.component and self.quantity in ("velocity", "displacement")
        place = self.place._replace(component="y") if along else self.place
        return {
            beside.curves.name: beside.series(place)
            for beside in self.comparison.besides
            if place in beside.curves.waveforms
        }

    @property
    def recorded(self) -> dict[str, pd.Series]:
        """Every waveform of the panel in SI over time in s, by its solution, in drawing order."""
        return {name: self._waveform(name, False) for name in self._names}

    @property
    def curves(self) -> dict[str, pd.Series]:
        """The waveforms minus their static state: the motion, which is drawn."""
        return {name: self._waveform(name, True) for name in self._names}

    @property
    def at_rest(self) -> float:
        """The static state subtracted from the first curve, SI; 0 if there is none."""
        first = self._names[0]
        return float((self._waveform(first, False) - self._waveform(first, True)).iloc[0])

    @property
    def reference(self) -> str:
        """The reference solution, "" if none resolves the scene."""
        found = finest(self._names, self.comparison.scene)
        return found.name if found else ""

    @property
    def residuals(self) -> dict[str, pd.Series]:
        """Each of `curves` minus that of the reference, which itself has no residual."""
        curves = self.curves
        if self.reference not in curves:
            return {}
        known = curves[self.reference]
        return {name: c - known for name, c in curves.items() if name != self.reference}

    @property
    def _names(self) -> list[str]:
        results = self.comparison.results
        return [name for name in in_order(results) if self.quantity in results[name]]

    def _waveform(self, name: str, moving: bool) -> pd.Series:
        result = self.comparison.results[name]
        found = motion(result, self.quantity) if moving else result[self.quantity].values
        values = found[self.receiver]
        values = values.ravel() if self.component is None else values[:, self.component]
        return pd.Series(values, np.round(result.time.values, 12))


def panels(comparisons: list[Comparison]) -> list[list[Panel]]:
    """Return the panels of every variant, one row each.

    For a spatial pillar each shows the largest component: of stress and shear, of velocity, and of
    rotation if nothing is displaced. For a rock mass there is one for each component of velocity at
    points, and of traction at joints, that is not faint compared with the other.
    """
    found = zip(comparisons, variant_names(comparisons), strict=True)
    return [[*_panels(comparison, name)] for comparison, name in found]


def _panels(comparison: Comparison, name: str) -> Iterator[Panel]:
    scene = comparison.scene
    for key, groups in OF_PILLAR.items():
        for i, at in enumerate(recorded(scene, key)):
            yield _panel(comparison, name, groups, i, at)
    for key, quantity in IN_PLANE.items():
        for i, at in enumerate(recorded(scene, key)):
            for component, word in _moving(comparison, quantity, i):
                yield Panel(comparison, name, Place(quantity, word, at), i, component)


def _moving(comparison: Comparison, quantity: str, receiver: int) -> list[tuple[int, str]]:
    """Return the components of a quantity that are not faint compared with the largest at a
    receiver, from the first solution that has it, with their names; the first without motion."""
    results = comparison.results
    result = next((results[n] for n in in_order(results) if quantity in results[n]), None)
    if result is None:
        return []
    peaks = np.abs(motion(result, quantity)[receiver]).max(axis=0)
    moving = (peaks > 0) & (peaks >= FAINT * peaks.max())
    names = places_of(result, quantity)[1]
    return [(int(k), names[k]) for k in np.flatnonzero(moving)] or [(0, names[0])]


def in_page(rows: list[list[Panel]]) -> list[list[Panel]]:
    """Return the panels of variants in rows of at most two; each variant begins a row."""
    return [row[i : i + 2] for row in rows for i in range(0, len(row), 2)]


def _panel(
    comparison: Comparison,
    name: str,
    groups: Sequence[tuple[str, ...]],
    receiver: int,
    at: tuple[float, ...],
) -> Panel:
    """Return the panel of the quantity and component with the largest peak at a receiver."""
    first = comparison.results[in_order(comparison.results)[0]]
    quantity, component = loudest(first, groups, receiver)
    place = Place(quantity, axis_of(quantity, component), at)
    return Panel(comparison, name, place, receiver, component)


def loudest(
    result: xr.Dataset,
    groups: Sequence[tuple[str, ...]],
    receiver: int | None = None,
    least: float = 0.0,
) -> tuple[str, int | None]:
    """Return the quantity and the component (None: its only one) with the largest peak, of the
    first group of quantities that moves; without motion, of the last one recorded.

    receiver : the only one considered; None: all. least : SI: smaller values count as no motion.
    """
    peaks: dict[tuple[str, int | None], float] = {}
    for group in groups:
        found = {(q, c): p for q in group for c, p in _peaks(result, q, receiver).items()}
        peaks = found or peaks
        if max(found.values(), default=0.0) > least:
            break
    return max(peaks, key=lambda key: peaks[key])


def _peaks(result: xr.Dataset, quantity: str, receiver: int | None) -> dict[int | None, float]:
    """Return the largest magnitude of the motion of every component; empty if not recorded."""
    if quantity not in result or not result[quantity].size:
        return {}
    values = np.abs(motion(result, quantity))[slice(None) if receiver is None else [receiver]]
    peaks = values.reshape(*values.shape[:2], -1).max(axis=(0, 1)).tolist()
    return dict(enumerate(peaks)) if len(peaks) > 1 else {None: peaks[0]}


def axis_of(quantity: str, component: int | None) -> str:
    """Return the name of a component, "" for the only one."""
    return "" if component is None else ("xz" if quantity == "shear" else "xyz")[component]


def variant_names(comparisons: list[Comparison]) -> list[str]:
    """Return the variants' names; the base scene is named by the keys that its variants change."""
    base, *variants = (comparison.scene for comparison in comparisons)
    names = [base.name or _base_name(base, variants), *(variant.name for variant in variants)]
    return [name.replace("zeta ", "ζ = ") for name in names]


def _base_name(base: AnyScene, variants: list[AnyScene]) -> str:
    if not isinstance(base, Scene):
        return "base scene"
    words, others = _words(base), [_words(variant) for variant in variants]
    changed = [word for key, word in words.items() if any(one[key] != word for one in others)]
    return ", ".join(changed) or ("base scene" if variants else words["damping"])


def _words(scene: Any) -> dict[str, str]:
    """Return what variants of pillars usually change, in words."""
    ratio = scene.joints.damping_ratio
    return {
        "damping": "undamped" if ratio is None else f"ζ = {ratio:g}",
        "start": f"{scene.ends.start} start",
        "end": scene.ends.end,
        "layers": "soft layer" if scene.soft_layers else "no soft layer",
        "tension": "no tension" if scene.joints.tension is False else "tension",
    }


def curve_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return every drawn waveform as recorded, including its static state, in SI: time first, one
    column per curve, its unit in the header.

    Variants may be sampled at different times; cells without a sample are empty.
    """
    columns = {}
    for row in panels(comparisons):
        for panel in row:
            unit = UNITS[panel.quantity]
            for name, curve in [*panel.recorded.items(), *panel.given.items()]:
                columns[f"{name} | {panel.heading} | {panel.variant} ({unit})"] = curve
    return pd.DataFrame(columns).rename_axis("time (s)")
