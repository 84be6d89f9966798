"""NetCDF files of results as named columns over time."""

from pathlib import Path

from jointwave.cases.records import Column, Columns, require_series
from jointwave.compare.misfit.places import waveforms
from jointwave.results.dataset import NAMES
from jointwave.results.labels import QUANTITIES, RECEIVERS
from jointwave.results.netcdf import load_netcdf

MAGIC = (b"CDF", b"\x89HDF")  # what NetCDF 3 and 4 begin with


def is_netcdf(path: Path) -> bool:
    """Return whether a file begins as NetCDF does."""
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(4).startswith(MAGIC)


def read_netcdf(path: Path, least: int) -> Columns:
    """Return the waveforms of a result, or of one receiver that was selected from it, each at least
    so many samples long; raises ValueError, in one phrase, where a file holds none."""
    places = [name for names in RECEIVERS.values() for name in names]
    wanted = {"time", *QUANTITIES, *RECEIVERS, *places, *NAMES}
    try:
        # Undecoded, times keep the numbers and the unit of the file.
        found = load_netcdf(path, wanted, decode_times=False)
    except Exception as error:  # from whichever library xarray uses, on a truncated file
        raise ValueError(f"cannot be read as NetCDF: {str(error).partition('. ')[0]}") from None
    found = found.expand_dims([n for n in RECEIVERS if n in found.coords and n not in found.dims])
    held = [name for name in QUANTITIES if name in found]
    if not held or "time" not in found.coords:
        raise ValueError(f"must hold one or more of {', '.join(QUANTITIES)} over time")
    for name in held:
        if len(set(found[name].dims) & set(RECEIVERS)) != 1 or "time" not in found[name].dims:
            raise ValueError(f"{name}: must be over time and one of {', '.join(RECEIVERS)}")
    units = {name: str(of.attrs.get("units", "")).strip() for name, of in found.variables.items()}
    waves = waveforms(found[held].transpose(*RECEIVERS, "time", ..., missing_dims="ignore"))
    columns = [Column(str(p), units[p.quantity], wave.astype(float)) for p, wave in waves.items()]
    all_of = Columns(Column("time", units["time"], found.time.values.astype(float)), columns)
    require_series(all_of, "sample {}".format, least)
    return all_of
