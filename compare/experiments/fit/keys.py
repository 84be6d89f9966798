"""The keys that a fit may change, with starting values and bounds."""

import re
from collections.abc import Mapping
from itertools import pairwise
from math import exp, inf, isfinite, log, nan, nextafter
from typing import Annotated, Any, NamedTuple

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from cases.errors import SceneError
from cases.kinds import AnyScene, Either, checked
from cases.schema.keys import field_comments, model_in
from cases.schema.pulse import Pulse

CLOCK = "clock"  # shift added to the times of the files, s
DECADES = 3.0  # default range of a key on a logarithmic scale
#: Keys of discretisation, solution and recording: not continuous parameters.
FIXED = (
    *("pillar.length", "pillar.block", "soft_layers.*.y", "time", "record", "numerics", "expect"),
    *("domain", "regions.*.dip", "segments.*.y", "segments.*.block"),
    *(f"joint_sets.*.{key}" for key in ("dip", "spacing", "offset", "scatter")),
)
FORMS = "must be KEY, KEY=START, KEY=LOW:HIGH or KEY=LOW:START:HIGH"
UNIT = re.compile(r"(?<![\w/])(Pa/m|Pa|kg/m3|m/s2|m/s|J/m2|degrees|s|m)(?![\w/])")
#: Unit of an amplitude by the quantity of its pulse.
LOADS = {
    "stress": "Pa",
    "incident-stress": "Pa",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "force": "N/m",
}


class Free(NamedTuple):
    """A key that is fitted.

    start : nan if it is to be found (clock only). low, high : bounds. logarithmic : whether it is
    positive and searched on such a scale. size : on a linear scale the change of the value for a
    change of 1 in the unknown. unit : "" for a ratio.
    """

    key: str
    start: float
    low: float
    high: float
    logarithmic: bool
    size: float
    unit: str

    def unknown(self, value: float) -> float:
        """Return the search variable of a value."""
        return log(value / self.start) if self.logarithmic else (value - self.start) / self.size

    def value(self, unknown: float) -> float:
        """Return the value of a search variable."""
        linear = self.start + self.size * unknown
        found = self.start * exp(unknown) if self.logarithmic else linear
        return min(max(found, self.low), self.high)


def free_keys(texts: list[str], scene: AnyScene) -> list[Free]:
    """Return the keys of `--free`, several in one text separated by commas; raises SceneError."""
    found: list[Free] = []
    for text in [part for given in texts for part in given.split(",")]:
        key, numbers = _parsed(text)
        if any(key == other.key for other in found):
            raise SceneError("--free", key, None, "must be given only once")
        found.append(_free(key, numbers, scene))
    return found


def changed(scene: Either, values: Mapping[str, float]) -> Either:
    """Return a scene with dotted keys set; raises SceneError if that is invalid."""
    try:
        for key, value in values.items():
            scene = _with(scene, key.split("."), value)
    except ValidationError as error:
        allowed = str(error.errors()[0]["msg"]).lower()
        raise SceneError(scene.where, key, value, allowed) from None
    return checked(scene)


def _with(table: Any, parts: list[str], value: float) -> Any:
    name, *rest = parts
    if not rest:
        new = table.model_copy(update={name: value})
        # A load retains the history that it has read.
        return new if getattr(new, "file", None) else type(new).model_validate(dict(new))
    old = getattr(table, name)
    if isinstance(old, list):
        i = int(rest[0])
        return table.model_copy(
            update={name: [*old[:i], _with(old[i], rest[1:], value), *old[i + 1 :]]}
        )
    if old is None:
        made = model_in(type(table).model_fields[name].annotation)
        assert made is not None
        return table.model_copy(update={name: made.model_validate({rest[0]: value})})
    return table.model_copy(update={name: _with(old, rest, value)})


def _parsed(text: str) -> tuple[str, list[float]]:
    key, equals, numbers = (part.strip() for part in text.partition("="))
    try:
        found = [float(part) for part in numbers.split(":")] if equals else []
    except ValueError:
        raise SceneError("--free", text, None, f"{FORMS}, of numbers") from None
    if not key or len(found) > 3 or not all(map(isfinite, found)):
        raise SceneError("--free", text, None, FORMS)
    if len(found) > 1 and not all(a < b for a, b in pairwise(found)):
        raise SceneError("--free", text, None, "must have its bounds in order, LOW first")
    return key, found


