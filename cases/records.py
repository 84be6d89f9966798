"""External records: columns of numbers over one time, from a text table or a seismogram.

The only reader of load files, curves for comparison and recorders. The content of a file, not its
name, decides its format.

A table has a semicolon, tab, comma or blanks between cells, decimal points or commas, and comments
after #. The last line before the numbers, comments included, with one cell per column names the
columns, each with its unit (`cases.units`), or with a row of units below.
"""

import csv
import io
import re
from codecs import getincrementaldecoder
from collections.abc import Callable
from math import isnan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import printable
from jointwave.cases.files import is_number, read_bytes
from jointwave.cases.histories import Recorded
from jointwave.cases.seismogram import FORMATS, format_of, read_traces
from jointwave.cases.units import KNOWN, TIME, split_unit, units_of

LARGEST_FILE = 200_000_000  # bytes; some ten million samples
SPREAD = 16  # bytes of memory per byte of a file: `0,0` makes two numbers; samples are compressed
LARGEST = 1e30  # larger numbers are mistakes, and their squares overflow
HEAD = 100_000  # bytes within which the numbers of a table must begin
SEPARATORS = (";", "\t", ",", " ")
COMMENT = re.compile(r"^\s*#|#(?=\s|$)")  # before the numbers, where names may contain #
BRACKETED = re.compile(r"[\[(]([^\[\]()]*)[\])]")
DIMENSIONLESS = ("-", "1", "counts")  # allowed for a load, whose amplitude has the unit


class Column(NamedTuple):
    """One column [n] in the file's unit; NaN for an empty cell, unit "" for none."""

    name: str
    unit: str
    values: np.ndarray

    def si(self, units: dict[str, float]) -> np.ndarray:
        """Return the values in SI. Raises ValueError for a unit that is not in `units`."""
        if self.unit and self.unit not in units:
            allowed = f"must be {', '.join(units)}"
            raise ValueError(f"unit of {self.name} = {self.unit!r}: {allowed}")
        return units.get(self.unit, 1.0) * self.values


class Columns(NamedTuple):
    """The columns of a file over one time."""

    time: Column
    rest: list[Column]


Where = Callable[[int], str]  #: names the place of a sample in a file


def read_history(path: Path, quantity: str, in_space: bool = False) -> Recorded:
    """Return a load history from a file in SI; its quantity, in the plane or in space, sets the
    units. Raises ValueError, in one line, if the file does not hold a history."""
    time, rest = read_columns(path, gaps=False, begins=False)
    if len(rest) != 1:
        names = _listed([one.name for one in (time, *rest)])
        raise ValueError(f"must hold two columns, time and load, not {1 + len(rest)}: {names}")
    seconds, (load,) = time.si(TIME), rest
    if seconds[0] < 0:
        raise ValueError(f"must not start before t = 0, at {seconds[0]:g} s")
    if load.unit in DIMENSIONLESS:
        load = load._replace(unit="")
    sign = -1.0 if load.name.startswith("-") else 1.0
    return Recorded(seconds, sign * load.si(units_of(quantity, in_space)), bool(time.unit))


def read_columns(
    path: Path, time_name: str = "time", least: int = 2, gaps: bool = True, begins: bool = True
) -> Columns:
    """Return the columns of a text table or a seismogram.

    time_name : header of the times; "time" also accepts "t", or the first of two columns. least :
    number of samples. gaps : whether cells may be empty. begins : whether a seismogram begins at
    its own clock's time, else at t = 0. Raises ValueError, in one phrase with line and value.
    """
    content = read_bytes(path, LARGEST_FILE, SPREAD)
    where: Where
    try:
        if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
            content = content.decode("utf-16").encode()
        if b"\0" in content:
            if not (form := format_of(content)):
                line = content[: content.index(b"\0")].count(b"\n") + 1
                allowed = f"nor a seismogram in {', '.join(FORMATS)}"
                raise ValueError(f"is neither text (line {line} holds a NUL byte) {allowed}")
            seconds, traces = read_traces(content, form)
            rest = [Column(printable(name), "", values) for name, values in traces.items()]
            seconds -= 0.0 if begins else seconds[0]
            found, where = Columns(Column("time", "s", seconds), rest), "sample {}".format
            gaps = False
        else:
            text = content.removeprefix(b"\xef\xbb\xbf")
            text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
            found, where = _of_text(text, split_unit(time_name)[0].lower())
    except UnicodeDecodeError:
        raise ValueError("is not UTF-8 text") from None
    require_series(found, where, least, gaps)
    return found


