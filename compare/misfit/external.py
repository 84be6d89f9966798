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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.records import Column, Columns, read_columns
from cases.units import TIME, UNITS, split_unit
from cases.warnings import look_like_milliseconds
from compare.engines import names
from compare.misfit.external_columns import Asked, asked, base_of, exported, listed
from compare.misfit.external_netcdf import is_netcdf, read_netcdf
from compare.misfit.places import QUANTITIES, Place, parsed, recorded, same

LEAST_SAMPLES = 3  # needed for a parabola through the peak of a correlation
EXAMPLES = "stress@20, -stress@20 [MPa] or velocity_x@20.25 [mm/s]"
EXAMPLES_IN_PLANE = "velocity_x@[20,30], -stress_xx@[20,30] [MPa] or traction_n@[20,20]"


@dataclass(frozen=True)
class Curves:
    """Waveforms of one file over one time.

    name : its name in tables. file : the path, as given. time : [n] s, strictly increasing.
    waveforms : [n] by place, SI, compression positive. variant : the scene's variant that it
    belongs to, "" for the base scene; None: to every variant. timed : whether the file or the
    command gives the unit of its times.
    """

    name: str
    file: str
    time: np.ndarray
    waveforms: dict[Place, np.ndarray]
    variant: str | None = None
    timed: bool = True

    def holds_for(self, scene: AnyScene) -> bool:
        """Return whether the curves belong to this variant of a scene."""
        return self.variant is None or self.variant == scene.name


class _Found(NamedTuple):
    """The waveform of a column [n] in SI, nan where it is empty, and its solution and variant in a
    table of jointwave."""

    place: Place
    values: np.ndarray
    solution: str = ""
    variant: str = ""


def read_curves(texts: list[str], scenes: Sequence[AnyScene]) -> list[Curves]:
    """Read the arguments of `--with`, each FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL.

    FILE is NetCDF, written by `jointwave run` or with `time` and, for example, `stress`; or a table
    or seismogram as `cases.records` reads them, a header `time [ms], stress@20 [MPa]` or two bare
    columns, time in s first; or a table of `jointwave compare --out`. LABEL selects one of several
    curves, or labels the only one; COLUMN is a header, or a solution or variant of such a table.
    Empty cells are skipped. One entry per file; one each for the solutions, variants, or columns
    with different times of a file. Raises SceneError for a file that cannot be read, is not in this
    format, or has no curve at a receiver of one of the scenes.
    """
    every = [asked(text, lambda label: _label(label) is not None) for text in texts]
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


def slips(curves: Sequence[Curves], scene: AnyScene) -> Iterator[str]:
    """Yield which curves of a scene have times without a unit that look like milliseconds."""
    end = scene.time.duration
    for one in curves:
        loudest = max(one.waveforms.values(), key=lambda values: np.ptp(values))
        slip = look_like_milliseconds(one.time, loudest - loudest[0], end)
        if slip and not one.timed and one.holds_for(scene):
            yield (
                f"{one.file}: its times, up to {one.time[-1]:g} s, look like milliseconds (the "
                f"scene ends at {end:g} s): a header time [ms] says so"
            )


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
    groups: dict[tuple, dict[Place, np.ndarray]] = {}
    for place, values, *whose in found:
        group = groups.setdefault((*whose, np.isnan(values).tobytes()), {})
        if place in group:
            raise SceneError(str(path), "", None, f"{place} must be given only once")
        group[place] = values
    several, variants = (len({key[i] for key in groups}) > 1 for i in (0, 1))
    curves, named = [], Counter[tuple]()
    for (solution, variant, _), group in groups.items():
        called, place = f"{name}:{solution}" if several else name, next(iter(group))
        named[called, variant] += 1
        if named[called, variant] > 1:  # same name, different times
            called = f"{called}:{place}"
        there = ~np.isnan(group[place])
        if there.sum() < LEAST_SAMPLES:
            allowed = f"must hold at least {LEAST_SAMPLES} samples, not {there.sum()}"
            raise SceneError(str(path), str(place), None, allowed)
        waveforms = {place: values[there] for place, values in group.items()}
        of_variant = variant if variants else None
        curves.append(Curves(called, str(path), seconds[there], waveforms, of_variant, bool(unit)))
    return curves


def _fitting(table: Columns, choice: Asked) -> list[_Found]:
    """Return the waveforms of a file selected by one argument."""
    wanted = _label(choice.label) if choice.label else None
    named = [c for c in table.rest if not choice.column or choice.fits(c)]
    alone = len(table.rest) == 1 or bool(choice.column and len(named) == 1)
    found, base = [], base_of(table.rest)
    for column in named:
        ours = exported(column.name)
        place, sign = own = _place(ours.label if ours else column.name)
        if wanted is not None:
            place, sign = _as_wanted(column, own, wanted, alone)
            column = column._replace(unit=split_unit(choice.label)[1] or column.unit)
        elif place is None:
            raise _without_place(column, choice, table)
        if place is not None:
            values = sign * column.si(UNITS[place.quantity])
            variant = "" if ours is None or ours.variant == base else ours.variant
            found.append(_Found(place, values, ours.solution if ours else "", variant))
    if not found:
        raise _not_there(choice, table)
    return found


_Label = tuple[Place | None, float]  # and the sign of a column's values


def _as_wanted(column: Column, own: _Label, wanted: _Label, alone: bool) -> _Label:
    """Return the label of a column, which may have its own; None if another one is requested."""
    if own[0] is not None and wanted[0] is not None:
        fits = own[0][:2] == wanted[0][:2] and same(own[0].at, wanted[0].at)
        return (own[0], min(own[1], wanted[1])) if fits else (None, 1.0)
    bare = column.name.lower()
    said = bare if bare in QUANTITIES else ""
    fits = wanted[0] is not None and (said == wanted[0].quantity or (alone and not said))
    return wanted if fits else (None, 1.0)


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
    label = _label(choice.label)
    wanted = label[0] if label else "a label"
    return SceneError("--with", choice.text, None, f"{held}; {wanted} must be one of them")


def _label(text: str) -> _Label | None:
    """Return [-]QUANTITY[_COMPONENT]@PLACE [UNIT] as place and sign; None for what is none."""
    found = _place(split_unit(text)[0])
    return None if found[0] is None else found


def _place(name: str) -> _Label:
    text = name.strip()
    return parsed(text.removeprefix("-").lstrip()), -1.0 if text.startswith("-") else 1.0
