"""One picture: for print, for the screen, and as numbers."""

from dataclasses import dataclass
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

#: What a picture can show, in the order of the page.
KINDS = ("scene", "waveforms", "space-time", "spectra", "energy")


@dataclass(frozen=True)
class SceneFigure:
    """A picture of a scene and its solutions.

    name : stem of its files, unique on the page ("fig-03-spectra"). kind : one of KINDS.
    title : a heading. caption : what is seen and how it was computed, one or two sentences.
    static : for print. table : what is drawn, tidy; columns carry their units, no index.
    plot : the interactive figure of plotly.js, {"data": [...], "layout": {...}}, as plain values
    that json can write; None where the picture is static only. folded : whether it stands in a
    fold of the page, which is closed until it is opened, and on paper.
    """

    name: str
    kind: str
    title: str
    caption: str
    static: Figure
    table: pd.DataFrame
    plot: dict[str, Any] | None
    folded: bool = False
