"""Files of external waveforms: CSV or NetCDF as named columns over time."""

import csv
import re
from array import array
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from cases.errors import SceneError, printable
from cases.files import is_number, read_lines
from cases.schema.history import LARGEST, LARGEST_FILE
from compare.misfit.places import COMPONENT_DIMENSIONS, QUANTITIES
from results.labels import RECEIVERS
from results.netcdf import load_netcdf

LEAST_SAMPLES = 3  # needed for a parabola through the peak of a correlation
NUMBER = re.compile(r"\s*[-+.\d]")  # a line that begins like this is not a header
HEADER_COMMENT = r"^\s*#|#(?=\s|$)"
NETCDF = (".nc", ".nc3", ".nc4", ".netcdf", ".cdf")


class Column(NamedTuple):
    """The numbers of one column [n] in the file's unit; unit is empty if the file has none.

    empty : mask [n] of missing numbers, nan in `values`; None if none is missing.
    """

    name: str
    unit: str
    values: np.ndarray
    empty: np.ndarray | None = None


class Columns(NamedTuple):
    """A file's columns over one time; `row` locates sample i in the file."""

    time: Column
    rest: list[Column]
    row: Callable[[int], str]


def read_columns(path: Path, time_name: str = "time") -> Columns:
    """Return the columns of a NetCDF file, known by its suffix, or of a CSV file.

    time_name : the header of a CSV file's times. Raises SceneError, which names file, row and the
    requirement: times increase strictly, and every number is finite and at most 1e30.
    """
    netcdf = path.suffix.lower() in NETCDF
    found = _read_netcdf(path) if netcdf else _read_csv(path, split_unit(time_name)[0].lower())
    time = found.time.values
    if len(time) < LEAST_SAMPLES:
        allowed = f"must hold at least {LEAST_SAMPLES} samples, not {len(time)}"
        raise SceneError(str(path), "", None, allowed)
    for column in (found.time, *found.rest):
        wrong = ~(np.abs(column.values) <= LARGEST)
        if column.empty is not None:
            wrong &= ~column.empty
        if wrong.any():
            i = int(np.argmax(wrong))
            value = float(column.values[i])
            allowed = "must be a finite number of at most 1e30"
            raise SceneError(found.row(i), column.name or "value", value, allowed)
    late = np.diff(time) <= 0
    if late.any():
        i = int(np.argmax(late))
        fault = "is repeated; each time must be" if time[i] == time[i + 1] else "must be"
        allowed = f"{fault} later than the one before it, {time[i]:.12g}"
        raise SceneError(found.row(i + 1), "time", float(time[i + 1]), allowed)
    return found


def split_unit(text: str) -> tuple[str, str]:
    """Return name and unit of `name [unit]` or `name (unit)`; the unit is empty without one."""
    text = text.strip()
    for opening, closing in ("[]", "()"):
        if text.endswith(closing) and opening in text:
            name, _, unit = text[:-1].rpartition(opening)
            if not name.rstrip().endswith("@"):  # else a receiver's place, `gap@[20,30]`
                return name.strip(), unit.strip()
    return text, ""


def _read_csv(path: Path, time_name: str) -> Columns:
    numbers, values, blank = array("q"), array("d"), bytearray()
    header: list[str] = []
    at = 0

    def row(i: int) -> str:
        return f"{path}, line {numbers[i]}"

    try:
        for number, cells in _rows(read_lines(path, LARGEST_FILE), time_name):
            if not header:
                header = ["time", ""] if is_number(cells[0]) else cells
                at = _where_time(path, header, time_name)
                if header is cells:
                    continue
            values.extend(_numbers(f"{path}, line {number}", header, cells, at))
            blank.extend(not cell for cell in cells)
            numbers.append(number)
    except SceneError:
        raise
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None
    header = header or ["time", ""]
    data = np.frombuffer(values).reshape(-1, len(header))
    empty = np.frombuffer(blank, dtype=bool).reshape(data.shape)
    columns = [
        Column(*split_unit(text), data[:, i], empty[:, i] if empty[:, i].any() else None)
        for i, text in enumerate(header)
    ]
    return Columns(columns[at], [c for c in columns if c is not columns[at]], row)


def _where_time(path: Path, header: list[str], time_name: str) -> int:
    names = [split_unit(text)[0].lower() for text in header]
    if names.count(time_name) != 1 or len(names) < 2:
        allowed = (
            "must name one column time, and one or more as stress@20; "
            f"{path}:{header[0]}=time marks this one as time"
        )
        raise SceneError(str(path), "header", ", ".join(header), allowed)
    return names.index(time_name)


def _rows(lines: Iterable[tuple[int, str]], time_name: str) -> Iterator[tuple[int, list[str]]]:
    """Yield line number and cells, split at the separator of the first line that is not a comment.

    A comment ends a line; within a header it begins with "# ", since names may contain #.
    """
    separator = ""
    for number, line in lines:
        sign = "#" if separator or NUMBER.match(line) else HEADER_COMMENT
        text = re.split(sign, line, maxsplit=1)[0].strip(" ")
        if not text.strip():
            continue
        try:
            separator = separator or _separator(text, time_name)
            cells = _cells(text, separator)
        except csv.Error:
            raise ValueError(f"is not a CSV file (line {number})") from None
        yield number, cells


