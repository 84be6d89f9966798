"""Panels with the waveforms of all solutions at each receiver of each variant."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.compare.engines import in_order
from jointwave.compare.figures.style import UNITS
from jointwave.compare.misfit.metrics import motion
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.places import Place, places_of, recorded
from jointwave.compare.misfit.ranking import finest
from jointwave.compare.misfit.weight import FAINT

FORCES, MOTION, ROTATION = ("stress", "shear"), ("velocity",), ("rotation",)
#: Groups of quantities for each key of [record]; the first group that moves is shown.
SHOWN = {
    "stress": (FORCES,),
    "velocity": (MOTION, ROTATION),
    "points": (MOTION,),
    "joints": (("traction",),),
}


class Panel(NamedTuple):
    """The waveforms, SI over time (s), at one place in one variant.

    recorded, curves : of every solution, a column each, with and without its static state. given :
    external curves by file, at their own times. reference : the solution from which residuals are
    taken, "" if none resolves the scene.
    """

    comparison: Comparison
    variant: str
    place: Place
    recorded: pd.DataFrame
    curves: pd.DataFrame
    given: dict[str, pd.Series]
    reference: str

    @property
    def heading(self) -> str:
        """The place and the variant in words."""
        return f"{self.place.heading}, {self.variant}".removesuffix(", ")

    @property
    def unit(self) -> str:
        """The SI unit of the waveforms."""
        return UNITS[self.place.quantity]

    def column(self, name: str, per: str = "") -> str:
        """Return the header of a curve in a table; per : appended to its unit, such as "/Hz"."""
        curve = " | ".join(filter(None, (name, self.place.heading, self.variant)))
        return f"{curve} ({self.unit}{per})"

    @property
    def at_rest(self) -> float:
        """The static state subtracted from the first curve, SI; 0 if there is none."""
        return float(self.recorded.iloc[0, 0] - self.curves.iloc[0, 0])

    @property
    def residuals(self) -> pd.DataFrame:
        """Each of `curves`, except the reference, minus the reference; empty without one."""
        if self.reference not in self.curves:
            return pd.DataFrame()
        rest = self.curves.drop(columns=self.reference)
        return rest.sub(self.curves[self.reference], axis="index")

    @property
    def largest_residual(self) -> float:
        """The largest residual over the largest value; 0 without a reference or motion."""
        rest, peak = self.residuals.abs().max().max(), self.curves.abs().max().max()
        return float(rest / peak) if rest > 0 else 0.0


def variant_names(comparisons: list[Comparison]) -> list[str]:
    """Return the variants' names; an unnamed base scene is named by the settings that its variants
    change if `_words` knows them, else "base scene"."""
    base, *variants = (comparison.scene for comparison in comparisons)
    changed: list[str] = []
    if base.is_column:
        words, others = _words(base), [_words(variant) for variant in variants]
        changed = [word for key, word in words.items() if any(one[key] != word for one in others)]
    first = base.name or ", ".join(changed) or "base scene"
    return [name.replace("zeta ", "ζ = ") for name in (first, *(one.name for one in variants))]


def named(comparisons: list[Comparison]) -> list[tuple[str, Comparison]]:
    """Return the comparisons, each with the name of its variant."""
    return list(zip(variant_names(comparisons), comparisons, strict=True))


def _words(scene: Any) -> dict[str, str]:
    """Return the settings that variants of pillars usually change, in words."""
    ratio = scene.joints.damping_ratio
    return {
        "damping": "undamped" if ratio is None else f"ζ = {ratio:g}",
        "start": f"{scene.ends.start} start",
        "end": scene.ends.end,
        "layers": "soft layer" if scene.soft_layers else "no soft layer",
        "tension": "no tension" if scene.joints.tension is False else "tension",
    }


def panels(comparisons: list[Comparison]) -> list[list[Panel]]:
    """Return the panels of every variant, one list each.

    Each receiver has a panel for every component that is not faint against the largest: of stress
    and shear; of velocity, or rotation if nothing translates; of traction at joints.
    """
    is_alone = len(comparisons) == 1  # a single variant keeps its own name
    names = [comparisons[0].scene.name] if is_alone else variant_names(comparisons)
    return [[*_panels(one, name)] for one, name in zip(comparisons, names, strict=True)]


def in_rows(comparisons: list[Comparison], across: int = 2) -> list[list[Panel]]:
    """Return the panels in rows of at most `across`; each variant starts a new row."""
    rows = panels(comparisons)
    return [row[i : i + across] for row in rows for i in range(0, len(row), across)]


def _panels(comparison: Comparison, variant: str) -> Iterator[Panel]:
    results = {name: comparison.results[name] for name in in_order(comparison.results)}
    motions = {name: motion(one) for name, one in results.items()}
    for key, groups in SHOWN.items():
        for i, at in enumerate(recorded(comparison.scene, key)):
            found = peaks([*results.values()], groups, i)
            largest = max(found.values(), default=0.0)
            moving = [one for one, peak in found.items() if peak >= FAINT * largest]
            for quantity, component in moving if largest else moving[:1]:
                place = Place(quantity, component, at)
                frames = _frame(results, place), _frame(motions, place)
                given = {
                    beside.curves.name: beside.series(own)
                    for beside in comparison.besides
                    for own in beside.curves.waveforms
                    if place.is_at(own)
                }
                known = finest(frames[0], comparison.scene)
                yield Panel(comparison, variant, place, *frames, given, known.name if known else "")


def _frame(results: dict[str, xr.Dataset], place: Place) -> pd.DataFrame:
    """Return the waveforms of results at a place, a column each over time (s)."""
    waves = {name: place.waveform(one) for name, one in results.items()}
    times = {name: np.round(one.time.values, 12) for name, one in results.items()}
    return pd.DataFrame({n: pd.Series(w, times[n]) for n, w in waves.items() if w is not None})


def by_component(result: xr.Dataset, quantity: str) -> dict[str, np.ndarray]:
    """Return the motion of a quantity [place, time] by component, "" for the only one."""
    values, names = motion(result[[quantity]])[quantity].values, places_of(result, quantity)[1]
    values = values.reshape(*values.shape[:2], -1)
    return {name if len(names) > 1 else "": values[..., k] for k, name in enumerate(names)}


def peaks(
    results: Sequence[xr.Dataset],
    groups: Sequence[tuple[str, ...]],
    receiver: int | slice = slice(None),
    least: float = 0.0,
) -> dict[tuple[str, str], float]:
    """Return the largest magnitude, SI, by quantity and component, of the first group of quantities
    that moves; if none moves, of the last recorded group.

    results : the first that has a quantity counts. least : smaller values count as no motion.
    """
    found: dict[tuple[str, str], float] = {}
    for group in groups:
        here: dict[tuple[str, str], float] = {}
        for quantity in group:
            result = next((r for r in results if quantity in r and r[quantity].size), None)
            waves = {} if result is None else by_component(result, quantity)
            here |= {(quantity, c): float(np.abs(w[receiver]).max()) for c, w in waves.items()}
        found = here or found
        if max(here.values(), default=0.0) > least:
            break
    return found


def curve_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return every drawn waveform as recorded, with its static state, in SI: time first, then a
    column per curve with its unit in the header. Cells without a sample are empty."""
    columns = {
        panel.column(str(name)): curve
        for row in panels(comparisons)
        for panel in row
        for name, curve in [*panel.recorded.items(), *panel.given.items()]
    }
    return table_of(columns, "time (s)")


def table_of(columns: Any, index: str) -> pd.DataFrame:
    """Return a table of curves by header; its first column is their common index, named `index`."""
    return pd.DataFrame(columns).rename_axis(index).reset_index()
