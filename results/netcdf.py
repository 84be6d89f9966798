"""Reading of NetCDF files, whose memory need is known from the header before any data is read."""

from __future__ import annotations

from collections.abc import Collection
from importlib.util import module_from_spec, spec_from_file_location
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases.size import require, within

if TYPE_CHECKING:
    import xarray as xr

COPIES = 3  # of a variable: as it is stored, decoded, and in double precision
LIBRARIES = 300_000_000  # bytes of address space for the reading libraries


def load_netcdf(path: Path, wanted: Collection[str] | None = None, **decoding: Any) -> xr.Dataset:
    """Return a NetCDF file, or only its `wanted` variables, in memory.

    decoding : for xarray.open_dataset. Raises MemoryError if they would take more memory than a run
    may, OSError if there is no regular file, any error of the library for a damaged one.
    """
    import xarray as xr

    if path.exists() and not path.is_file():
        raise OSError("it is not a regular file")
    sizes = _sizes(path)
    others = [] if wanted is None else [name for name in sizes if name not in wanted]
    total = COPIES * sum(size for name, size in sizes.items() if name not in others)
    require(total, "its variables")
    # Coordinates are read when the file is opened, and a header may understate the sizes.
    with (
        within(LIBRARIES + total),
        xr.open_dataset(path, drop_variables=others, **decoding) as lazy,
    ):
        return lazy.load()


def _sizes(path: Path) -> dict[str, float]:
    """Return the stored size of each variable (bytes), from the header only."""
    with path.open("rb") as file:
        is_classic = file.read(3) == b"CDF"
    if is_classic:
        require(path.stat().st_size, "the file")
    with (netcdf3 if is_classic else _hdf5)(path) as file:
        return {
            name: _item(variable) * prod(map(float, variable.shape))
            for name, variable in file.variables.items()
        }


def _item(variable: Any) -> float:
    """Return the bytes of one value; for text of variable length, those of its pointer."""
    kind = getattr(variable, "dtype", None)  # scipy's has none
    return float(variable.itemsize() if kind is None else getattr(kind, "itemsize", 8))


def netcdf3(path: Path, mode: str = "r") -> Any:
    """Return a NetCDF 3 file opened by scipy; only that module is imported, since importing all of
    scipy.io takes as long as the steps of a short run."""
    import scipy

    source = Path(scipy.__file__).parent / "io/_netcdf.py"
    if source.exists():
        spec = spec_from_file_location("scipy_netcdf", source)
        assert spec and spec.loader
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
    else:  # a scipy with another layout
        import scipy.io

        module = scipy.io
    return module.netcdf_file(str(path), mode, mmap=mode == "r", version=2)


def _hdf5(path: Path) -> Any:
    try:
        from netCDF4 import Dataset
    except ImportError:
        pass
    else:
        return Dataset(path)
    try:
        from h5netcdf import File
    except ImportError:
        raise ValueError("it is no NetCDF 3, and NetCDF 4 needs netCDF4 or h5netcdf") from None
    return File(path)