def require_series(columns: Columns, where: Where, least: int, gaps: bool = False) -> None:
    """Raise ValueError, in one phrase, unless times increase and all numbers are finite."""
    time = columns.time.values
    if len(time) < least:
        raise ValueError(f"must hold at least {least} samples, not {len(time)}")
    for name, _, values in (columns.time, *columns.rest):
        wrong = ~(np.abs(values) <= LARGEST)
        if gaps and values is not time:
            wrong &= ~np.isnan(values)
        if wrong.any():
            i = int(np.argmax(wrong))
            value = "nan or empty" if np.isnan(values[i]) else f"{values[i]:.12g}"
            allowed = "must be a finite number of at most 1e30"
            raise ValueError(f"{where(i)}: {name or 'value'} = {value}: {allowed}")
    late = np.diff(time) <= 0
    if late.any():
        i = int(np.argmax(late))
        fault = "is repeated; each time must be" if time[i] == time[i + 1] else "must be"
        allowed = f"{fault} later than the one before it, {time[i]:.12g}"
        raise ValueError(f"{where(i + 1)}: time = {time[i + 1]:.12g}: {allowed}")


def _of_text(content: bytes, time_name: str) -> tuple[Columns, Where]:
    import pandas as pd

    head = getincrementaldecoder("utf-8")().decode(content[:HEAD]).split("\n")
    first, separator, cells = _first_row(head)
    if first + 1 >= len(head) and len(content) > HEAD:
        raise ValueError(f"line {len(head)} is longer than {HEAD:,} characters, or a header is")
    if not cells:
        last = next((line for line in reversed(head) if line.strip()), "")
        raise ValueError(f"must hold rows of two or more numbers, unlike {last[:60]!r}")
    names, units = _header(head[:first], separator, cells, time_name)
    data = re.sub(rb"#[^\n]*", b"", content.split(b"\n", first)[-1])
    # As Python reads numbers; pandas 3.1 always does, and is to lose the keyword.
    older = tuple(map(int, pd.__version__.split(".")[:2])) < (3, 1)
    exact: dict[str, Any] = {"float_precision": "round_trip"} if older else {}
    decimal = "," if separator != "," and data.count(b",") > data.count(b".") else "."
    try:
        frame = pd.read_csv(
            io.BytesIO(data),
            sep=r"\s+" if separator == " " else separator,
            decimal=decimal,
            header=None,
            index_col=False,
            dtype=float,
            **exact,
            keep_default_na=False,
            na_values=[""],
            skipinitialspace=True,
            skip_blank_lines=False,  # so that rows count lines
        ).dropna(how="all")
        sound = frame.shape[1] == len(names) and not frame.iloc[:, -1].isna().any()
        sound &= decimal == "." or b"." not in data
        fault = "" if sound else _fault(data, first + 1, separator, decimal, names)
    except ValueError:
        fault = _fault(data, first + 1, separator, decimal, names) or "is not a table of numbers"
    if fault:
        raise ValueError(fault)
    columns = [
        Column(*((name.strip(), unit) if unit else split_unit(name)), frame[i].to_numpy())
        for i, (name, unit) in enumerate(zip(names, units, strict=True))
    ]
    if len(columns) > 2:  # without the empty column of a separator at the end of each line
        columns = [one for one in columns if one.name or not np.isnan(one.values).all()]
    only = len(columns) == 2 and time_name == "time"
    at = _times([one.name for one in columns], time_name) or [0] * only
    if len(at) != 1:
        mark = f"FILE:{names[0][:60]}=time marks this one as time"
        raise ValueError(f"header = {_listed(names)!r}: must name one column {time_name}; {mark}")
    time, lines = columns.pop(at[0]), frame.index.to_numpy() + first + 1
    return Columns(time, columns), lambda i: f"line {lines[i]}"


def _first_row(lines: list[str]) -> tuple[int, str, list[str]]:
    """Return the index of the first row of numbers, its separator, and its cells."""
    for i, line in enumerate(lines):
        for separator in SEPARATORS:
            cells = _cells(line.partition("#")[0], separator)
            filled = [cell.replace(",", ".") for cell in cells if cell]
            if len(cells) > 1 and filled and all(map(is_number, filled)):
                return i, separator, cells
    return len(lines), "", []


