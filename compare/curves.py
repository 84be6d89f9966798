"""Waveforms of others, as `jointwave compare --with` names them: quantity, place, sign and unit.

A column is called [-]QUANTITY[_AXIS]@Y [UNIT]: `stress@20`, `-stress@20 [MPa]`,
`velocity_x@20.25 [mm/s]`; velocity and displacement are along y where no axis is named. Stress is
positive in compression and motion along +x, +y, +z; a minus sign says that the column holds the
negative, as where tension is positive. Without a unit, SI.
"""

import re
from collections import Counter
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from cases.errors import SceneError
from cases.scene import Scene
from compare.curvefiles import DIMENSIONS, Column, read_columns, split_unit
from compare.engines import names

MICRO = ("u", "µ", "μ")  # as typed, the micro sign, and the Greek letter

TIME = {"s": 1.0, "ms": 1e-3, "ns": 1e-9} | {f"{u}s": 1e-6 for u in MICRO}
# What xarray calls the units of its own durations.
TIME |= {"seconds": 1.0, "milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9}
STRESS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3} | {f"{u}m": 1e-6 for u in MICRO}
SPEED = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}
ANGLE = {"rad": 1.0, "mrad": 1e-3, "deg": pi / 180} | {f"{u}rad": 1e-6 for u in MICRO}

#: By quantity: its units, each with its factor to SI, and its axes.
UNITS = {
    "stress": STRESS,
    "shear": STRESS,
    "velocity": SPEED,
    "displacement": LENGTH,
    "rotation": ANGLE,
}
AXES = {
    "stress": ("",),
    "shear": ("x", "z"),
    "velocity": ("x", "y", "z"),
    "displacement": ("x", "y", "z"),
    "rotation": ("x", "y", "z"),
}

LABEL = re.compile(r"(-?)\s*([A-Za-z]+)(?:_([xyz]))?\s*@\s*([0-9.eE+-]+)(?:\s*m)?")
EXAMPLES = "stress@20, -stress@20 [MPa] or velocity_x@20.25 [mm/s]"


class Place(NamedTuple):
    """What a waveform is: the quantity, its axis (empty for stress), and y of its receiver, m."""

    quantity: str
    axis: str
    y: float

    def __str__(self) -> str:
        return f"{self.quantity}{'_' * bool(self.axis)}{self.axis}@{self.y:.12g}"

    @property
    def key(self) -> str:
        """The key of [record] that asks for it."""
        return "stress" if DIMENSIONS[self.quantity][0] == "stress_y" else "velocity"

    def waveform(self, result: xr.Dataset) -> np.ndarray | None:
        """Return this waveform of a result [n] in SI; None where the result does not have it."""
        receivers, components = DIMENSIONS[self.quantity]
        if self.quantity not in result:
            return None
        found = result[self.quantity]
        at = np.flatnonzero(_same(found[receivers].values, self.y))
        axes = [str(a) for a in found[components].values] if components in found.dims else [""]
        if not len(at) or self.axis not in axes:
            return None
        values = found.values[at[0]]
        return values if axes == [""] else values[:, axes.index(self.axis)]


@dataclass(frozen=True)
class Curves:
    """The waveforms of one file.

    name : what tables call it. file : the path, as it was given. time : [n] s, strictly increasing.
    waveforms : [n] by place, SI, compression positive.
    """

    name: str
    file: str
    time: np.ndarray
    waveforms: dict[Place, np.ndarray]


class _Label(NamedTuple):
    place: Place
    negative: bool
    unit: str


def read_curves(texts: list[str], scenes: list[Scene]) -> list[Curves]:
    """Read what `--with` names, each FILE or FILE:LABEL, one entry a file.

    FILE is NetCDF (.nc), as `jointwave run` writes it or any that has `time` and, say, `stress`; or
    CSV: comma, semicolon or tab, # comments, a header `time [ms], stress@20 [MPa]` or two bare
    columns, time in s first. LABEL takes one curve out of several, or names the only one.
    Raises SceneError for a file that cannot be read, is not as stated, or has no curve at a
    receiver that one of the scenes records.
    """
    found: dict[str, Curves] = {}
    for text in texts:
        one = _read(text)
        if one.file in found:
            both = found[one.file].waveforms
            if twice := both.keys() & one.waveforms:
                raise SceneError(text, "", None, f"{min(twice)} must be given once only")
            one = replace(one, waveforms=both | one.waveforms)
        found[one.file] = one
    for one in found.values():
        _require_recorded(one, scenes)
    short = Counter(one.name for one in found.values()) + Counter(names())
    return [c if short[c.name] == 1 else replace(c, name=c.file) for c in found.values()]


