"""One picture: for print, for the screen, and as numbers."""

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
    """A picture of a scene and its solutions, drawn when it is asked for.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    what is seen and how it was computed, one or two sentences. drawing : makes it for print.
    table : what is drawn, tidy; columns carry their units, no index. plotting : makes the
    interactive figure; None where the picture is static only. folded : whether it stands in a fold
    of the page, which is closed until it is opened.
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
        """The picture for print."""
        return self.drawing()

    @cached_property
    def plot(self) -> dict[str, Any] | None:
        """The interactive figure, {"data": [...], "layout": {...}}, as plain values."""
        return self.plotting() if self.plotting else None

    @cached_property
    def numbers(self) -> str:
        """What no picture of other numbers has: a hash of the table."""
        rows = pd.util.hash_pandas_object(self.table, index=False).values
        return sha256(f"{list(self.table)}".encode() + rows.tobytes()).hexdigest()


def chart_figure(
    name: str, title: str, caption: str, chart: Chart, table: pd.DataFrame, folded: bool = False
) -> SceneFigure:
    """Return the picture of a chart, for print and for the screen."""
    drawing, plotting = partial(draw, name, chart), partial(plot, chart)
    return SceneFigure(name, title, caption, drawing, table, plotting, folded)
