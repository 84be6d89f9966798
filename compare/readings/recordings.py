"""Recordings (files and arrays of recorders) as results, for the readings."""

import logging
import re
from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.records import Column
from jointwave.cases.units import TIME, UNITS
from jointwave.compare.misfit.alignment import UNEVEN
from jointwave.compare.misfit.columns import Selection, read_table, selected, selection
from jointwave.compare.misfit.places import spelled
from jointwave.results.labels import RECEIVERS
from jointwave.results.netcdf import is_netcdf, load_netcdf

#: A result; a file; an array over `time`; or times (s) with values in SI [n] or [receiver, n] and,
#: if known, the receivers' distances along a line (m).
Recording = xr.Dataset | xr.DataArray | str | PathLike[str] | tuple[Any, ...]
#: Quantities that a recorder's unit can identify.
MEASURED = ("velocity", "acceleration", "displacement", "stress")
#: Quantity, direction, and the receiver's place or, if unknown, its name, as in `Place`.
Where = tuple[str, str, tuple[float, ...] | str]
#: Recorders' names of directions, and horizontal pairs; 1 and 2 are SEED's, as in HH1.
DIRECTIONS = {
    **{"N": "n ns sn north", "E": "e ew we east", "Z": "z v ud up down vert vertical", "X": "x"},
    **{"R": "r rad radial", "T": "t tran trans transverse", "L": "l long longitudinal", "Y": "y"},
}
ACROSS = "NE XY RT LT 12"
AXIS_OF = {word: axis for axis, words in DIRECTIONS.items() for word in words.split()}
ENDING = rf"{'|'.join(AXIS_OF)}|(?<=[bdehms][hln])[12]"
CHANNEL = re.compile(rf"((?:.*[\W_])?[a-z]{{0,2}})({ENDING})", re.IGNORECASE)
MOTION = re.compile(r"[\W_]+(velocity|acceleration|displacement)$", re.IGNORECASE)
log = logging.getLogger("jointwave")
SLOW = 0.05  # s between samples of a file without unit above which its times are doubted
MOST_SAMPLES = 4_000_000  # of an uneven recording, resampled at its smallest interval


def recording(source: Recording, quantity: str = "velocity") -> xr.Dataset:
    """Return a recording as a result, SI: quantities over receivers, `time` and directions.

    source : a file must be readable by `cases.records` or xarray; its columns are named as
    `velocity_x@20 [mm/s]` or `acceleration@[20,30] [g]`, or anything with a unit, where channels
    NS, EW, UP or HHN, HHE, HHZ are directions of one recorder; FILE:COLUMN or FILE:COLUMN=LABEL
    selects one. quantity : of numbers that neither a name nor a unit tells. Uneven samples are
    interpolated linearly. Raises SceneError, one line with what is wrong.
    """
    if isinstance(source, xr.Dataset):
        return source
    if quantity not in UNITS:
        raise SceneError("recording", "quantity", quantity, f"must be one of {', '.join(UNITS)}")
    if isinstance(source, xr.DataArray):
        return _of_array(source, quantity)
    if isinstance(source, str | PathLike):
        return _of_file(str(source), quantity)
    try:
        time, values, *at = (np.asarray(one, dtype=float) for one in source)
    except (TypeError, ValueError):
        allowed = "must be a result, a file, an array over time, or (times, values)"
        raise SceneError("recording", "type", type(source).__name__, allowed) from None
    rows = np.atleast_2d(values)
    if rows.ndim != 2 or rows.shape[1] != len(time) or (at and len(at[0]) != len(rows)):
        allowed = f"must be [n] or [receiver, n] for {len(time)} times, and one place a receiver"
        raise SceneError("recording", "values", f"{rows.shape}", allowed)
    places = [(y,) for y in at[0]] if at else map(str, range(len(rows)))
    return dataset_of(time, {(quantity, "", y): row for y, row in zip(places, rows, strict=True)})


def _of_array(array: xr.DataArray, quantity: str) -> xr.Dataset:
    name = array.name if array.name in UNITS else quantity
    receiver = next((d for d in RECEIVERS if d in array.dims or d in array.coords), "velocity_y")
    if receiver not in array.coords:
        array = array.assign_coords({receiver: np.nan})
    if "axis" not in array.coords and not set(array.dims) - {receiver, "time"}:
        array = array.assign_coords(axis="")
    missing = [d for d in (receiver, "axis") if d not in array.dims and d in array.coords]
    return _even(array.expand_dims(missing).to_dataset(name=name))