def is_recorded(place: Place, scene: Scene) -> bool:
    """Return whether a scene has a receiver at this place."""
    return bool(_same(np.array(getattr(scene.record, place.key), dtype=float), place.y).any())


def _require_recorded(curves: Curves, scenes: list[Scene]) -> None:
    if any(is_recorded(place, scene) for place in curves.waveforms for scene in scenes):
        return
    place = next(iter(curves.waveforms))
    recorded = ", ".join(f"{y:g}" for y in getattr(scenes[0].record, place.key)) or "nowhere"
    allowed = (
        f"must be where the scene records: {place.key} at {recorded} m; "
        f"record.{place.key} in the scene, or --set, adds a receiver"
    )
    raise SceneError(curves.file, str(place), None, allowed)


def _read(text: str) -> Curves:
    path, wanted = _split(text)
    table = read_columns(path)
    waveforms: dict[Place, np.ndarray] = {}
    for column in table.rest:
        label = _label(path, column, len(table.rest) == 1, wanted)
        if label is None:
            continue
        if label.place in waveforms:
            raise SceneError(str(path), "", None, f"{label.place} must be there once only")
        factor = _factor(path, column.name, label.unit, UNITS[label.place.quantity])
        waveforms[label.place] = (-factor if label.negative else factor) * column.values
    if wanted and not waveforms:
        held = ", ".join(c.name or "one column" for c in table.rest)
        raise SceneError(str(path), "", None, f"holds {held}; {wanted.place} must be one of them")
    time = _factor(path, "time", table.time.unit, TIME) * table.time.values
    return Curves(path.name, str(path), time, waveforms)


def _split(text: str) -> tuple[Path, _Label | None]:
    """Return the file and the label, None without one, of FILE or FILE:LABEL."""
    file, colon, label = text.rpartition(":")
    if not colon or Path(text).exists() or not ("@" in label or Path(file).exists()):
        return Path(text), None
    found = _parse(*split_unit(label))
    if found is None:
        raise SceneError("--with", text, None, f"{label!r} must be a label, such as {EXAMPLES}")
    return Path(file), found


def _label(path: Path, column: Column, alone: bool, wanted: _Label | None) -> _Label | None:
    """Return what a column holds; None where another one is wanted."""
    own = _parse(column.name, column.unit)
    if wanted is None:
        if own is None:
            name = column.name or "second column"
            allowed = f"must be called as {EXAMPLES}, or its place be given as {path}:stress@20"
            raise SceneError(str(path), name, None, allowed)
        return own
    unit = wanted.unit or column.unit
    if own is not None:
        if own.place != wanted.place:
            return None
        return _Label(own.place, own.negative or wanted.negative, unit)
    bare = column.name.lower()
    fits = bare == wanted.place.quantity or (alone and bare not in UNITS)
    return wanted._replace(unit=unit) if fits else None


def _parse(name: str, unit: str) -> _Label | None:
    """Return [-]QUANTITY[_AXIS]@Y as a label; None where the name is none."""
    match = LABEL.fullmatch(name.strip())
    if match is None or match[2].lower() not in UNITS:
        return None
    quantity = match[2].lower()
    axis = match[3] or ("y" if quantity in ("velocity", "displacement") else "")
    try:
        place = Place(quantity, axis, float(match[4]))
    except ValueError:
        return None
    return _Label(place, bool(match[1]), unit) if axis in AXES[quantity] else None


def _factor(path: Path, name: str, unit: str, allowed: dict[str, float]) -> float:
    if unit and unit not in allowed:
        raise SceneError(str(path), f"unit of {name}", unit, f"must be {', '.join(allowed)}")
    return allowed.get(unit, 1.0)


def _same(places: np.ndarray, y: float) -> np.ndarray:
    return np.isclose(places, y, rtol=1e-9, atol=1e-9)
