"""External waveforms of `jointwave compare --with`: quantity, receiver, sign and unit.

A column is called [-]QUANTITY[_COMPONENT]@Y [UNIT]: `stress@20`, `-stress@20 [MPa]`,
`velocity_x@20.25 [mm/s]`; velocity and displacement are along y where no component is named. Of a
rock mass it is QUANTITY[_COMPONENT]@[X,Y]: `velocity_x@[20,30]`, `stress_xx@[20,30] [MPa]`,
`traction_n@[20,20]`, `gap@[20,20]`; in a CSV file a header that contains a comma is quoted.
Stress is positive in compression and motion along +x, +y, +z; a minus sign marks a column with the
opposite sign, e.g. tension positive. Without a unit, SI. A column with another header is selected
by COLUMN=LABEL (`compare.misfit.external_columns`).
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.records import Column, Columns, read_columns
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.units import TIME, UNITS, split_unit
from jointwave.cases.warnings import look_like_milliseconds
from jointwave.compare.engines import names
from jointwave.compare.misfit.external_columns import Asked, Heading, asked, heading
from jointwave.compare.misfit.external_netcdf import is_netcdf, read_netcdf
from jointwave.compare.misfit.places import QUANTITIES, Place, recorded, same

LEAST_SAMPLES = 3  # needed for a parabola through the peak of a correlation
EXAMPLES = "stress@20, -stress@20 [MPa] or velocity_x@20.25 [mm/s]"
EXAMPLES_IN_PLANE = "velocity_x@[20,30], -stress_xx@[20,30] [MPa] or traction_n@[20,20]"


@dataclass(frozen=True)
class Curves:
    """Waveforms of one file over one time.

    name : its name in tables. file : the path, as given. time : [n] s, strictly increasing.
    waveforms : [n] by place, SI, compression positive. timed : whether the file or the command
    gives the unit of its times.
    """

    name: str
    file: str
    time: np.ndarray
    waveforms: dict[Place, np.ndarray]
    timed: bool = True


def read_curves(texts: list[str], scenes: Sequence[AnyScene]) -> list[Curves]:
    """Read the arguments of `--with`, each FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL.

    FILE is NetCDF, written by `jointwave run` or with `time` and, for example, `stress`; or a table
    or seismogram as `cases.records` reads them, a header `time [ms], stress@20 [MPa]` or two bare
    columns, time in s first. LABEL selects one of several curves, or labels the only one; COLUMN is
    a header. Empty cells are skipped. One entry per file, and per set of times in it.

    Raises SceneError for a file that cannot be read, is not in this format, or has no curve at a
    receiver of one of the scenes.
    """
    every = [asked(text, _is_label) for text in texts]
    files = dict.fromkeys(str(one.path) for one in every)
    short = Counter(Path(file).name for file in files) + Counter(names())
    found: list[Curves] = []
    for file in files:
        name = Path(file).name
        mine = [one for one in every if str(one.path) == file]
        found += _of_file(name if short[name] == 1 else file, mine)
    for one in found:
        _require_recorded(one, scenes)
    return found


def slips(curves: Sequence[Curves], scene: AnyScene) -> Iterator[str]:
    """Yield which curves of a scene have times without a unit that look like milliseconds."""
    end = scene.time.duration
    for one in curves:
        loudest = max(one.waveforms.values(), key=lambda values: np.ptp(values))
        slip = look_like_milliseconds(one.time, loudest - loudest[0], end)
        if slip and not one.timed:
            yield (
                f"{one.file}: its times, up to {one.time[-1]:g} s, look like milliseconds (the "
                f"scene ends at {end:g} s): a header time [ms] says so"
            )


def is_recorded(place: Place, scene: AnyScene) -> bool:
    """Return whether a scene has a receiver at this place."""
    return any(same(place.at, one) for one in recorded(scene, place.key))


def _require_recorded(curves: Curves, scenes: Sequence[AnyScene]) -> None:
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
    path, times = every[0].path, [one for one in every if one.is_time]
    wanted = [one for one in every if not one.is_time] or [Asked(str(path), path)]
    try:
        if is_netcdf(path):
            table = read_netcdf(path, LEAST_SAMPLES)
        else:
            table = read_columns(path, times[0].column if times else "time", LEAST_SAMPLES)
        unit = (split_unit(times[0].label)[1] if times else "") or table.time.unit
        seconds = table.time._replace(unit=unit).si(TIME)
        found = [one for choice in wanted for one in _fitting(table, choice)]
    except SceneError:
        raise
    except ValueError as error:
        raise SceneError(str(path), "", None, str(error)) from None
    groups: dict[bytes, dict[Place, np.ndarray]] = {}  # by the cells that are empty
    for place, values in found:
        group = groups.setdefault(np.isnan(values).tobytes(), {})
        if place in group:
            raise SceneError(str(path), "", None, f"{place} must be given only once")
        group[place] = values
    curves: list[Curves] = []
    for group in groups.values():
        place, values = next(iter(group.items()))
        there = ~np.isnan(values)
        if there.sum() < LEAST_SAMPLES:
            allowed = f"must hold at least {LEAST_SAMPLES} samples, not {there.sum()}"
            raise SceneError(str(path), str(place), None, allowed)
        called = f"{name}:{place}" if curves else name
        waveforms = {place: values[there] for place, values in group.items()}
        curves.append(Curves(called, str(path), seconds[there], waveforms, bool(unit)))
    return curves


def _fitting(table: Columns, choice: Asked) -> list[tuple[Place, np.ndarray]]:
    """Return the waveforms of a file selected by one argument, [n] in SI, nan where cells are
    empty."""
    wanted = _label(choice.label) if choice.label else None
    named = [c for c in table.rest if not choice.column or choice.fits(c)]
    alone = len(table.rest) == 1 or bool(choice.column and len(named) == 1)
    found = []
    for column in named:
        own = heading(column.name)
        if wanted is not None:
            own = _as_wanted(column, own, wanted, alone)
            column = column._replace(unit=split_unit(choice.label)[1] or column.unit)
        elif own.place is None:
            raise _without_place(column, choice, table)
        if own.place is not None:
            found.append((own.place, own.sign * column.si(UNITS[own.place.quantity])))
    if not found:
        raise _not_there(choice, table)
    return found


def _as_wanted(column: Column, own: Heading, wanted: Heading, alone: bool) -> Heading:
    """Return the heading of a column, which may have its own; without a place if another one is
    requested."""
    assert wanted.place is not None
    if own.place is not None:
        fits = own.place[:2] == wanted.place[:2] and same(own.place.at, wanted.place.at)
        return own._replace(sign=min(own.sign, wanted.sign)) if fits else Heading(None)
    bare = column.name.lower()
    said = bare if bare in QUANTITIES else ""
    fits = said == wanted.place.quantity or (alone and not said)
    return wanted if fits else Heading(None)


def _without_place(column: Column, choice: Asked, table: Columns) -> SceneError:
    which = f"{column.name}=" if column.name else ""
    allowed = (
        f"must be named as {EXAMPLES}, in a rock mass as {EXAMPLES_IN_PLANE}, or its place be "
        f"given as {choice.path}:{which}stress@20; the file holds {_listed(table)}"
    )
    return SceneError(str(choice.path), column.name or "second column", None, allowed)


def _not_there(choice: Asked, table: Columns) -> SceneError:
    held = f"{choice.path} holds {_listed(table)}"
    if choice.column:
        allowed = f"must be a label, such as {EXAMPLES}, a column or COLUMN=LABEL; {held}"
        return SceneError("--with", choice.text, None, f"{choice.column!r} {allowed}")
    wanted = _label(choice.label).place or "a label"
    return SceneError("--with", choice.text, None, f"{held}; {wanted} must be one of them")


def _listed(table: Columns) -> str:
    return ", ".join(column.name or "one column without a name" for column in table.rest)


def _is_label(text: str) -> bool:
    return _label(text).place is not None


def _label(text: str) -> Heading:
    """Return what a label says, [-]QUANTITY[_COMPONENT]@PLACE [UNIT], without its unit."""
    return heading(split_unit(text)[0])
