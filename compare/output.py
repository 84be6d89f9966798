"""The only place that writes files: each under a temporary name first, then renamed."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import xarray as xr


def write(path: Path, save: Callable[[Path], object]) -> Path:
    """Let `save` write a file and put it at `path` only when it is whole.

    What stood at `path` before stays untouched until then, and for good when `save` fails.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix)
    os.close(handle)
    temporary = Path(name)
    try:
        save(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    return path


def write_text(path: Path, text: str) -> Path:
    """Write text as UTF-8."""
    return write(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def write_dataset(path: Path, result: xr.Dataset) -> Path:
    """Write a result as NetCDF."""
    return write(path, lambda temporary: result.to_netcdf(temporary, engine="scipy"))
