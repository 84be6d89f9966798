"""One picture: for print, for the screen, and as numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from compare.figures.charts.chart import Chart
from compare.figures.charts.interactive import plot
from compare.figures.charts.static import draw


@dataclass(frozen=True)
class SceneFigure:
    """A picture of a scene and its solutions.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    what is seen and how it was computed, one or two sentences. static : for print. table : what is
    drawn, tidy; columns carry their units, no index. plot : the interactive figure of plotly.js,
    {"data": [...], "layout": {...}}, as plain values; None where the picture is static only.
    folded : whether it stands in a fold of the page, which is closed until it is opened.
    """

    name: str
    title: str
    caption: str
    static: Figure
    table: pd.DataFrame
    plot: dict[str, Any] | None = None
    folded: bool = False


def chart_figure(
    name: str, title: str, caption: str, chart: Chart, table: pd.DataFrame, folded: bool = False
) -> SceneFigure:
    """Return the picture of a chart, for print and for the screen."""
    return SceneFigure(name, title, caption, draw(name, chart), table, plot(chart), folded)
