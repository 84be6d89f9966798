"""Columns of external files (NetCDF, tables, seismograms), selected by command-line arguments."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from jointwave.cases.records import Column, Columns, read_columns, require_series
from jointwave.cases.units import split_unit
from jointwave.compare.misfit.places import LABEL, Place, waveforms
from jointwave.results.dataset import NAMES
from jointwave.results.labels import QUANTITIES, RECEIVERS
from jointwave.results.netcdf import is_netcdf, load_netcdf


class Selection(NamedTuple):
    """One argument of `--with`; column and label are "" unless given."""

    text: str
    path: Path
    column: str = ""
    label: str = ""

    @property
    def is_time(self) -> bool:
        """Whether it selects the column of times."""
        return split_unit(self.label)[0].lower() == "time"

    def fits(self, column: Column) -> bool:
        """Return whether a column is the selected one, or no column is selected."""
        headers = ("", column.name, f"{column.name} [{column.unit}]")
        return self.column in headers or split_unit(self.column) == (column.name, column.unit)


def selection(text: str) -> Selection:
    """Parse an argument FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL."""
    ends = [len(text), *(i for i, letter in enumerate(text) if letter == ":")]
    end = next((i for i in ends if Path(text[:i]).is_file()), len(text))
    path, which = Path(text[:end]), text[end + 1 :].strip()
    if _is_label(which):
        return Selection(text, path, "", which)
    column, equals, label = which.rpartition("=")
    if not equals or not (_is_label(label) or split_unit(label)[0].lower() == "time"):
        column, label = which, ""
    return Selection(text, path, column.strip().strip("\"'"), label.strip())


def _is_label(text: str) -> bool:
    return LABEL.fullmatch(split_unit(text)[0].removeprefix("-").lstrip()) is not None


def read_table(times: Selection, least: int, gaps: bool = True) -> Columns:
    """Return the columns of a file; a selection of its times may give their unit.

    times : selection of the times, or of none. least, gaps : see `read_columns`. Raises ValueError.
    """
    if is_netcdf(times.path):
        found = read_netcdf(times.path, least)
    else:
        found = read_columns(times.path, times.column if times.is_time else "time", least, gaps)
    unit = split_unit(times.label)[1] if times.is_time else ""
    return found._replace(time=found.time._replace(unit=unit or found.time.unit))


def selected(
    columns: list[Column], choice: Selection, place_of: Callable[[str], Place | None]
) -> list[tuple[Place | None, Column]]:
    """Return the columns selected by an argument, with its sign and unit, each with the place named
    by its header or label. place_of : returns the place that a text names."""
    fitting = [one for one in columns if choice.fits(one)]
    label, unit = split_unit(choice.label)
    wanted, found = place_of(label.removeprefix("-")), []
    for one in fitting if wanted or not label else []:
        place, said = place_of(one.name.removeprefix("-")), one.name.lower()
        alone = len(fitting) == 1 and said not in QUANTITIES
        if wanted and not place and (alone or said == wanted.quantity):
            place = wanted
        if wanted is None or (place and wanted.is_at(place)):
            sign = -1.0 if "-" in (one.name[:1], label[:1]) else 1.0
            found.append((place, Column(one.name, unit or one.unit, sign * one.values)))
    return found


def read_netcdf(path: Path, least: int) -> Columns:
    """Return the waveforms of a result, or of one receiver selected from it. Raises ValueError, in
    one phrase, if there are none or they have fewer than `least` samples."""
    places = [name for names in RECEIVERS.values() for name in names]
    wanted = {"time", *QUANTITIES, *RECEIVERS, *places, *NAMES}
    try:
        # Undecoded times keep the numbers and the unit of the file.
        found = load_netcdf(path, wanted, decode_times=False)
    except Exception as error:  # of whichever library xarray uses, for a truncated file
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