def _of_file(text: str, quantity: str) -> xr.Dataset:
    choice = selection(text)
    every = Selection(text, choice.path)
    try:
        if is_netcdf(choice.path) and not (choice.column or choice.label):
            return load_netcdf(choice.path)
        time, columns = read_table(choice, 2, gaps=False)
        found = selected(columns, every if choice.is_time else choice, spelled)
        if not found:
            raise ValueError(f"has no column {choice.column or choice.label!r}")
        names = (one.name.removeprefix("-") for at, one in found if not at)
        channels = iter(_channels([MOTION.sub("", name) for name in names]))
        waves: dict[Where, np.ndarray] = {}
        for place, column in found:
            if not place and "@" in column.name:
                allowed = "must be as velocity_x@20 [mm/s] or acceleration@[20,30] [g]"
                raise ValueError(f"{column.name}: {allowed}")
            at: Where = place or (_measured(column, quantity), *next(channels))
            waves[at] = column.si(UNITS[at[0]])
        if len(waves) < len(found):
            raise ValueError("must name each column once")
        directed = {at: wave for at, wave in waves.items() if at[1]}
        if directed and (left := [f"{at[0]} of {at[2]}" for at in waves if not at[1]]):
            log.warning("warning: %s: left out beside components: %s", choice.path, ", ".join(left))
            waves = directed
        step = float(np.median(np.diff(time.values)))
        if not time.unit and step > SLOW:
            doubt = f"its times have no unit: steps of {step:g} s look like milliseconds"
            log.warning("warning: %s: %s", choice.path, doubt)
        return dataset_of(time.si(TIME), waves)
    except (OSError, ValueError, MemoryError) as error:
        if isinstance(error, SceneError):
            raise
        raise SceneError(str(choice.path), "", None, str(error)) from None


def _channels(names: list[str]) -> list[tuple[str, str]]:
    """Return the direction and the recorder of channels whose names end in orthogonal directions
    (HHN and HHE, or Vel L and Vel T); each other channel is its own recorder without direction."""
    matches = zip(map(CHANNEL.fullmatch, names), names, strict=True)
    found = [(AXIS_OF.get(m[2].lower(), m[2]), m[1]) if m else ("", name) for m, name in matches]
    for recorder in {one for _, one in found}:
        axes = {axis for axis, one in found if one == recorder}
        if len(axes) > 1 and any(axes <= {"Z", *pair} for pair in ACROSS.split()):
            return found
    return [("", name) for name in names]


def _measured(column: Column, quantity: str) -> str:
    """Return the quantity of a column without a place: by its name or unit, else `quantity`."""
    if said := [word for word in re.findall("[a-z]+", column.name.lower()) if word in UNITS]:
        return said[-1]
    if not column.unit or column.unit in UNITS[quantity]:
        return quantity
    return next((one for one in MEASURED if column.unit in UNITS[one]), quantity)


def dataset_of(time: np.ndarray, waves: Mapping[Any, np.ndarray]) -> xr.Dataset:
    """Return waveforms [n] by `Where` over times [n], s, as a result at equal intervals, stresses
    at receivers of their own. Raises ValueError."""
    groups: dict[tuple[str, str], dict[Any, np.ndarray]] = {}
    for at, wave in waves.items():
        dims = ("stress_y", "stress_component") if at[0] == "stress" else ("velocity_y", "axis")
        groups.setdefault(dims, {})[at] = wave
    found = [_at_receivers(time, one, *dims) for dims, one in groups.items()]
    try:
        return _even(xr.merge(found, compat="no_conflicts", join="outer"))
    except (xr.MergeError, xr.AlignmentError):
        raise ValueError("must hold stress and motion at the same points") from None


def _at_receivers(
    time: np.ndarray, waves: Mapping[Any, np.ndarray], receiver: str, components: str
) -> xr.Dataset:
    quantities, axes, places = (list(dict.fromkeys(keys)) for keys in zip(*waves, strict=True))
    if len(waves) < len(quantities) * len(places) * len(axes):
        raise ValueError("must hold the same components at every receiver")
    known = [(np.nan,) if isinstance(at, str) else at for at in places]
    sizes = {0 if isinstance(at, str) else len(at) for at in places}
    if len(sizes) > 1:
        raise ValueError("must name the places of all its columns, or of none")
    receiver = "point" if sizes & {2, 3} else receiver
    found = xr.Dataset(coords={"time": time, components: axes})
    for quantity in quantities:
        rows = [[waves[quantity, axis, at] for axis in axes] for at in places]
        found[quantity] = (receiver, components, "time"), np.array(rows)
    names = zip(RECEIVERS[receiver], np.transpose(known), strict=False)  # z in space
    found = found.assign_coords({name: (receiver, at) for name, at in names})
    return found.transpose(receiver, "time", components)


def _even(result: xr.Dataset) -> xr.Dataset:
    """Return a recording at equal intervals, resampled linearly at its smallest if uneven."""
    time = result["time"].values
    if len(time) < 2 or not (np.diff(time) > 0).all():
        raise SceneError("recording", "time", None, "must hold at least two times that increase")
    for name, values in result.items():
        if not np.isfinite(values).all():
            raise SceneError("recording", str(name), None, "must be finite numbers")
    steps = np.diff(time)
    if np.abs(time - np.linspace(time[0], time[-1], len(time))).max() <= UNEVEN * steps.min():
        return result
    count = round((time[-1] - time[0]) / steps.min()) + 1
    if count > MOST_SAMPLES:
        allowed = f"is {steps.min():g} s; must give at most {MOST_SAMPLES:,} samples"
        raise SceneError("recording", "smallest interval", None, allowed)
    return result.interp(time=np.linspace(time[0], time[-1], count))


def sampling(of: xr.DataArray | xr.Dataset) -> float:
    """Return the time between samples, s."""
    time = of["time"].values
    return float(time[-1] - time[0]) / (len(time) - 1)


def variables(
    dims: str | tuple[str, ...], named: dict[str, tuple[np.ndarray, str, str]]
) -> dict[str, xr.Variable]:
    """Return variables by name from values, long names and units."""
    return {
        name: xr.Variable(dims, values, {"long_name": words, "units": unit})
        for name, (values, words, unit) in named.items()
    }
