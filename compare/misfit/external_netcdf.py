"""NetCDF files of waveforms as named columns over time."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from jointwave.cases.errors import printable
from jointwave.cases.records import Column, Columns, require_series
from jointwave.compare.misfit.places import COMPONENT_DIMENSIONS, QUANTITIES, Place
from jointwave.results.labels import RECEIVERS
from jointwave.results.netcdf import load_netcdf

MAGIC = (b"CDF", b"\x89HDF")  # what NetCDF 3 and 4 begin with


def is_netcdf(path: Path) -> bool:
    """Return whether a file begins as NetCDF does."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(4).startswith(MAGIC)


def read_netcdf(path: Path, least: int) -> Columns:
    """Return the waveforms of a NetCDF file, each at least so many samples long.

    Raises ValueError, in one phrase, where it holds none.
    """
    places = [name for names in RECEIVERS.values() for name in names]
    wanted = {"time", *QUANTITIES, *RECEIVERS, *places, *COMPONENT_DIMENSIONS}
    try:
        # Undecoded, times keep the numbers and the unit of the file.
        found = load_netcdf(path, wanted, decode_times=False)
    except Exception as error:  # from whichever library xarray uses, on a truncated file
        raise ValueError(f"cannot be read as NetCDF: {str(error).partition('. ')[0]}") from None
    if "time" not in found.variables or found.time.dims != ("time",):
        raise ValueError("time: must be a coordinate over itself")
    found = found.set_coords([name for name in places if name in found])
    columns = [one for name in QUANTITIES if name in found for one in _columns_of(found[name])]
    if not columns:
        raise ValueError(f"must hold one or more of {', '.join(QUANTITIES)} over time")
    all_of = Columns(_column("time", found.time), columns)
    require_series(all_of, "sample {}".format, least)
    return all_of


def _columns_of(variable: xr.DataArray) -> Iterator[Column]:
    """Yield `velocity_x@20` or `velocity_x@[20,30]` for each component and receiver."""
    others = [name for name in variable.dims if name != "time"]
    if len(others) == variable.ndim or not {*others} <= {*RECEIVERS, *COMPONENT_DIMENSIONS}:
        known = ", ".join((*RECEIVERS, *COMPONENT_DIMENSIONS))
        allowed = f"must have the dimension time, and beside it only those of {known}"
        raise ValueError(f"{variable.name} over {', '.join(map(str, variable.dims))}: {allowed}")
    found = variable.transpose(*others, "time")
    for index in np.ndindex(found.shape[:-1]):
        # A receiver selected from a result is still present, as a coordinate without dimension.
        one, name = found[index], str(variable.name)
        for component in (one[dim].item() for dim in COMPONENT_DIMENSIONS if dim in one.coords):
            name += f"_{component}"
        for names in RECEIVERS.values():
            if all(place in one.coords for place in names):
                name = str(Place(name, "", tuple(float(one[place]) for place in names)))
        yield _column(name, one)


def _column(name: str, values: xr.DataArray) -> Column:
    if values.dtype.kind not in "fiu":
        raise ValueError(f"{printable(name)} must hold numbers")
    unit = printable(str(values.attrs.get("units", ""))).strip()
    return Column(printable(name), unit, values.values.astype(float))
