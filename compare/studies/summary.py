"""The summary of a study, the same for the terminal, the page and JSON."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave.compare.figures.export import Drawn


class Summary(NamedTuple):
    """A study's summary for display.

    name : of its files, and of its section of the page. table : its numbers in display units, with
    a heading of groups and the label of a row as the levels of its index. sentences : its findings.
    failed : a line for each row that failed. data : its rows and other numbers, machine-readable,
    see `facts`. note : about all of it.
    legend : of the table. about : for the caption of the figure: its contents, the quantity of its
    misfits, or its scenes. timed : whether it has seconds.
    """

    name: str
    title: str
    table: pd.DataFrame
    sentences: Sequence[str]
    failed: Sequence[str]
    files: Sequence[Path]
    data: Mapping[str, Any] = {}
    figure: Drawn | None = None
    note: str = ""
    legend: str = ""
    about: str = ""
    timed: bool = False

    @property
    def facts(self) -> dict[str, Any]:
        """The numbers, findings and files, machine-readable."""
        return {**self.data, "sentences": self.sentences, "files": list(map(str, self.files))}
