"""A recorded load history: a two-column CSV of time (s) and end stress (Pa), or base motion."""

import csv
from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cases.files import beside, is_number, read_lines

LARGEST_FILE = 200_000_000  # bytes; some ten million samples
LARGEST = 1e30  # s, Pa; what lies beyond is a mistake, and its squares overflow


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
    def from_csv(cls, folder: str | Path, file: str, anywhere: bool = False) -> "History":
        """Read `file`, relative to `folder`; text before the numbers is a header, # a comment.

        anywhere : whether it may lie outside `folder`. Raises ValueError, in one line, when there
        is nothing to read or it is not a history.
        """
        numbers, rows = _rows(read_lines(beside(folder, file, anywhere), LARGEST_FILE))
        if len(rows) < 2:
            raise ValueError("must hold at least two rows of time and load")
        wrong = ~(np.abs(rows) <= LARGEST).all(axis=1)
        if wrong.any():
            line = numbers[int(np.argmax(wrong))]
            raise ValueError(f"must hold finite numbers up to 1e30 (line {line} does not)")
        time, stress = rows.T
        if time[0] < 0:
            raise ValueError("must not start before t = 0, where every scene is at rest")
        if (np.diff(time) <= 0).any():
            line = numbers[int(np.argmax(np.diff(time) <= 0)) + 1]
            raise ValueError(f"must have strictly increasing times (line {line} does not)")
        return cls(time, stress)


def _rows(lines: Iterable[tuple[int, str]]) -> tuple[array, np.ndarray]:
    """Return the line numbers and the rows [n, 2] that hold data."""
    numbers, rows = array("q"), array("d")
    for number, cells in _cells(lines):
        if not rows and not any(map(is_number, cells)):
            continue  # a header
        if len(cells) != 2 or not all(map(is_number, cells)):
            raise ValueError(
                f"must hold two numbers a line, time and load (line {number} does not)"
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
