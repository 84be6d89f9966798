"""The table of engineering measures of every solution's velocities."""

from math import isfinite

import pandas as pd

from compare.figures.tables import READINGS
from compare.report.tables import Table


def reading_table(frame: pd.DataFrame) -> Table:
    """Return the same as text, four digits each, a group a variant."""
    groups: dict[str, list[list[str]]] = {}
    for row in frame.to_dict("records"):
        numbers = (row[name] for name in READINGS)
        cells = [f"{x:.4g}" if isfinite(x) else "–" for x in numbers]
        groups.setdefault(row["variant"], []).append([row["solution"], row["at"], *cells])
    return Table(["solution", "at", *READINGS], groups)
