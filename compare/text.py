"""Numbers as text, the same on the terminal and on the page."""

from collections.abc import Callable, Iterable
from math import isfinite
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

NONE = "–"  # in place of a missing number


def percent(x: float, digits: int = 3) -> str:
    """Return a ratio in percent to some digits, or "< 0.001"."""
    if not isfinite(x):
        return NONE
    if 0 < x < 1e-5:
        return "< 0.001"
    return f"{100 * x:#.{digits}g}".rstrip(".")


def mean_and_worst(peak: Any) -> str:
    """Return a `PeakDifference` in percent, the mean and the worst receiver; "" for None."""
    both = (f"{float(f'{100 * x:.2g}'):g}" for x in (peak.mean, peak.worst)) if peak else ()
    return ", ≤ ".join(both)


def in_seconds(x: float) -> str:
    """Return a time to two digits in a suitable unit."""
    units = {"h": 3600, "min": 60, "s": 1, "ms": 1e-3}
    unit = next((unit for unit, length in units.items() if x >= length), "µs")
    shown = x / units.get(unit, 1e-6)
    return f"{shown:.0f} {unit}" if shown >= 10 else f"{shown:.2g} {unit}"


def times(x: float) -> str:
    """Return a ratio such as "15×"."""
    return f"{x:.0f}×" if x >= 9.95 else f"{x:.1f}×"


def table_cell(value: Any, column: str) -> str:
    """Return a cell of a table as text; numbers under a heading with "%" are in percent."""
    if "%" in column and isinstance(value, float):
        return percent(value / 100)
    return cell(value)


def cell(value: Any) -> str:
    """Return a table value as text: whole numbers and text unchanged, others to four digits."""
    if isinstance(value, float):
        if not isfinite(value):
            return NONE
        return f"{value:.0f}" if value.is_integer() and abs(value) < 1e9 else f"{value:.4g}"
    return str(value)


def grouped(table: "pd.DataFrame") -> "pd.DataFrame":
    """Return a table with equal outermost row labels together, if it has several levels of them."""
    if table.index.nlevels == 1:
        return table
    return table.iloc[table.index.get_level_values(0).factorize()[0].argsort(kind="stable")]


def span(values: Iterable[float], write: Callable[[float], str] = "{:.3g}".format) -> str:
    """Return the range of some numbers, "1 to 3", or one number if both ends read the same."""
    ordered = sorted(values)
    return " to ".join(dict.fromkeys(write(x) for x in (ordered[0], ordered[-1])))
