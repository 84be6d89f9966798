"""One figure and its numbers."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from hashlib import sha256

import pandas as pd
from matplotlib.figure import Figure

from compare.figures.charts.chart import Chart
from compare.figures.charts.static import draw


@dataclass(frozen=True)
class SceneFigure:
    """A figure of a scene and its solutions, drawn on demand.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    contents and method in one or two sentences. drawing : draws it for print.
    table : the drawn data, tidy; columns carry their units, no index. folded : whether it is in a
    section of the page that is closed at first.
    """

    name: str
    title: str
    caption: str
    drawing: Callable[[], Figure]
    table: pd.DataFrame
    folded: bool = False

    @cached_property
    def figure(self) -> Figure:
        """The figure, drawn."""
        return self.drawing()

    @cached_property
    def numbers(self) -> str:
        """A hash of the table, which identifies the figure's numbers."""
        rows = pd.util.hash_pandas_object(self.table, index=False).values
        return sha256(f"{list(self.table)}".encode() + rows.tobytes()).hexdigest()


def chart_figure(
    name: str, title: str, caption: str, chart: Chart, table: pd.DataFrame, folded: bool = False
) -> SceneFigure:
    """Return the figure of a chart."""
    return SceneFigure(name, title, caption, partial(draw, name, chart), table, folded)
