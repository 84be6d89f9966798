"""The keys that a fit may change, with their starting values and bounds."""

from collections.abc import Mapping
from fnmatch import fnmatch
from math import exp, inf, isfinite, log, nan, nextafter
from typing import Annotated, Any, NamedTuple

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from jointwave.cases.errors import SceneError, nearest
from jointwave.cases.scene_type import AnyScene, Either, checked
from jointwave.cases.schema.keys import keys, model_in

CLOCK = "clock"  # shift added to the times of the files, s
FACTOR = 1000.0  # by which a positive key may change, if nothing else bounds it
#: Of an unknown at the start: scipy's difference steps are a fraction of the unknown.
ORIGIN = 10.0
#: Keys of discretisation, solution and recording: not continuous parameters.
FIXED = (
    *("pillar.length", "pillar.block", "soft_layers.*.y", "time.*", "record.*", "numerics.*"),
    *("expect.*", "domain.*", "regions.*.dip", "segments.*.y", "segments.*.block"),
    *("joint_sets.*.dip", "joint_sets.*.spacing", "joint_sets.*.offset", "joint_sets.*.scatter*"),
)
FORMS = "must be KEY, KEY=START or KEY=LOW:START:HIGH"


class FreeKey(NamedTuple):
    """A key that is fitted.

    start : nan if it is to be found (clock only). low, high : bounds. logarithmic : whether it is
    positive and searched on such a scale.
    """

    key: str
    start: float
    low: float
    high: float
    logarithmic: bool

    @property
    def size(self) -> float:
        """The change of the value for a change of 1 in the unknown, on a linear scale."""
        if self.key == CLOCK:
            return (self.high - self.low) / 2
        return abs(self.start) or (self.high - self.low if isfinite(self.high) else 1.0)

    def unknown(self, value: float) -> float:
        """Return the search variable of a value."""
        if self.logarithmic:
            return ORIGIN + log(value / self.start)
        return ORIGIN + (value - self.start) / self.size

    def value(self, unknown: float) -> float:
        """Return the value of a search variable, within the bounds."""
        x = unknown - ORIGIN
        value = self.start * exp(x) if self.logarithmic else self.start + self.size * x
        return min(max(value, self.low), self.high)


def free_keys(texts: list[str], scene: AnyScene) -> list[FreeKey]:
    """Return the keys of `--free`, several in one text separated by commas; raises SceneError."""
    found: dict[str, FreeKey] = {}
    for text in ",".join(texts).split(","):
        key, numbers = _parsed(text)
        if key in found:
            raise SceneError("--free", key, None, "must be given only once")
        found[key] = _free_key(key, numbers, scene)
    return list(found.values())


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
        new = [*old[:i], _with(old[i], rest[1:], value), *old[i + 1 :]]
    elif old is None:
        model: Any = model_in(type(table).model_fields[name].annotation)
        new = model.model_validate({rest[0]: value})
    else:
        new = _with(old, rest, value)
    return table.model_copy(update={name: new})


def _parsed(text: str) -> tuple[str, list[float]]:
    """Return a key, and its start alone or between its bounds; empty if not given."""
    key, equals, numbers = (part.strip() for part in text.partition("="))
    try:
        found = [float(part) for part in numbers.split(":")] if equals else []
    except ValueError:
        raise SceneError("--free", text, None, f"{FORMS}, of numbers") from None
    if not key or len(found) not in (0, 1, 3) or not all(map(isfinite, found)):
        raise SceneError("--free", text, None, FORMS)
    if len(found) == 3 and not found[0] < found[1] < found[2]:
        raise SceneError("--free", text, None, "must have its bounds in order, LOW first")
    return key, found


def _free_key(key: str, numbers: list[float], scene: AnyScene) -> FreeKey:
    """Return a key with its start and bounds, as given or else from the scene and its models."""
    least, most, logarithmic, old = -inf, inf, False, nan
    if key != CLOCK:
        field, old = _find(key, scene)
        limits = _limits(field)
        if limits is None or any(fnmatch(key, fixed) for fixed in FIXED):
            raise SceneError("--free", key, None, "must be a continuous number")
        least, most, logarithmic = limits
    if old is None and not numbers:
        allowed = f"is not in {scene.where}: give a start, --free {key}=START"
        raise SceneError("--free", key, None, allowed)
    start = numbers[len(numbers) // 2] if numbers else old
    low, high = (numbers[0], numbers[2]) if len(numbers) == 3 else (least, most)
    if key != CLOCK and not least <= low <= start <= high <= most:
        allowed = f"must start and stay within {max(low, least):.6g} to {min(high, most):.6g}"
        raise SceneError("--free", key, start, allowed)
    if logarithmic:
        low, high = max(low, start / FACTOR), min(high, start * FACTOR)
    return FreeKey(key, start, low, high, logarithmic)


def _find(key: str, scene: AnyScene) -> tuple[FieldInfo, Any]:
    """Return the field of a dotted key and its value, None if the scene has none."""
    known, parts = dict(keys(type(scene))), key.split(".")
    name = ".".join(part for part in parts if not part.isdecimal())
    if name not in known:
        allowed = f"is not a key of a scene{nearest(name, list(known))}"
        raise SceneError("--free", key, None, allowed)
    table: Any = scene
    for i, part in enumerate(parts):
        if not isinstance(table, list):
            table = getattr(table, part, None)
        elif part.isdecimal() and int(part) < len(table):
            table = table[int(part)]
        else:
            above, last = ".".join(parts[:i]), len(table) - 1
            allowed = f"must be {above}.0 to {above}.{last}" if table else "the scene has none"
            raise SceneError("--free", key, None, allowed)
    return known[name], table


def _limits(field: FieldInfo) -> tuple[float, float, bool] | None:
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