def _cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line, unsplit in brackets, receiver places and units after a comma."""
    if separator == " ":
        parts = re.split(r"(?<!,)\s+(?![\[(])", line.strip())
    else:
        try:
            row = csv.reader([line.strip(" ")], delimiter=separator, skipinitialspace=True)
            parts = next(row, [])
        except csv.Error:
            raise ValueError(f"is not a table: {line[:60]!r}") from None
    found: list[str] = []
    for part in parts:
        if found and found[-1].count("[") > found[-1].count("]"):
            found[-1] += separator.strip(" ") + part
        else:
            found.append(part)
    return [printable(cell).strip() for cell in found]


def _header(
    before: list[str], separator: str, cells: list[str], time_name: str
) -> tuple[list[str], list[str]]:
    """Return the headers of the columns, and the units in a row below them, "" for none."""
    size, below = len(cells), list[tuple[int, list[str]]]()
    none = [""] * size
    for number, line in reversed(list(enumerate(before, 1))):
        said = COMMENT.match(line)
        text = line[said.end() :] if said else COMMENT.split(line, maxsplit=1)[0]
        row = _row_of(text, separator, size, time_name)
        if len(row) == size and _times(row, time_name):
            return row, _units_of(*below[0]) if below else none
        if not said and _times(row, time_name):
            allowed = f"must hold {len(row)} numbers ({_listed(row)}), not {size}"
            raise ValueError(f"line {len(before) + 1}: {allowed}")
        if not said and len(row) == size:
            below.append((number, row))
    named = [row for _, row in below if not any(map(is_number, row))]
    if below:
        number, row = below[0]
        bare = [cell.strip("[]() ") for cell in row if cell]
        if not set(bare).isdisjoint(TIME) or all(one in KNOWN for one in bare):
            named, none = named[1:], _units_of(number, row)
        elif is_number(row[0].replace(",", ".")):
            _units_of(number, row)
    if named:
        return named[0], none
    for number, line in enumerate(before, 1):
        stray = [one for one in BRACKETED.findall(line) if KNOWN.get(one, 1.0) != 1.0]
        if stray and not any(none):
            allowed = f"is no header of {size} columns, so that its unit {stray[0]} has no column"
            raise ValueError(f"line {number} {allowed}")
    names = ["time", *map(str, range(2, size + 1))]
    if size == 2 or not cells[-1]:
        names[-1] = ""
    return names, none


def _units_of(number: int, row: list[str]) -> list[str]:
    """Return the units in a row below the header. Raises ValueError for an unknown unit."""
    units = [cell.strip("[]() ") for cell in row]
    for one in filter(None, units):
        if one not in (*KNOWN, *DIMENSIONLESS) and not is_number(one.replace(",", ".")):
            raise ValueError(f"line {number}: {one[:60]!r} is neither a number nor a known unit")
    return units


def _row_of(text: str, separator: str, size: int, time_name: str) -> list[str]:
    """Return the cells of a line before the numbers, split at the given separator, or at another if
    only this gives a header of the given size."""
    rows = [_cells(text, one) for one in (separator, *SEPARATORS)]
    for i, row in enumerate(rows):
        if len(row) == 2 * size and all(cell in KNOWN for cell in row[1::2]):  # time, s, load, Pa
            row = [f"{name}, {unit}" for name, unit in zip(row[::2], row[1::2], strict=True)]
        if len(row) == size and (i == 0 or _times(row, time_name)):
            return row
    return rows[0]


def _times(names: list[str], time_name: str) -> list[int]:
    """Return the indices of columns named as times."""
    bare = [split_unit(name)[0].lower() for name in names]
    found = [i for i, name in enumerate(bare) if name == time_name]
    return found or [i for i, name in enumerate(bare) if (name, time_name) == ("t", "time")]


def _fault(data: bytes, first: int, separator: str, decimal: str, names: list[str]) -> str:
    """Return the error in the first row that is not numbers; "" if all rows are."""
    for number, line in enumerate(io.BytesIO(data), first):
        cells = _cells(line.decode(errors="replace").rstrip("\n"), separator)
        if len(cells) != len(names) and (any(cells) or len(cells) > len(names)):
            columns = _listed(names) if names[-1] else "time and value, without a header"
            return f"line {number}: must hold {len(names)} numbers ({columns}), not {len(cells)}"
        for name, cell in zip(names, cells, strict=False):
            text = cell if decimal == "." else cell.replace(".", "?").replace(",", ".")
            if cell and not (is_number(text) and not isnan(float(text))):
                mark = "point" if decimal == "." else "comma"
                allowed = f"must be a number, with a decimal {mark}"
                return f"line {number}: {name or 'value'} = {cell[:60]!r}: {allowed}"
    return ""


def _listed(names: list[str]) -> str:
    text = ", ".join(names)
    return text if len(text) <= 200 else f"{text[:200]}..."
