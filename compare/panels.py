"""What the panels of a figure show, and the table of every curve that is drawn in them."""

from typing import NamedTuple

import numpy as np
import pandas as pd

from cases.scene import Scene
from compare.pairs import Comparison
from compare.style import in_order


class Panel(NamedTuple):
    """One panel: the receiver-th place (at y, m) of a quantity in one variant."""

    comparison: Comparison
    variant: str
    quantity: str
    receiver: int
    y: float

    @property
    def place(self) -> str:
        """Quantity and receiver, in words."""
        return f"{self.quantity} at y = {self.y:g} m"

    @property
    def curves(self) -> dict[str, pd.Series]:
        """Every waveform of the panel in SI over time in s, by its solution, in drawing order."""
        curves = {}
        for name in in_order(set(self.comparison.results)):
            result = self.comparison.results[name]
            values = result[self.quantity].values[self.receiver].ravel()
            curves[name] = pd.Series(values, np.round(result.time.values, 12))
        return curves


def panels(comparisons: list[Comparison]) -> list[list[Panel]]:
    """Return the grid of panels: variants down and receivers across, or receivers down."""
    rows = []
    for comparison, name in zip(comparisons, variant_names(comparisons), strict=True):
        record = comparison.scene.record
        stress = [Panel(comparison, name, "stress", i, y) for i, y in enumerate(record.stress)]
        speed = [Panel(comparison, name, "velocity", i, y) for i, y in enumerate(record.velocity)]
        rows.append(stress + speed)
    if len(rows) == 1 and len(rows[0]) > 2:
        return [[panel] for panel in rows[0]]
    return rows


def variant_names(comparisons: list[Comparison]) -> list[str]:
    """Return the variants' names; the scene itself is named by what its variants change."""
    base, *variants = (comparison.scene for comparison in comparisons)
    names = [base.name or _base_name(base, variants), *(variant.name for variant in variants)]
    return [name.replace("zeta ", "ζ = ") for name in names]


def _base_name(base: Scene, variants: list[Scene]) -> str:
    ratio = base.joints.damping_ratio
    words = {
        "damping": "undamped" if ratio is None else f"ζ = {ratio:g}",
        "start": f"{base.ends.start} start",
        "end": base.ends.end,
        "layers": "soft layer" if base.soft_layers else "no soft layer",
        "tension": "no tension" if base.joints.tension is False else "tension",
    }
    changed = {key for v in variants for key in words if _part(v, key) != _part(base, key)}
    return ", ".join(words[key] for key in words if key in changed) or words["damping"]


def _part(scene: Scene, key: str) -> object:
    return {
        "damping": scene.joints.damping_ratio,
        "start": scene.ends.start,
        "end": scene.ends.end,
        "layers": len(scene.soft_layers),
        "tension": scene.joints.tension is not False,
    }[key]


def curve_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return every drawn curve in SI: time first, one column a curve, its unit in the header.

    Variants may be sampled at different times; where one has no sample its cell is empty.
    """
    columns = {}
    for row in panels(comparisons):
        for panel in row:
            unit = "Pa" if panel.quantity == "stress" else "m/s"
            for name, curve in panel.curves.items():
                columns[f"{name} | {panel.place} | {panel.variant} ({unit})"] = curve
    return pd.DataFrame(columns).rename_axis("time (s)")
