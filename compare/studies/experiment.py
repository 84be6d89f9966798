"""A study: a grid of points, the row of readings of each, and their summary."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave.compare.engines import Progress
from jointwave.compare.figures.export import Drawn
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import Pool, Store, alone


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


@dataclass(frozen=True)
class Experiment:
    """A study: each of its points is measured once and saved, and the rows of all summarised.

    store : of the rows. measure : returns the row of a point, or several. summarise : writes the
    files of all rows. runs : returns the solutions that some points need. timed : only one such
    study runs on a machine at a time. shares : whether several processes may share the points.
    """

    title: str
    points: Sequence[Any]
    store: Store
    measure: Callable[[Any], Any]
    summarise: Callable[[list[Any]], Summary]
    runs: Callable[[Sequence[Any]], list[Run]] = lambda points: []
    timed: bool = False
    shares: bool = True

    def planned(self) -> list[Run]:
        """Return the runs of the points that are not saved yet."""
        return self.runs(self.store.missing(self.points))

    def rows(self, pool: Pool | None = None, progress: Progress | None = None) -> list[Any]:
        """Return the rows of all points, in their order."""
        with alone() if self.timed else nullcontext():
            own = pool if self.shares else None
            return self.store.compute(self.points, self.measure, own, progress)

    def make(self, pool: Pool | None = None, progress: Progress | None = None) -> Summary:
        """Run the study, write its files and return its summary."""
        return self.summarise(self.rows(pool, progress))
