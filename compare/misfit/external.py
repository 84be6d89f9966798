"""External waveforms of `jointwave compare --with`: quantity, receiver, sign and unit.

A column is called [-]QUANTITY[_COMPONENT]@Y [UNIT]: `stress@20`, `-stress@20 [MPa]`,
`velocity_x@20.25 [mm/s]`; velocity and displacement are along y where no component is named. Of a
rock mass it is QUANTITY[_COMPONENT]@[X,Y]: `velocity_x@[20,30]`, `stress_xx@[20,30] [MPa]`,
`traction_n@[20,20]`, `gap@[20,20]`; in a CSV file a header that contains a comma is quoted.
Stress is positive in compression and motion along +x, +y, +z; a minus sign marks a column with the
opposite sign, e.g. tension positive. Without a unit, SI. A column with another header is selected
by COLUMN=LABEL, and one of a table of `jointwave compare --out` by its solution
(`compare.misfit.external_columns`).
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.engines import names
from compare.misfit.external_columns import Asked, asked, base_of, exported, listed
from compare.misfit.external_files import (
    LEAST_SAMPLES,
    Column,
    Columns,
    read_columns,
    split_unit,
)
from compare.misfit.places import Place, parsed, recorded, same

MICRO = ("u", "µ", "μ")  # as typed, the micro sign, and the Greek letter

TIME = {"s": 1.0, "ms": 1e-3, "ns": 1e-9} | {f"{u}s": 1e-6 for u in MICRO}
# xarray's names for the units of its durations.
TIME |= {"seconds": 1.0, "milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9}
STRESS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
LENGTH = {"m": 1.0, "cm": 1e-2, "mm": 1e-3} | {f"{u}m": 1e-6 for u in MICRO}
SPEED = {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3}
ANGLE = {"rad": 1.0, "mrad": 1e-3, "deg": pi / 180} | {f"{u}rad": 1e-6 for u in MICRO}

#: By quantity: its units, each with its factor to SI.
UNITS = {
    "stress": STRESS,
    "shear": STRESS,
    "traction": STRESS,
    "velocity": SPEED,
    "displacement": LENGTH,
    "gap": LENGTH,
    "slip": LENGTH,
    "rotation": ANGLE,
}
EXAMPLES = "stress@20, -stress@20 [MPa] or velocity_x@20.25 [mm/s]"
EXAMPLES_IN_PLANE = "velocity_x@[20,30], -stress_xx@[20,30] [MPa] or traction_n@[20,20]"


@dataclass(frozen=True)
class Curves:
    """Waveforms of one file over one time.

    name : its name in tables. file : the path, as given. time : [n] s, strictly increasing.
    waveforms : [n] by place, SI, compression positive. variant : the scene's variant that it
    belongs to, "" for the base scene; None: to every variant.
    """

    name: str
    file: str
    time: np.ndarray
    waveforms: dict[Place, np.ndarray]
    variant: str | None = None

    def holds_for(self, scene: AnyScene) -> bool:
        """Return whether the curves belong to this variant of a scene."""
        return self.variant is None or self.variant == scene.name


class _Label(NamedTuple):
    place: Place
    negative: bool
    unit: str


class _Found(NamedTuple):
    """A column, its quantity, and its solution in a table of jointwave."""

    column: Column
    label: _Label
    solution: str = ""
    variant: str = ""


def read_curves(texts: list[str], scenes: Sequence[AnyScene]) -> list[Curves]:
    """Read the arguments of `--with`, each FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL.

    FILE is NetCDF (.nc), written by `jointwave run` or with `time` and, for example, `stress`; or
    CSV: comma, semicolon or tab, # comments, a header `time [ms], stress@20 [MPa]` or two bare
    columns, time in s first; or a table of `jointwave compare --out`. LABEL selects one of several
    curves, or labels the only one; COLUMN is a header, or a solution or variant of such a table.
    Empty cells are skipped. One entry per file; one each for the solutions, variants, or columns
    with different times of a file. Raises SceneError for a file that cannot be read, is not in this
    format, or has no curve at a receiver of one of the scenes.
    """
    every = [asked(text, lambda label: _parse(*split_unit(label)) is not None) for text in texts]
    files = dict.fromkeys(str(one.path) for one in every)
    short = Counter(Path(file).name for file in files) + Counter(names())
    found: list[Curves] = []
    for file in files:
        name = Path(file).name
        mine = [one for one in every if str(one.path) == file]
        found += _of_file(name if short[name] == 1 else file, mine)
    for one in found:
        _require_recorded(one, [s for s in scenes if one.holds_for(s)])
    return [one for one in found if any(map(one.holds_for, scenes))]


def is_recorded(place: Place, scene: AnyScene) -> bool:
    """Return whether a scene has a receiver at this place."""
    return any(same(place.at, one) for one in recorded(scene, place.key))


def _require_recorded(curves: Curves, scenes: list[AnyScene]) -> None:
    if not scenes or any(is_recorded(p, scene) for p in curves.waveforms for scene in scenes):
        return
    place, scene = next(iter(curves.waveforms)), scenes[0]
    key = place.key
    if not hasattr(scene.record, key):
        wanted = EXAMPLES if scene.kind == "pillar" else EXAMPLES_IN_PLANE
        allowed = f"is not a receiver of a {scene.kind}; columns are named as {wanted}"
        raise SceneError(curves.file, str(place), None, allowed)
    held = ", ".join(place._replace(at=one).receiver for one in recorded(scene, key))
    allowed = (
        f"must be at a receiver of the scene: {key} at {held or 'none'}; "
        f"record.{key} in the scene, or --set, adds a receiver"
    )
    raise SceneError(curves.file, str(place), None, allowed)


def _of_file(name: str, every: list[Asked]) -> list[Curves]:
    path = every[0].path
    times = [one for one in every if one.is_time]
    table = read_columns(path, times[0].column if times else "time")
    unit = split_unit(times[0].label)[1] if times else ""
    seconds = _factor(path, "time", unit or table.time.unit, TIME) * table.time.values
    wanted = [one for one in every if not one.is_time] or [Asked(str(path), path)]
    found = [one for choice in wanted for one in _fitting(table, choice)]
    groups: dict[tuple, dict[Place, _Found]] = {}
    for one in found:
        there = b"" if one.column.empty is None else one.column.empty.tobytes()
        group = groups.setdefault((one.solution, one.variant, there), {})
        if one.label.place in group:
            raise SceneError(str(path), "", None, f"{one.label.place} must be given only once")
        group[one.label.place] = one
    several = len({solution for solution, *_ in groups}) > 1
    named: Counter[tuple] = Counter()
    curves = []
    for (solution, variant, _), group in groups.items():
        called = f"{name}:{solution}" if several else name
        named[called, variant] += 1
        if named[called, variant] > 1:  # same name, different times
            called = f"{called}:{next(iter(group))}"
        whose = variant if len({v for _, v, _ in groups}) > 1 else None
        curves.append(_curves(called, path, seconds, list(group.values()), whose))
    return curves


def _curves(
    name: str, path: Path, seconds: np.ndarray, found: list[_Found], variant: str | None
) -> Curves:
    empty = found[0].column.empty
    there = np.ones(len(seconds), bool) if empty is None else ~empty
    if there.sum() < LEAST_SAMPLES:
        allowed = f"must hold at least {LEAST_SAMPLES} samples, not {there.sum()}"
        raise SceneError(str(path), found[0].column.name, None, allowed)
    waveforms = {}
    for column, label, *_ in found:
        factor = _factor(path, column.name, label.unit, UNITS[label.place.quantity])
        waveforms[label.place] = (-factor if label.negative else factor) * column.values[there]
    return Curves(name, str(path), seconds[there], waveforms, variant)


def _fitting(table: Columns, choice: Asked) -> list[_Found]:
    """Return the columns of a file selected by one argument, with their quantities."""
    wanted = _parse(*split_unit(choice.label)) if choice.label else None
    named = [c for c in table.rest if not choice.column or choice.fits(c)]
    alone = len(table.rest) == 1 or bool(choice.column and len(named) == 1)
    found, base = [], base_of(table.rest)
    for column in named:
        ours = exported(column.name)
        own = _parse(ours.label if ours else column.name, column.unit)
        label = own if wanted is None else _as_wanted(column, own, wanted, alone)
        if label is not None and ours:
            variant = "" if ours.variant == base else ours.variant
            found.append(_Found(column, label, ours.solution, variant))
        elif label is not None:
            found.append(_Found(column, label))
        elif wanted is None:
            raise _without_place(column, choice, table)
    if not found:
        raise _not_there(choice, table)
    return found


def _as_wanted(column: Column, own: _Label | None, wanted: _Label, alone: bool) -> _Label | None:
    """Return the label of a column, which may have its own; None if another one is requested."""
    unit = wanted.unit or column.unit
    if own is not None:
        (*what, at), (*wanted_what, wanted_at) = own.place, wanted.place
        fits = what == wanted_what and same(at, wanted_at)
        return _Label(own.place, own.negative or wanted.negative, unit) if fits else None
    bare = column.name.lower()
    fits = bare == wanted.place.quantity or (alone and bare not in UNITS)
    return wanted._replace(unit=unit) if fits else None


def _without_place(column: Column, choice: Asked, table: Columns) -> SceneError:
    which = f"{column.name}=" if column.name else ""
    allowed = (
        f"must be named as {EXAMPLES}, in a rock mass as {EXAMPLES_IN_PLANE}, or its place be "
        f"given as {choice.path}:{which}stress@20; "
        f"the file holds {listed(table.rest)}"
    )
    return SceneError(str(choice.path), column.name or "second column", None, allowed)


def _not_there(choice: Asked, table: Columns) -> SceneError:
    held = f"{choice.path} holds {listed(table.rest)}"
    if choice.column:
        allowed = f"must be a label, such as {EXAMPLES}, a column or COLUMN=LABEL; {held}"
        return SceneError("--with", choice.text, None, f"{choice.column!r} {allowed}")
    label = _parse(*split_unit(choice.label))
    wanted = label.place if label else "a label"
    return SceneError("--with", choice.text, None, f"{held}; {wanted} must be one of them")


def _parse(name: str, unit: str) -> _Label | None:
    """Return [-]QUANTITY[_COMPONENT]@PLACE as a label; None if the name is not a label."""
    text = name.strip()
    place = parsed(text.removeprefix("-").lstrip())
    return None if place is None else _Label(place, text.startswith("-"), unit)


def _factor(path: Path, name: str, unit: str, allowed: dict[str, float]) -> float:
    if unit and unit not in allowed:
        raise SceneError(str(path), f"unit of {name}", unit, f"must be {', '.join(allowed)}")
    return allowed.get(unit, 1.0)
