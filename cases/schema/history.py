"""A recorded load history: a table of time (s) and end stress (Pa), or base motion, or a trace."""

import csv
import io
from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from warnings import catch_warnings, simplefilter

import numpy as np

from cases.files import beside, is_number, read_bytes, read_lines

LARGEST_FILE = 200_000_000  # bytes; some ten million samples
LARGEST = 1e30  # s, Pa; larger numbers are mistakes, and their squares overflow
TRACE = 16  # bytes of memory for each of a trace's: compressed samples, as two numbers
#: Formats of traces by the ends of their files' names, as ObsPy names them.
FORMATS = {".sac": "SAC", ".mseed": "MSEED", ".miniseed": "MSEED"}


@dataclass(frozen=True)
class History:
    """A piecewise linear load history, zero before its first and after its last sample.

    Attributes
    ----------
    time : float array [n], s, strictly increasing.
    stress : float array [n], Pa; m/s or m/s2 for the motion of a base.
    """

    time: np.ndarray
    stress: np.ndarray

    @classmethod
    def read(cls, folder: str | Path, file: str, anywhere: bool = False) -> "History":
        """Read `file`, relative to `folder`: SAC or miniSEED where its name ends so, else CSV.

        anywhere : whether it may lie outside `folder`. Raises ValueError, in one line, when there
        is nothing to read or it is not a history.
        """
        path = beside(folder, file, anywhere)
        form = FORMATS.get(path.suffix.lower())
        return cls._from_table(path) if form is None else cls._from_trace(path, form)

    @classmethod
    def _from_trace(cls, path: Path, form: str) -> "History":
        """Read the one trace of a file: its samples as they are, the first at t = 0."""
        content = read_bytes(path, LARGEST_FILE, TRACE)
        import obspy

        try:
            with catch_warnings():  # of how SAC rounds its steps
                simplefilter("ignore")
                traces = obspy.read(io.BytesIO(content), format=form)
        except Exception:  # of a dozen kinds, for a file that is no such one
            raise ValueError(f"cannot be read as {form}") from None
        if len(traces) != 1:
            raise ValueError(f"must contain one trace without gaps, has {len(traces)}")
        trace = traces[0]
        stress = np.asarray(trace.data, dtype=float)
        if stress.size < 2:
            raise ValueError("must contain at least two samples")
        if not (np.abs(stress) <= LARGEST).all():
            raise ValueError("must contain finite numbers up to 1e30")
        return cls(trace.stats.delta * np.arange(stress.size), stress)

    @classmethod
    def _from_table(cls, path: Path) -> "History":
        """Read two columns; text before the numbers is a header, # a comment."""
        numbers, rows = _rows(read_lines(path, LARGEST_FILE))
        if len(rows) < 2:
            raise ValueError("must contain at least two rows of time and load")
        wrong = ~(np.abs(rows) <= LARGEST).all(axis=1)
        if wrong.any():
            line = numbers[int(np.argmax(wrong))]
            raise ValueError(f"must contain finite numbers up to 1e30 (line {line} does not)")
        time, stress = rows.T
        if time[0] < 0:
            raise ValueError("must not start before t = 0")
        if (np.diff(time) <= 0).any():
            line = numbers[int(np.argmax(np.diff(time) <= 0)) + 1]
            raise ValueError(f"must have strictly increasing times (line {line} does not)")
        return cls(time, stress)


def _rows(lines: Iterable[tuple[int, str]]) -> tuple[array, np.ndarray]:
    """Return the line numbers and the rows [n, 2] with data."""
    numbers, rows = array("q"), array("d")
    for number, cells in _cells(lines):
        if not rows and not any(map(is_number, cells)):
            continue  # a header
        if len(cells) != 2 or not all(map(is_number, cells)):
            raise ValueError(
                f"must contain two numbers per line, time and load (line {number} does not)"
            )
        numbers.append(number)
        rows.extend(map(float, cells))
    return numbers, np.frombuffer(rows).reshape(-1, 2)


def _cells(lines: Iterable[tuple[int, str]]) -> Iterator[tuple[int, list[str]]]:
    for number, line in lines:
        if line.strip() and not line.lstrip().startswith("#"):
            try:
                yield number, next(csv.reader([line]))
            except csv.Error:
                raise ValueError(f"is not a CSV file (line {number})") from None
