"""A study: points, the rows measured at each, and their summary.

A point is saved as a JSON file whose name is a hash of everything that determines its rows,
including the program. An interrupted study thus resumes, and a changed one starts afresh.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave.compare.engines import Progress
from jointwave.compare.figures.export import Drawn
from jointwave.compare.runs.output import read_rows, write_text
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.store import DIED, Pool, alone, in_processes


class Summary(NamedTuple):
    """A study's summary for display.

    name : of its files, and of its section of the page. table : its numbers in display units; the
    index levels are a heading and the label of a row. sentences : its findings. failed : a line for
    each failed row. data : its rows and other numbers, machine-readable, see `facts`. note : a
    remark on the study. legend : of the table. about : for the caption of the figure: its contents,
    the quantity of its misfits, or its scenes. timed : whether it has seconds.
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
    """A study: each point is measured once and saved; then all rows are summarised.

    folder : of the saved rows; None: nothing is saved. key : returns the name of a point. measure :
    returns the row or rows of a point. summarise : writes the files and returns the summary. runs :
    returns the runs that some points need. timed : only one timed study runs on a machine at a
    time. shares : whether several processes may share the points. is_valid : whether saved rows are
    still valid. fresh : ignore saved rows. lost : returns the rows (not saved) of a point whose
    process has died; None: MemoryError is raised.
    """

    title: str
    points: Sequence[Any]
    folder: Path | None
    key: Callable[[Any], str]
    measure: Callable[[Any], Any]
    summarise: Callable[[list[Any]], Summary]
    runs: Callable[[Sequence[Any]], list[Run]] = lambda points: []
    timed: bool = False
    shares: bool = True
    is_valid: Callable[[Any], bool] = lambda rows: True
    fresh: bool = False
    lost: Callable[[Any], Any] | None = None

    def planned(self) -> list[Run]:
        """Return the runs of the points that are not saved yet."""
        return self.runs(self.missing())

    def make(self, pool: Pool | None = None, progress: Progress | None = None) -> Summary:
        """Run the study, write its files and return its summary."""
        return self.summarise(self.rows(pool, progress))

    def rows(self, pool: Pool | None = None, progress: Progress | None = None) -> list[Any]:
        """Return the rows of all points, in order; wait for other timed studies if timed."""
        with alone() if self.timed else nullcontext():
            return self.measured(pool if self.shares else None, progress)

    def measured(self, pool: Pool | None = None, progress: Progress | None = None) -> list[Any]:
        """Return the rows of all points; saved points are not measured again.

        pool : does the work; None: this process. Raises SceneError if a saved file is damaged.
        """
        named = {self.key(point): point for point in self.points}
        found = {name: rows for name in named if (rows := self._saved(name)) is not None}
        missing = {name: point for name, point in named.items() if name not in found}
        for name, rows in (pool or partial(in_processes, 1))(self.measure, missing):
            if rows is not None and self.folder is not None:
                write_text(self.folder / f"{name}.json", json.dumps(rows, indent=1))
            elif rows is None:
                if self.lost is None:
                    raise MemoryError(f"a point has no result: {DIED}")
                rows = self.lost(named[name])
            found[name] = rows
            if progress:
                progress(len(found) / len(named))
        return [found[self.key(point)] for point in self.points]

    def missing(self) -> list[Any]:
        """Return the points without saved rows."""
        return [point for point in self.points if self._saved(self.key(point)) is None]

    def _saved(self, name: str) -> Any:
        """Return the saved rows of a point; None if there are none, or if they are invalid."""
        path = self.folder and self.folder / f"{name}.json"
        if self.fresh or path is None or not path.is_file():
            return None
        found = read_rows(path)
        return found if self.is_valid(found) else None
