"""Reading of NetCDF files into memory."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

import xarray as xr

from jointwave.cases.size import memory, require, within

MAGIC = (b"CDF", b"\x89HDF")  # first bytes of NetCDF 3 and 4
COPIES = 3  # of a variable in memory: stored, decoded, and in double precision
LIBRARIES = 300_000_000  # bytes of address space for the reading libraries


def is_netcdf(path: Path) -> bool:
    """Return whether a file has the first bytes of NetCDF."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(4).startswith(MAGIC)


def load_netcdf(path: Path, wanted: Collection[str] | None = None, **decoding: Any) -> xr.Dataset:
    """Return a NetCDF file, or only its `wanted` variables, in memory.

    decoding : for xarray.open_dataset. Raises MemoryError beyond the memory of a run, OSError
    without a regular file, and any error of the library for a damaged file.
    """
    if path.exists():
        if not path.is_file():
            raise OSError("it is not a regular file")
        require(path.stat().st_size, "the file")
    # Opening reads the coordinates, whatever size the header gives.
    with within(LIBRARIES + memory()), xr.open_dataset(path, **decoding) as lazy:
        others = [] if wanted is None else [name for name in lazy.variables if name not in wanted]
        found = lazy.drop_vars(others)
        require(COPIES * found.nbytes, "its variables")
        return found.load()
