"""All writing of files: each is written in a temporary folder first, then moved."""

import os
import shutil
import tempfile
from collections.abc import Callable
from errno import EIO
from itertools import count
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError, printable
from jointwave.cases.files import is_number, read_json
from jointwave.results.netcdf import MAGIC
from jointwave.results.snapshots import Snapshots

LARGEST_ROW = 100_000_000  # bytes of a point saved by a study or a sweep
FORMULA = ("=", "+", "-", "@")  # first characters of a spreadsheet formula
OVERWRITTEN = "would be overwritten: choose another --out"
UNFINISHED = ".unfinished-"  # in the names of temporary folders, which begin with a dot


def write(path: Path, save: Callable[[Path], object]) -> Path:
    """Let `save` write a file or a folder, then move it to `path`.

    An existing file or folder is replaced only if `save` succeeds. Raises OSError, which names
    `path`, if it cannot be written; SceneError if an existing folder contains files of other kinds.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        prefix = f".{path.stem.lstrip('.')}{UNFINISHED}"
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=prefix) as place:
            new = Path(place, path.name)
            save(new)
            if new.is_dir():
                _refuse_foreign_folder(path, new)
                if path.exists() or path.is_symlink():
                    path.replace(Path(place, "old"))
            else:
                with new.open("rb") as file:
                    os.fsync(file.fileno())  # a full disk may show only now
            new.replace(path)
    except OSError as error:
        if UNFINISHED not in str(error.filename or UNFINISHED):
            raise
        # Some libraries report a full disk with messages of their own.
        raise OSError(error.errno or EIO, error.strerror or str(error), str(path)) from None
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


def sweep(folder: Path) -> None:
    """Remove unfinished files of killed processes from a folder."""
    for left in folder.glob(f".*{UNFINISHED}*"):
        shutil.rmtree(left, ignore_errors=True)


#: First bytes of drawings and films by suffix; MP4 begins with the size of its first box.
BEGINS: dict[str, tuple[bytes, ...]] = {
    **{".pdf": (b"%PDF",), ".svg": (b"<?xml", b"<svg"), ".png": (b"\x89PNG",)},
    **{".mp4": (b"\0\0\0",), ".gif": (b"GIF87a", b"GIF89a")},
}
DRAWINGS, FILMS = (".pdf", ".svg", ".png"), (".mp4", ".gif")


def check_out(path: Path, kinds: tuple[str, ...] = DRAWINGS) -> None:
    """Raise SceneError if `--out` has another suffix, names an existing file of another kind, or is
    in a folder that cannot be written."""
    if path.suffix not in kinds:
        raise SceneError("--out", str(path), None, f"must end in {' or '.join(kinds)}")
    refuse_foreign(path, BEGINS[path.suffix])
    try:
        tempfile.TemporaryFile(dir=next(x for x in path.absolute().parents if x.exists())).close()
    except OSError as error:
        allowed = f"cannot be written: {error.strerror}"
        raise SceneError(str(path), "", None, allowed) from None


def refuse_foreign(path: Path, begins: tuple[bytes, ...] = MAGIC) -> None:
    """Raise SceneError if a path exists and is neither empty nor begins like a file of jointwave.
    Symbolic links are not checked: writing replaces the link and keeps its target."""
    if path.is_symlink() or not path.exists():
        return
    found = "is a folder" if path.is_dir() else "is not a result"
    if path.is_file():
        with path.open("rb") as file:
            head = file.read(8)
        if not head or head.startswith(begins):
            return
    raise SceneError(str(path), "", None, f"{found} and {OVERWRITTEN}")


def _refuse_foreign_folder(path: Path, new: Path) -> None:
    """Raise SceneError if a path is a file, or a folder with files of kinds not in the new one."""
    kinds = {file.suffix for file in new.iterdir()} if new.is_dir() else set()
    if path.is_symlink() or not path.exists():
        return
    foreign = [path] if path.is_file() else [f for f in path.iterdir() if f.suffix not in kinds]
    if foreign:
        raise SceneError(str(min(foreign)), "", None, f"is not a result and {OVERWRITTEN}")


def write_csv(path: Path, table: pd.DataFrame, digits: int = 9) -> Path:
    """Write a table without its index; text is escaped by `csv_cell`."""
    safe = table.rename(columns=csv_cell)
    for i, kind in enumerate(safe.dtypes):
        if kind.kind not in "biuf":
            safe.isetitem(i, [csv_cell(value) for value in safe.iloc[:, i]])
    form = f"%.{digits}g"
    return write(path, lambda file: safe.to_csv(file, index=False, float_format=form))


def write_beside(path: Path, table: pd.DataFrame) -> list[Path]:
    """Write a table as `write_csv` does. One with other rows that it replaces is kept, once, as
    NAME-1.csv (or -2, ...), which is then the second file returned."""
    old = path.read_bytes() if path.is_file() else b""
    spare = next(x for k in count(1) if not (x := path.with_stem(f"{path.stem}-{k}")).exists())
    kept = any(x.read_bytes() == old for x in path.parent.glob(f"{path.stem}-*{path.suffix}"))
    if old and not kept:
        create(spare, old)
    write_csv(path, table)
    if kept or {*old.splitlines()} <= {*path.read_bytes().splitlines()}:
        spare.unlink(missing_ok=True)
        return [path]
    return [path, spare]


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


def read_rows(path: Path) -> Any:
    """Return a row, or a list of rows, from JSON; raises SceneError if the file is damaged."""
    try:
        found = read_json(path, LARGEST_ROW)
        rows = found if isinstance(found, list) else [found]
        if not all(isinstance(one, dict) for one in rows):
            raise ValueError("it has no rows")
        return found
    except ValueError as error:
        raise SceneError(str(path), "", None, f"is damaged, remove it: {error}") from None


def write_dataset(path: Path, result: xr.Dataset) -> Path:
    """Write a result as NetCDF 3; integer attributes beyond its 32 bits become floats."""
    refuse_foreign(path)
    texts = {k: v.astype(str) for k, v in result.variables.items() if v.dtype == object}
    whole = {k: v for k, v in result.attrs.items() if isinstance(v, int | np.integer)}
    large = {k: float(v) for k, v in whole.items() if abs(int(v)) >= 2**31}
    found = result.assign(texts).assign_attrs(large)
    plain = {k: {"_FillValue": None} for k, v in found.variables.items() if v.dtype.kind == "f"}
    return write(path, lambda file: found.to_netcdf(file, engine="scipy", encoding=plain))


def write_pvd(path: Path, s: Snapshots) -> Path:
    """Write snapshots for ParaView: NAME.pvd at `path`, and NAME-fields/0000.vtu, ... per instant.

    Points are those of the undeformed body; the filter "Warp By Vector" shows its motion. Point
    data: displacement (m), velocity (m/s). Cell data: block and, if known, stress (Pa).
    """
    import meshio  # slow to import

    refuse_foreign(path, (b"<?xml",))
    folder = path.with_name(f"{path.stem}-fields")
    names = [f"{i:04d}.vtu" for i in range(len(s.time))]

    def save(new: Path) -> None:
        new.mkdir()
        for i, name in enumerate(names):
            cell_data: dict[str, Any] = {"block": [s.block]}
            if s.stress is not None:
                cell_data["stress"] = [s.stress[i]]
            vectors = {"displacement": s.displacement[i], "velocity": s.velocity[i]}
            meshio.Mesh(s.points, [(s.kind, s.cells)], vectors, cell_data).write(new / name)

    write(folder, save)
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for time, name in zip(s.time.tolist(), names, strict=True):
        ElementTree.SubElement(
            collection, "DataSet", timestep=repr(time), file=f"{folder.name}/{name}"
        )
    tree = ElementTree.ElementTree(root)
    ElementTree.indent(tree)
    return write(path, lambda file: tree.write(file, encoding="utf-8", xml_declaration=True))
