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
    coordinates = [name for names in RECEIVERS.values() for name in names]
    wanted = {"time", *QUANTITIES, *RECEIVERS, *coordinates, *COMPONENT_DIMENSIONS}
    try:
        # Undecoded, times keep the numbers and the unit of the file.
        found = load_netcdf(path, wanted, decode_times=False)
    except Exception as error:  # from whichever library xarray uses, on a truncated file
        raise ValueError(f"cannot be read as NetCDF: {str(error).partition('. ')[0]}") from None
    if "time" not in found.variables or found.time.dims != ("time",):
        raise ValueError("time: must be a coordinate over itself")
    found = found.set_coords([name for name in coordinates if name in found])
    held = [found[quantity] for quantity in QUANTITIES if quantity in found]
    columns = [column for variable in held for column in _columns_of(variable)]
    if not columns:
        raise ValueError(f"must hold one or more of {', '.join(QUANTITIES)} over time")
    if found.time.dtype.kind not in "fiu":
        raise ValueError("time must hold numbers")
    time = Column("time", _unit(found.time), found.time.values.astype(float))
    all_of = Columns(time, columns)
    require_series(all_of, "sample {}".format, least)
    return all_of


def _columns_of(variable: xr.DataArray) -> Iterator[Column]:
    """Yield `velocity_x@20` or `velocity_x@[20,30]` for each component and receiver."""
    if variable.dtype.kind not in "fiu":
        raise ValueError(f"{variable.name} must hold numbers")
    # A receiver selected from a result is still present, as a coordinate without dimension.
    named = [
        next((one for one in known if one in variable.dims or one in variable.coords), "")
        for known in (RECEIVERS, COMPONENT_DIMENSIONS)
    ]
    if not {"time"} <= set(variable.dims) <= {"time", *named}:
        allowed = (
            f"must have the dimension time, and beside it at most one of {', '.join(RECEIVERS)} "
            f"and one of {', '.join(COMPONENT_DIMENSIONS)}"
        )
        raise ValueError(f"{variable.name} over {', '.join(map(str, variable.dims))}: {allowed}")
    missing = [name for name in named if name and name not in variable.dims]
    found = variable.expand_dims(missing).transpose(*filter(None, named), "time")
    place, component = named
    for index in np.ndindex(found.shape[:-1]):
        one, text = found[index], str(variable.name)
        if component in one.coords:
            text += f"_{one[component].item()}"
        if place and all(name in one.coords for name in RECEIVERS[place]):
            text = str(Place(text, "", tuple(float(one[name]) for name in RECEIVERS[place])))
        yield Column(printable(text), _unit(variable), one.values.astype(float))


def _unit(variable: xr.DataArray) -> str:
    return printable(str(variable.attrs.get("units", ""))).strip()
