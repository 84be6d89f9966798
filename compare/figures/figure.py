"""One figure of a scene and its numbers."""

from dataclasses import dataclass

import pandas as pd
from matplotlib.figure import Figure


@dataclass(frozen=True)
class SceneFigure:
    """A figure of a scene and its solutions.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    contents and method in one or two sentences. table : the drawn data, tidy; columns carry their
    units, no index. folded : whether it is in a section of the page that is closed at first.
    """

    name: str
    title: str
    caption: str
    figure: Figure
    table: pd.DataFrame
    folded: bool = False
