"""One figure of a scene and its numbers."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256

import pandas as pd
from matplotlib.figure import Figure


@dataclass(frozen=True)
class SceneFigure:
    """A figure of a scene and its solutions, drawn on demand.

    name : stem of its files, unique on the page ("fig-03-spectra"). title : a heading. caption :
    contents and method in one or two sentences. draw : draws it. table : the drawn data, tidy;
    columns carry their units, no index. folded : whether it is in a section of the page that is
    closed at first.
    """

    name: str
    title: str
    caption: str
    draw: Callable[[], Figure]
    table: pd.DataFrame
    folded: bool = False

    @cached_property
    def figure(self) -> Figure:
        """The figure, drawn."""
        return self.draw()

    @cached_property
    def numbers(self) -> str:
        """A hash of the table, which identifies the figure's numbers."""
        rows = pd.util.hash_pandas_object(self.table, index=False).values
        return sha256(f"{list(self.table)}".encode() + rows.tobytes()).hexdigest()