def _free(key: str, numbers: list[float], scene: AnyScene) -> Free:
    """Return a key with its start and bounds, as given or else from the scene and its models."""
    if key == CLOCK:
        start, low, high = _three(numbers, None, -inf, inf)
        return Free(key, nan if start is None else start, low, high, False, 1.0, "s")
    field, owner, old = _find(key, scene)
    number = _number(field)
    if number is None or any(_matches(key, fixed) for fixed in FIXED):
        raise SceneError("--free", key, None, "must be a continuous number")
    least, most, logarithmic = number
    if old is None and not numbers:
        allowed = f"is not in {scene.where}: give a start, --free {key}=START"
        raise SceneError("--free", key, None, allowed)
    start, low, high = _three(numbers, old, least, most)
    if start is None:
        start = (low * high) ** 0.5 if logarithmic and low > 0 else (low + high) / 2
    if not (least <= low and high <= most and low <= start <= high):
        allowed = f"must start and stay within {max(low, least):.6g} to {min(high, most):.6g}"
        raise SceneError("--free", key, start, allowed)
    if logarithmic:
        low, high = max(low, start * 10**-DECADES), min(high, start * 10**DECADES)
    size = abs(start) or (high - low if isfinite(high) else 1.0)
    return Free(key, start, low, high, logarithmic, size, _unit(key, owner))


def _unit(key: str, owner: type[BaseModel] | BaseModel) -> str:
    """Return the unit of a key of a table (or of its model if the scene has none) from the comment
    of its field; "" for a ratio."""
    name = key.rpartition(".")[2]
    if isinstance(owner, Pulse) and name == "amplitude":
        return "" if owner.file else LOADS[owner.quantity]
    model = owner if isinstance(owner, type) else type(owner)
    about = field_comments(model).get(name, "")
    found = UNIT.search(re.split(r"[;(]", about)[0])
    return found[0] if found else ""


def _three(
    numbers: list[float], start: float | None, low: float, high: float
) -> tuple[float | None, float, float]:
    """Return start and bounds as given, or the defaults."""
    if len(numbers) == 1:
        return numbers[0], low, high
    if len(numbers) == 2:
        inside = start is not None and numbers[0] <= start <= numbers[1]
        return start if inside else None, numbers[0], numbers[1]
    return (numbers[1], numbers[0], numbers[2]) if numbers else (start, low, high)


def _find(key: str, scene: AnyScene) -> tuple[FieldInfo, type[BaseModel] | BaseModel, Any]:
    """Return the field of a dotted key, its table (or the table's model if the scene has none), and
    its value, None if absent."""
    table: Any = scene
    model: type[BaseModel] | None = type(scene)
    field, owner, parts = None, None, key.split(".")
    for i, part in enumerate(parts):
        if model is None or part not in model.model_fields:
            known = f"; allowed: {', '.join(model.model_fields)}" if model else ""
            raise SceneError("--free", key, None, f"is not a key of a scene{known}")
        field, owner = model.model_fields[part], table or model
        model, table = model_in(field.annotation), getattr(table, part, None)
        if isinstance(table, list) and model is not None and i + 1 < len(parts):
            number = parts.pop(i + 1)
            if not number.isdecimal() or int(number) >= len(table):
                allowed = f"must be {part}.0 to {part}.{len(table) - 1}" if table else "has none"
                raise SceneError("--free", key, None, f"{part}: {allowed}")
            table = table[int(number)]
    assert field is not None and owner is not None
    return field, owner, table


def _matches(key: str, fixed: str) -> bool:
    parts, wanted = key.split("."), fixed.split(".")
    return len(parts) >= len(wanted) and all(
        w in ("*", p) for p, w in zip(parts, wanted, strict=False)
    )


def _number(field: FieldInfo) -> tuple[float, float, bool] | None:
    """Return the smallest and largest number allowed by a field, and whether it is positive; None
    if it is not a number."""
    kind: Any = Annotated[field.annotation, field]
    allowed = TypeAdapter(kind).json_schema()
    for one in allowed.get("anyOf", [allowed]):
        if one.get("type") == "number":
            above, below = one.get("exclusiveMinimum"), one.get("exclusiveMaximum")
            low = one.get("minimum", -inf) if above is None else nextafter(above, inf)
            high = one.get("maximum", inf) if below is None else nextafter(below, -inf)
            return low, high, above == 0
    return None
