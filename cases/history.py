"""A recorded load history: a two-column CSV of time (s) and stress (Pa)."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class History:
    """A piecewise linear load history, zero before its first and after its last sample.

    Attributes
    ----------
    time : float array [n], s, strictly increasing.
    stress : float array [n], Pa.
    """

    time: np.ndarray
    stress: np.ndarray

    @classmethod
    def from_csv(cls, folder: str | Path, file: str) -> "History":
        """Read `file`, relative to `folder`; one header line is allowed, as are # comments.

        Raises ValueError, in one line, when there is nothing to read or it is not a history.
        """
        rows = list(_rows(Path(folder) / file))
        if len(rows) < 2:
            raise ValueError("must hold at least two rows of time (s), stress (Pa)")
        time, stress = np.array(rows, dtype=float).T
        if not np.isfinite([time, stress]).all():
            raise ValueError("must hold finite numbers only")
        if (np.diff(time) <= 0).any():
            row = int(np.argmax(np.diff(time) <= 0)) + 2
            raise ValueError(f"must have strictly increasing times (row {row} does not)")
        return cls(time, stress)


def _rows(path: Path):
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"cannot be read ({_reason(error)})") from None
    body = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    for number, row in enumerate(csv.reader(body), 1):
        try:
            time, stress = row
            yield float(time), float(stress)
        except ValueError:
            if number > 1:
                raise ValueError(f"must hold two numbers a row (row {number} does not)") from None


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or "not UTF-8 text"
