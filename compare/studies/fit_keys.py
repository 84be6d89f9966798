"""The keys that a fit may change, with their starting values and bounds."""

import re
from collections.abc import Mapping
from fnmatch import fnmatch
from functools import reduce
from math import exp, inf, isfinite, log, nan
from typing import Any, NamedTuple

from pydantic import ValidationError

from jointwave.cases.errors import SceneError, nearest
from jointwave.cases.scene_type import AnyScene, Either
from jointwave.cases.schema.keys import field_comments, in_words, keys
from jointwave.cases.units import units_of
from jointwave.cases.validate import checked

CLOCK = "clock"  # shift added to the times of the files, s
FACTOR = 1000.0  # largest change of a positive key without bounds of its own
#: Value of every unknown at the start, not 0: scipy's difference steps are a fraction of it.
ORIGIN = 10.0
#: Keys of geometry, discretisation and recording, which are not continuous parameters.
FIXED = (
    *("pillar.length", "pillar.block", "soft_layers.*.y", "time.*", "record.*", "numerics.*"),
    *("expect.*", "domain.*", "regions.*.dip", "segments.*.y", "segments.*.block"),
    *("joint_sets.*.dip", "joint_sets.*.spacing", "joint_sets.*.offset", "joint_sets.*.scatter*"),
)
UNIT = re.compile(r"(kg/m3|Pa/m|Pa s/m|Pa|m/s2?|m|1/s|s|Hz|degrees|J/m2)(?=[,; ]|$)")
FORMS = "must be KEY, KEY=START or KEY=LOW:START:HIGH, of numbers, LOW first"


class FreeKey(NamedTuple):
    """A key that is fitted, with its bounds; start : nan if it is to be found (clock only)."""

    key: str
    start: float
    low: float = -inf
    high: float = inf

    @property
    def logarithmic(self) -> bool:
        """Whether it stays positive and is searched on a logarithmic scale."""
        return self.low > 0 and self.key != CLOCK

    @property
    def size(self) -> float:
        """The change of the value per unit of the unknown, on a linear scale."""
        reach = self.high - self.low
        return reach if self.key == CLOCK else abs(self.start) or (reach if isfinite(reach) else 1)

    def unknown(self, value: float) -> float:
        """Return the search variable of a value."""
        change = log(value / self.start) if self.logarithmic else (value - self.start) / self.size
        return ORIGIN + change

    def value(self, unknown: float) -> float:
        """Return the value of a search variable, within the bounds."""
        x = unknown - ORIGIN
        value = self.start * exp(x) if self.logarithmic else self.start + self.size * x
        return min(max(value, self.low), self.high)


def free_keys(texts: list[str], scene: AnyScene) -> list[FreeKey]:
    """Return the keys of `--free`, separated by commas within a text; raises SceneError."""
    found: dict[str, FreeKey] = {}
    for text in ",".join(texts).split(","):
        one = _free_key(text, scene)
        if found.setdefault(one.key, one) is not one:
            raise SceneError("--free", one.key, None, "must be given only once")
    return [*found.values()]


def _free_key(text: str, scene: AnyScene) -> FreeKey:
    """Return a key with its start and bounds, as given or else from the scene and its schema."""
    key, equals, numbers = (part.strip() for part in text.partition("="))
    try:
        given = [float(part) for part in numbers.split(":")] if equals else []
    except ValueError:
        given = [nan]
    ordered = all(map(isfinite, given)) and given == sorted(set(given))
    if not key or len(given) not in (0, 1, 3) or not ordered:
        raise SceneError("--free", text, None, FORMS)
    words, held = ("number", nan) if key == CLOCK else _held(key, scene)
    if held is None and not given:
        allowed = f"is not in {scene.where}: give a start, --free {key}=START"
        raise SceneError("--free", key, None, allowed)
    if len(given) == 3:
        return FreeKey(key, given[1], given[0], given[2])
    start = given[0] if given else held
    if "> 0" in words and start > 0:
        return FreeKey(key, start, start / FACTOR, start * FACTOR)
    return FreeKey(key, start, 0.0 if "≥ 0" in words else -inf)


def _held(key: str, scene: AnyScene) -> tuple[str, Any]:
    """Return the allowed values of a dotted key in words, and its value, None if not set; raises
    SceneError for keys that are not continuous numbers, or lack the number of a table in a list."""

    def numbered(name: str) -> str:
        first, dot, rest = name.partition(".")
        is_list = dot and isinstance(getattr(scene, first, None), list)
        return f"{first}.0.{rest}" if is_list else name

    known, parts = dict(keys(type(scene))), key.split(".")
    name = ".".join(part for part in parts if not part.isdecimal())
    if name not in known or key == name != numbered(name):
        allowed = f"is not a key of a scene{nearest(name, map(numbered, known))}"
        raise SceneError("--free", key, None, allowed)
    words = in_words(known[name])
    if not words.startswith("number") or any(fnmatch(key, fixed) for fixed in FIXED):
        raise SceneError("--free", key, None, "must be a continuous number")
    try:
        return words, reduce(_part, parts, scene)
    except (AttributeError, IndexError, ValueError):
        raise SceneError("--free", key, None, "is in a table that the scene has not") from None


def _part(table: Any, name: str) -> Any:
    return table[int(name)] if isinstance(table, list) else getattr(table, name)


def unit_of(key: str, scene: AnyScene) -> str:
    """Return the SI unit of a key of `--free`, read from the start of its comment; "" if none."""
    *tables, name = key.split(".")
    table: Any = reduce(_part, tables, scene)
    if name == "amplitude":
        units = units_of(table.quantity, scene.in_space)
        return "" if table.shape == "table" else next(iter(units))
    found = UNIT.match("s" if key == CLOCK else field_comments(table.__class__)[name])
    return found[0] if found else ""


def changed(scene: Either, values: Mapping[str, float]) -> Either:
    """Return a scene with dotted keys set; raises SceneError if that is invalid."""
    context = {"dimension": 3 if scene.in_space else 2}
    for key, value in values.items():
        try:
            scene = _with(scene, key.split("."), value, context)
        except ValidationError as error:
            allowed = str(error.errors()[0]["msg"]).lower()
            raise SceneError(scene.where, key, value, allowed) from None
    return checked(scene)


def _with(table: Any, parts: list[str], value: float, context: dict[str, int]) -> Any:
    """Return a table, or a list of tables, with one of its keys set and validated."""
    if isinstance(table, list):
        i = int(parts[0])
        return [*table[:i], _with(table[i], parts[1:], value, context), *table[i + 1 :]]
    if len(parts) > 1:
        inner = _with(getattr(table, parts[0]), parts[1:], value, context)
        return table.model_copy(update={parts[0]: inner})
    new = table.model_copy(update={parts[0]: value})
    # A load with a file keeps the history that it has read.
    if getattr(new, "file", None):
        return new
    return type(new).model_validate(dict(new), context=context)
