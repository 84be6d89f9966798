"""One figure: for print, for the screen, and as numbers."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from hashlib import sha256
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from compare.figures.charts.chart import Chart
from compare.figures.charts.interactive import plot
from compare.figures.charts.static import draw


@dataclass(frozen=True)
class SceneFigure:
    """A figure of a scene and its solutions, drawn on demand.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    contents and method in one or two sentences. drawing : draws it for print.
    table : the drawn data, tidy; columns carry their units, no index. plotting : returns the
    interactive figure; None if there is only a static one. folded : whether it is in a section of
    the page that is closed at first.
    """

    name: str
    title: str
    caption: str
    drawing: Callable[[], Figure]
    table: pd.DataFrame
    plotting: Callable[[], dict[str, Any]] | None = None
    folded: bool = False

    @cached_property
    def static(self) -> Figure:
        """The figure for print."""
        return self.drawing()

    @cached_property
    def plot(self) -> dict[str, Any] | None:
        """The interactive figure, {"data": [...], "layout": {...}}, as plain values."""
        return self.plotting() if self.plotting else None

    @cached_property
    def numbers(self) -> str:
        """A hash of the table, which identifies the figure's numbers."""
        rows = pd.util.hash_pandas_object(self.table, index=False).values
        return sha256(f"{list(self.table)}".encode() + rows.tobytes()).hexdigest()


def chart_figure(
    name: str, title: str, caption: str, chart: Chart, table: pd.DataFrame, folded: bool = False
) -> SceneFigure:
    """Return the figure of a chart, for print and for the screen."""
    drawing, plotting = partial(draw, name, chart), partial(plot, chart)
    return SceneFigure(name, title, caption, drawing, table, plotting, folded)
