"""The only place that writes files: each under a temporary name first, then renamed."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from errno import EIO
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from cases.errors import SceneError, printable
from cases.files import is_number, read_json
from results.dataset import Fields
from results.labels import RECEIVERS
from results.netcdf import netcdf3

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


T = TypeVar("T")

LARGEST_ROW = 100_000_000  # bytes, of a point saved by a study, a sweep or the robustness suite
AT_ONCE = 10_000  # rows of a table that are formatted together
FORMULA = ("=", "+", "-", "@")  # first characters of a spreadsheet formula
UNFINISHED = ".unfinished-"  # in the names of files being written, which begin with a dot


def write(path: Path, save: Callable[[Path], object]) -> Path:
    """Let `save` write a file and move it to `path` once it is complete and synced to disk.

    An existing file at `path` is untouched until then, and kept if `save` fails.
    Raises OSError, which names `path`, if it cannot be written.
    """
    with _names(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        prefix = f".{path.stem.lstrip('.')}{UNFINISHED}"
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=prefix, suffix=path.suffix)
        os.close(handle)
        temporary = Path(name)
        try:
            save(temporary)
            temporary.chmod(0o644)
            with temporary.open("rb") as file:
                os.fsync(file.fileno())  # a full disk may show only now
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    return path


def create(path: Path, content: bytes) -> Path:
    """Write a new file; raises SceneError if the path exists, OSError as `write` does."""

    def save(temporary: Path) -> None:
        temporary.write_bytes(content)
        try:
            os.link(temporary, path)  # unlike renaming, this never replaces
        except FileExistsError:
            raise SceneError(str(path), "", None, "exists already and is not overwritten") from None

    return write(path, save)


@contextmanager
def _names(path: Path) -> Iterator[None]:
    """Make an OSError name the file, not its temporary one."""
    try:
        yield
    except OSError as error:
        if UNFINISHED not in str(error.filename or UNFINISHED):
            raise
        # Some libraries report a full disk with messages of their own.
        raise OSError(error.errno or EIO, error.strerror or str(error), str(path)) from None


def sweep(folder: Path) -> None:
    """Remove unfinished files of killed processes from a folder."""
    for left in folder.glob(f".*{UNFINISHED}*"):
        if left.is_dir():
            shutil.rmtree(left, ignore_errors=True)
        else:
            left.unlink(missing_ok=True)


#: First bytes of a result: NetCDF 3, or NetCDF 4 of other programs; a result may also be empty.
NETCDF = (b"CDF", b"\x89HDF")


def refuse_foreign(path: Path, begins: tuple[bytes, ...] = NETCDF) -> None:
    """Raise SceneError if the existing file at a path does not begin like one of jointwave's.

    A link there is replaced, and its target is kept.
    """
    if path.is_symlink() or not path.exists():
        return
    found = "is a folder" if path.is_dir() else "is not a result"
    if not path.is_file() or not _begins(path, begins):
        raise SceneError(
            str(path), "", None, f"{found} and would be overwritten: choose another --out"
        )


def _begins(path: Path, begins: tuple[bytes, ...]) -> bool:
    with path.open("rb") as file:
        head = file.read(8)
    return not head or head.startswith(begins)


def _refuse_foreign_folder(path: Path, new: Path) -> None:
    """Raise SceneError if a folder contains files of a kind that the new one does not."""
    kinds = {file.suffix for file in new.iterdir()} if new.is_dir() else set()
    if path.is_symlink() or not path.exists():
        return
    foreign = [path] if path.is_file() else [f for f in path.iterdir() if f.suffix not in kinds]
    if foreign:
        allowed = "is not a result and would be overwritten: choose another --out"
        raise SceneError(str(min(foreign)), "", None, allowed)


def write_folder(path: Path, save: Callable[[Path], object]) -> Path:
    """Let `save` create and fill a folder, and move it to `path` once it is complete.

    An existing folder at `path` is replaced, and kept unchanged if `save` fails.
    Raises SceneError if it contains other files.
    """
    with _names(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        prefix = f".{path.stem.lstrip('.')}{UNFINISHED}"
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=prefix) as place:
            new, old = Path(place, path.name), Path(place, "old")
            save(new)
            _refuse_foreign_folder(path, new)
            if path.exists() or path.is_symlink():
                path.replace(old)
            new.replace(path)
    return path


def write_csv(path: Path, table: pd.DataFrame, digits: int = 9) -> Path:
    """Write a table without its index; text is escaped by `csv_cell`."""
    safe = table.rename(columns=csv_cell)
    if all(kind.kind == "f" for kind in safe.dtypes) and not safe.isna().to_numpy().any():
        text = safe.iloc[:0].to_csv(index=False) + _rows(safe.to_numpy(), digits)
        return write_text(path, text)
    for i, kind in enumerate(safe.dtypes):
        if kind.kind == "f":
            safe.isetitem(i, [csv_number(value, digits) for value in safe.iloc[:, i].tolist()])
        elif kind.kind not in "biu":
            safe.isetitem(i, [csv_cell(value) for value in safe.iloc[:, i]])
    return write(path, lambda file: safe.to_csv(file, index=False))


def _rows(values: np.ndarray, digits: int) -> str:
    """Return the rows of a table of numbers [n, k], without NaN: one format for many of them takes
    half the time of one each."""
    row = ",".join([f"%.{digits}g"] * values.shape[1]) + "\n"
    parts = (values[i : i + AT_ONCE] for i in range(0, len(values), AT_ONCE))
    return "".join(row * len(part) % tuple(part.ravel().tolist()) for part in parts)


def csv_number(value: float, digits: int) -> str:
    """Return a number as text, NaN as none: pandas takes twice as long."""
    return "" if value != value else f"{value:.{digits}g}"


def csv_cell(value: object) -> object:
    """Return a cell that a spreadsheet does not evaluate; values other than text are unchanged.

    Text that begins like a formula gets a leading apostrophe.
    """
    if not isinstance(value, str):
        return value
    text = printable(value)
    return f"'{text}" if text.startswith(FORMULA) and not is_number(text) else text


def write_text(path: Path, text: str) -> Path:
    """Write text as UTF-8."""
    return write(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def read_kept(path: Path, form: type[T]) -> T:
    """Return JSON written by `write_text` as a `form`: a NamedTuple or a list of them.

    Raises SceneError if the file does not match that type.
    """
    from pydantic import TypeAdapter

    try:
        return TypeAdapter(form).validate_python(read_json(path, LARGEST_ROW))
    except ValueError as error:  # pydantic's messages have several lines
        reason = str(error).partition("\n")[0]
        raise SceneError(str(path), "", None, f"is damaged, remove it: {reason}") from None


def fields_of(result: xr.Dataset) -> Fields:
    """Return a result as plain arrays."""
    variables = {
        str(name): (tuple(map(str, v.dims)), v.values, dict(v.attrs))
        for name, v in result.variables.items()
    }
    return Fields(variables, {}, dict(result.attrs))


def write_fields(path: Path, fields: Fields) -> Path:
    """Write a result as NetCDF 3 by scipy, exactly as xarray would, without importing xarray."""
    refuse_foreign(path)

    def save(temporary: Path) -> None:
        with netcdf3(temporary, "w") as file:
            _write_attributes(file, fields.attributes)
            for name, (dimensions, values, attributes) in {
                **fields.coords,
                **fields.variables,
            }.items():
                located = attributes | _located(name, dimensions)
                _write_variable(file, name, dimensions, values, located)

    return write(path, save)


def _located(name: str, dimensions: tuple) -> dict[str, str]:
    """Return the attribute that gives readers the positions of a variable's receivers, if its
    dimensions do not (CF conventions, 5)."""
    known = [names for receivers, names in RECEIVERS.items() if receivers in dimensions]
    beside = [one for names in known if len(names) > 1 for one in names]
    return {"coordinates": " ".join(beside)} if beside and name not in beside else {}


def _write_variable(file, name: str, dimensions: tuple, values: np.ndarray, attributes: dict):
    if values.dtype.kind == "U":  # the format holds characters only, in a dimension of their own
        encoded = np.char.encode(values, "utf-8")
        values = encoded.view("S1").reshape(*values.shape, encoded.dtype.itemsize)
        dimensions = (*dimensions, f"string{encoded.dtype.itemsize}")
        attributes = {**attributes, "_Encoding": "utf-8"}
    for dimension, length in zip(dimensions, values.shape, strict=True):
        if dimension not in file.dimensions:
            file.createDimension(dimension, length)
    variable = file.createVariable(name, values.dtype, dimensions)
    variable[:] = values
    _write_attributes(variable, attributes)


def _write_attributes(target, attributes: dict) -> None:
    for key, value in attributes.items():
        # A bare Python number would be stored in single precision; the format knows no int64.
        number = isinstance(value, int | float | np.number)
        whole = isinstance(value, int | np.integer) and abs(int(value)) < 2**31
        kind = np.int32 if whole else np.float64
        setattr(target, key, np.array(value, dtype=kind) if number else value.encode())
