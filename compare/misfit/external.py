"""External waveforms of `jointwave compare --with`: quantity, receiver, sign and unit.

A column is called [-]QUANTITY[_COMPONENT]@Y [UNIT]: `stress@20`, `-stress@20 [MPa]`,
`velocity_x@20.25 [mm/s]`; velocity and displacement are along y where no component is named. Of a
rock mass it is QUANTITY[_COMPONENT]@[X,Y]: `velocity_x@[20,30]`, `stress_xx@[20,30] [MPa]`,
`traction_n@[20,20]`, `gap@[20,20]`; in a CSV file a header that contains a comma is quoted.
Stress is positive in compression and motion along +x, +y, +z; a minus sign marks a column with the
opposite sign, e.g. tension positive. Without a unit, SI. A column with another header is selected
by COLUMN=LABEL.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.records import Column, Columns, read_columns
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.units import TIME, UNITS, split_unit
from jointwave.cases.warnings.sources import look_like_milliseconds
from jointwave.compare.engines import names
from jointwave.compare.misfit.external_netcdf import is_netcdf, read_netcdf
from jointwave.compare.misfit.places import LABEL, Place, parsed, recorded, same
from jointwave.compare.scenes import AnySource, load
from jointwave.results.labels import QUANTITIES

READ_CURVES = "curves of `read_curves`"  # what functions accept
LEAST_SAMPLES = 3  # needed for a parabola through the peak of a correlation
#: Names of columns, by the kind of the scene.
EXAMPLES = {
    "pillar": "stress@20, -stress@20 [MPa] or velocity_x@20.25 [mm/s]",
    "rock mass": "velocity_x@[20,30], -stress_xx@[20,30] [MPa] or traction_n@[20,20]",
}


@dataclass(frozen=True)
class Curves:
    """Waveforms of one file over one time.

    name : its name in tables. file : the path, as given. time : [n] s, strictly increasing.
    waveforms : [n] by place, SI, compression positive. timed : whether the file or the command
    gives the unit of its times. bare : the places whose waveform has no unit, and is taken as SI.
    """

    name: str
    file: str
    time: np.ndarray
    waveforms: dict[Place, np.ndarray]
    timed: bool = True
    bare: frozenset[Place] = frozenset()


class Selection(NamedTuple):
    """One argument of `--with`: column and label are empty if not given."""

    text: str
    path: Path
    column: str = ""
    label: str = ""

    @property
    def is_time(self) -> bool:
        """Whether it selects the column of times."""
        return split_unit(self.label)[0].lower() == "time"

    def fits(self, column: Column) -> bool:
        """Return whether a column is the one selected, or none is."""
        headers = ("", column.name, f"{column.name} [{column.unit}]")
        return self.column in headers or split_unit(self.column) == (column.name, column.unit)


def selection(text: str) -> Selection:
    """Return a parsed argument, FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL."""
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


def read_curves(
    texts: str | Sequence[str], scenes: "AnySource | Sequence[AnySource]"
) -> list[Curves]:
    """Read arguments of `--with`, each FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL, for one
    or several scenes.

    FILE is NetCDF, as `jointwave run` writes it; or a table
    or seismogram as `cases.records` reads them, a header `time [ms], stress@20 [MPa]` or two bare
    columns, time in s first. LABEL selects one of several curves, or labels the only one; COLUMN is
    a header. Empty cells are skipped. One entry per file, and per set of times in it.

    Raises SceneError for a file that cannot be read, is not in this format, or has no curve at a
    receiver of one of the scenes.
    """
    files: dict[Path, list[Selection]] = {}
    for one in map(selection, [texts] if isinstance(texts, str) else texts):
        files.setdefault(one.path, []).append(one)
    short = Counter(path.name for path in files) + Counter(names())
    found: list[Curves] = []
    for path, wanted in files.items():
        try:
            found += _of_file(path.name if short[path.name] == 1 else str(path), wanted)
        except SceneError:
            raise
        except ValueError as error:
            raise SceneError(str(path), "", None, str(error)) from None
    asked: Any = scenes if isinstance(scenes, list | tuple) else [scenes]
    for curves in found:
        _require_recorded(curves, [load(one) for one in asked])
    return found


def doubts(curves: Sequence[Curves], scene: AnyScene) -> Iterator[str]:
    """Yield which curves lie at no receiver of a scene, and which have times without a unit that
    look like milliseconds."""
    end = scene.time.duration
    for one in curves:
        for place in one.waveforms:
            if not any(same(place.at, at) for at in recorded(scene, place.key)):
                yield f"{one.file}: {place} is at no receiver of the scene, and left out"
        loudest = max(one.waveforms.values(), key=lambda values: np.ptp(values))
        slip = look_like_milliseconds(one.time, loudest - loudest[0], end)
        if slip and not one.timed:
            yield (
                f"{one.file}: its times, up to {one.time[-1]:g} s, look like milliseconds (the "
                f"scene ends at {end:g} s): a header time [ms] says so"
            )


def _require_recorded(curves: Curves, scenes: Sequence[AnyScene]) -> None:
    receivers = [(p, at) for p in curves.waveforms for one in scenes for at in recorded(one, p.key)]
    if not scenes or any(same(place.at, at) for place, at in receivers):
        return
    place, scene = next(iter(curves.waveforms)), scenes[0]
    if not hasattr(scene.record, place.key):
        allowed = (
            f"is not a receiver of a {scene.kind}; columns are named as {EXAMPLES[scene.kind]}"
        )
        raise SceneError(curves.file, str(place), None, allowed)
    held = ", ".join(place._replace(at=at).receiver for at in recorded(scene, place.key)) or "none"
    allowed = (
        f"must be at a receiver of the scene: {place.key} at {held}; record.{place.key} in the "
        "scene, or --set, adds a receiver"
    )
    raise SceneError(curves.file, str(place), None, allowed)


def _of_file(name: str, every: list[Selection]) -> list[Curves]:
    """Return the curves of a file; raises SceneError, or ValueError in one phrase."""
    path, times = every[0].path, [one for one in every if one.is_time]
    wanted = [one for one in every if not one.is_time] or [Selection(str(path), path)]
    if is_netcdf(path):
        table = read_netcdf(path, LEAST_SAMPLES)
    else:
        table = read_columns(path, times[0].column if times else "time", LEAST_SAMPLES)
    unit = (split_unit(times[0].label)[1] if times else "") or table.time.unit
    seconds = table.time._replace(unit=unit).si(TIME)
    groups: dict[bytes, dict[Place, np.ndarray]] = {}  # by the cells that are empty
    selected = [one for choice in wanted for one in _selected(table, choice)]
    bare = frozenset(place for place, _, said in selected if not said)
    for place, values, _ in selected:
        group = groups.setdefault(np.isnan(values).tobytes(), {})
        if place in group:
            raise ValueError(f"{place} must be given only once")
        group[place] = values
    curves: list[Curves] = []
    for group in groups.values():
        place, values = next(iter(group.items()))
        there = ~np.isnan(values)
        if there.sum() < LEAST_SAMPLES:
            raise ValueError(
                f"{place}: must hold at least {LEAST_SAMPLES} samples, not {there.sum()}"
            )
        called = f"{name}:{place}" if curves else name
        waveforms = {place: values[there] for place, values in group.items()}
        curves.append(Curves(called, str(path), seconds[there], waveforms, bool(unit), bare))
    return curves


def _selected(table: Columns, choice: Selection) -> list[tuple[Place, np.ndarray, str]]:
    """Return the waveforms of a file selected by one argument, [n] in SI, nan where cells are
    empty, each with the unit that is given for it, or none."""
    columns = [column for column in table.rest if choice.fits(column)]
    alone = len(columns) == 1 and (bool(choice.column) or len(table.rest) == 1)
    label, unit = split_unit(choice.label)
    wanted, found = parsed(label.removeprefix("-")), []
    for column in columns if wanted or not label else []:
        place, said = parsed(column.name.removeprefix("-")), column.name.lower()
        if place is None and wanted is None:
            which = f"{column.name}=" if column.name else ""
            allowed = (
                f"must be named as {', in a rock mass as '.join(EXAMPLES.values())}, or its place "
                f"be given as {choice.path}:{which}stress@20; the file holds {_listed(table)}"
            )
            raise SceneError(str(choice.path), column.name or "second column", None, allowed)
        bare = alone and said not in QUANTITIES
        if wanted and not place and (bare or said == wanted.quantity):
            place = wanted
        if place and (wanted is None or place.is_at(wanted)):
            sign = -1.0 if "-" in (column.name[:1], label[:1]) else 1.0
            stated = column._replace(unit=unit or column.unit)
            found.append((place, sign * stated.si(UNITS[place.quantity]), stated.unit))
    if not found:
        held = f"{choice.path} holds {_listed(table)}"
        allowed = f"must be a label, such as {EXAMPLES['pillar']}, a column or COLUMN=LABEL; {held}"
        if wanted and not choice.column:
            allowed = f"{held}; {wanted} must be one of them"
        else:
            allowed = f"{choice.column or label!r} {allowed}"
        raise SceneError("--with", choice.text, None, allowed)
    return found


def _listed(table: Columns) -> str:
    return ", ".join(column.name or "one column without a name" for column in table.rest)
