"""External waveforms of `jointwave compare --with`: quantity, receiver, sign and unit.

A column is named [-]QUANTITY[_COMPONENT]@Y [UNIT]: `stress@20`, `-stress@20 [MPa]`,
`velocity_x@20.25 [mm/s]`; velocity and displacement are along y unless a component is named. In a
rock mass it is QUANTITY[_COMPONENT]@[X,Y]: `velocity_x@[20,30]`, `stress_xx@[20,30] [MPa]`,
`traction_n@[20,20]`, `gap@[20,20]`; in a CSV file a header with a comma is quoted. Stress is
positive in compression and motion along +x, +y, +z; a minus sign marks a column with the opposite
sign, e.g. tension positive. Without a unit, SI. A column with another header is selected by
COLUMN=LABEL.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.records import Column, Columns
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.units import TIME, UNITS, split_unit
from jointwave.cases.warnings.sources import look_like_milliseconds
from jointwave.compare.engines import names
from jointwave.compare.misfit.columns import Selection, read_table, selected, selection
from jointwave.compare.misfit.places import Place, parsed, recorded, same
from jointwave.compare.scenes import AnySource, load

READ_CURVES = "curves of `read_curves`"  # what functions accept
LEAST_SAMPLES = 3  # for a parabola through the peak of a correlation
#: Examples of column names, by the kind of scene.
EXAMPLES = {
    "pillar": "stress@20, -stress@20 [MPa] or velocity_x@20.25 [mm/s]",
    "rock mass": "velocity_x@[20,30], -stress_xx@[20,30] [MPa] or traction_n@[20,20]",
}


@dataclass(frozen=True)
class Curves:
    """Waveforms of one file over one time.

    name : in tables. file : path, as given. time : [n] s, strictly increasing. waveforms : [n] by
    place, SI, compression positive. timed : whether file or command gives the unit of times. bare :
    places whose waveform has no unit, and is taken as SI.
    """

    name: str
    file: str
    time: np.ndarray
    waveforms: dict[Place, np.ndarray]
    timed: bool = True
    bare: frozenset[Place] = frozenset()


def read_curves(
    texts: str | Sequence[str], scenes: "AnySource | Sequence[AnySource]"
) -> list[Curves]:
    """Read arguments of `--with`, each FILE, FILE:LABEL, FILE:COLUMN or FILE:COLUMN=LABEL, for one
    or several scenes.

    FILE is NetCDF, as written by `jointwave run`; or a table or seismogram that `cases.records`
    reads, with a header `time [ms], stress@20 [MPa]` or two bare columns, time in s first. LABEL
    selects one of several curves, or labels the only one; COLUMN is a header. Empty cells are
    skipped. Returns one entry per file, and per set of times in it.

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
    """Yield curves at no receiver of a scene, and times without a unit that may be milliseconds."""
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
        why = f"is not a receiver of a {scene.kind}; columns are named as {EXAMPLES[scene.kind]}"
        raise SceneError(curves.file, str(place), None, why)
    held = ", ".join(place._replace(at=at).receiver for at in recorded(scene, place.key)) or "none"
    allowed = (
        f"must be at a receiver of the scene: {place.key} at {held}; record.{place.key} in the "
        "scene, or --set, adds a receiver"
    )
    raise SceneError(curves.file, str(place), None, allowed)


def _of_file(name: str, every: list[Selection]) -> list[Curves]:
    """Return the curves of a file. Raises SceneError, or ValueError in one phrase."""
    path, no_times = every[0].path, Selection("", every[0].path)
    times = next((one for one in every if one.is_time), no_times)
    wanted = [one for one in every if not one.is_time] or [Selection(str(path), path)]
    table = read_table(times, LEAST_SAMPLES)
    seconds, timed = table.time.si(TIME), bool(table.time.unit)
    groups: dict[bytes, dict[Place, np.ndarray]] = {}  # by the pattern of empty cells
    found = [one for choice in wanted for one in _selected(table, choice)]
    bare = frozenset(place for place, column in found if not column.unit)
    for place, column in found:
        values = column.si(UNITS[place.quantity])
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
        curves.append(Curves(called, str(path), seconds[there], waveforms, timed, bare))
    return curves


def _selected(table: Columns, choice: Selection) -> list[tuple[Place, Column]]:
    """Return the columns of a file selected by one argument, NaN in empty cells, with their places.
    Raises SceneError for a column without a place, or if no column is selected."""
    found, file = list[tuple[Place, Column]](), str(choice.path)
    for place, column in selected(table.rest, choice, parsed):
        if place is None:
            which = f"{column.name}=" if column.name else ""
            allowed = (
                f"must be named as {', in a rock mass as '.join(EXAMPLES.values())}, or its place "
                f"be given as {file}:{which}stress@20; the file holds {_listed(table)}"
            )
            raise SceneError(file, column.name or "second column", None, allowed)
        found.append((place, column))
    if not found:
        held, label = f"{file} holds {_listed(table)}", split_unit(choice.label)[0]
        wanted = parsed(label.removeprefix("-"))
        if wanted and not choice.column:
            allowed = f"{held}; {wanted} must be one of them"
        else:
            allowed = f"must be a label, such as {EXAMPLES['pillar']}, a column or COLUMN=LABEL"
            allowed = f"{choice.column or label!r} {allowed}; {held}"
        raise SceneError("--with", choice.text, None, allowed)
    return found


def _listed(table: Columns) -> str:
    return ", ".join(column.name or "one column without a name" for column in table.rest)