def _separator(text: str, time_name: str) -> str:
    """Return the separator of cells in a file's first line, next to the name of the times."""
    for separator in ";\t,":
        names = [split_unit(cell)[0].lower() for cell in _cells(text, separator)]
        if len(names) > 1 and time_name in names:
            return separator
    return next((separator for separator in ";\t" if separator in text), ",")


def _cells(text: str, separator: str) -> list[str]:
    found: list[str] = []
    for cell in next(csv.reader([text], delimiter=separator, skipinitialspace=True)):
        if found and found[-1].count("[") > found[-1].count("]"):  # a place, velocity_x@[20,30]
            found[-1] += separator + cell
        else:
            found.append(cell)
    return [printable(cell).strip() for cell in found]


def _numbers(where: str, header: list[str], cells: list[str], at: int) -> list[float]:
    """Return the numbers of a row, nan for an empty cell; times, column `at`, cannot be empty."""
    if len(cells) != len(header):
        columns = ", ".join(header) if header[1] else "time and value, without a header"
        allowed = f"must hold {len(header)} numbers ({columns}), not {len(cells)}"
        raise SceneError(where, "", None, allowed)
    for i, (name, cell) in enumerate(zip(header, cells, strict=True)):
        if not is_number(cell) and (cell or i == at):
            raise SceneError(where, name or "value", cell, "must be a number")
    return [float(cell or "nan") for cell in cells]


def _read_netcdf(path: Path) -> Columns:
    coordinates = [name for names in RECEIVERS.values() for name in names]
    wanted = {"time", *QUANTITIES, *RECEIVERS, *coordinates, *COMPONENT_DIMENSIONS}
    try:
        # Undecoded, times keep the numbers and the unit of the file.
        found = load_netcdf(path, wanted, decode_times=False)
    except FileNotFoundError as error:
        raise SceneError(str(path), "", None, f"cannot be read: {error.strerror}") from None
    except Exception as error:  # from whichever library xarray uses, on a truncated file
        reason = str(error).partition(". ")[0]
        raise SceneError(str(path), "", None, f"cannot be read as NetCDF: {reason}") from None
    if "time" not in found.variables or found.time.dims != ("time",):
        raise SceneError(str(path), "time", None, "must be a coordinate over itself")
    found = found.set_coords([name for name in coordinates if name in found])
    columns = [
        column
        for quantity in QUANTITIES
        if quantity in found
        for column in _columns_of(path, found[quantity])
    ]
    if not columns:
        allowed = f"must hold one or more of {', '.join(QUANTITIES)} over time"
        raise SceneError(str(path), "", None, allowed)
    time = Column("time", _unit(found.time), _floats(path, found.time))
    return Columns(time, columns, lambda i: f"{path}, sample {i}")


def _columns_of(path: Path, variable: xr.DataArray) -> Iterator[Column]:
    """Yield `velocity_x@20` or `velocity_x@[20,30]` for each component and receiver; missing values
    are left out."""
    name = str(variable.name)
    # A receiver selected from a result is still present, as a coordinate without dimension.
    place, component = (
        next((one for one in known if one in variable.dims or one in variable.coords), "")
        for known in (RECEIVERS, COMPONENT_DIMENSIONS)
    )
    if not {"time"} <= set(variable.dims) <= {"time", place, component}:
        allowed = (
            f"must have the dimension time, and beside it at most one of {', '.join(RECEIVERS)} "
            f"and one of {', '.join(COMPONENT_DIMENSIONS)}"
        )
        raise SceneError(str(path), name, ", ".join(map(str, variable.dims)), allowed)
    named = [one for one in (place, component) if one]
    for key in named:
        if key not in variable.dims:
            variable = variable.expand_dims(key)
    values = _floats(path, variable.transpose(*named, "time"))
    for index in np.ndindex(values.shape[:-1]):
        at, text = dict(zip(named, index, strict=True)), name
        if component in variable.coords:
            text += f"_{variable[component].values[at[component]]}"
        if place in variable.coords:
            text += f"@{_receiver(variable, place, at[place])}"
        yield Column(printable(text), _unit(variable), values[index])


def _receiver(variable: xr.DataArray, place: str, index: int) -> str:
    """Return a receiver's place as in labels: `20`, `[20,30]`."""
    at = [float(np.atleast_1d(variable[name].values)[index]) for name in RECEIVERS[place]]
    numbers = [f"{x:.12g}" for x in at]
    return numbers[0] if len(numbers) == 1 else f"[{','.join(numbers)}]"


def _unit(variable: xr.DataArray) -> str:
    return printable(str(variable.attrs.get("units", ""))).strip()


def _floats(path: Path, variable: xr.DataArray) -> np.ndarray:
    if variable.dtype.kind not in "fiu":
        raise SceneError(str(path), str(variable.name), None, "must hold numbers")
    return variable.values.astype(float)
