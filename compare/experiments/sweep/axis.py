"""What a key is swept over: `--sweep KEY=FROM:TO:COUNT`, `KEY=log:FROM:TO:COUNT` or `KEY=A,B,C`."""

from __future__ import annotations

import json
import re
from itertools import product
from math import isfinite, prod
from typing import Any, NamedTuple

from cases.errors import SceneError
from cases.files import parse_toml

MOST = 10_000  # points
DIGITS = 12  # of values between two ends: 0.3, not 0.30000000000000004
FORMS = "must be KEY=FROM:TO:COUNT, KEY=log:FROM:TO:COUNT or KEY=A,B,C"
RANGE = re.compile(r"""(log:)?([^:,"'\[{]+):([^:,"'\[{]+):([^:,"'\[{]+)""")


class Axis(NamedTuple):
    """A dotted key of the scene and its values, no two of them alike."""

    key: str
    values: list[Any]


def axes(given: list[str], fixed: list[str]) -> list[Axis]:
    """Return what `--sweep` names; `fixed` are the keys that `--set` gives.

    Raises SceneError, in one line.
    """
    found = [_axis(text) for text in given]
    keys = [axis.key for axis in found]
    for i, (text, key) in enumerate(zip(given, keys, strict=True)):
        if key in keys[:i] or key in fixed:
            raise SceneError("--sweep", text, None, f"{key} is given already")
    count = prod(len(axis.values) for axis in found)
    if count > MOST:
        raise SceneError("--sweep", "", None, f"gives {count:,} points; at most {MOST:,}")
    return found


def settings(found: list[Axis]) -> list[dict[str, Any]]:
    """Return every combination of the values, the last key first to change."""
    keys = [axis.key for axis in found]
    values = product(*(axis.values for axis in found))
    return [dict(zip(keys, one, strict=True)) for one in values]


def _axis(text: str) -> Axis:
    key, equals, spec = (part.strip() for part in text.partition("="))
    if not equals or not key or not spec:
        raise SceneError("--sweep", text, None, f"{FORMS}, e.g. joints.damping_ratio=0.01:0.5:8")
    between = RANGE.fullmatch(spec)
    if between is None and re.search(r"""^[^"'\[{]*:""", spec):
        raise SceneError("--sweep", text, None, FORMS)
    values = _listed(spec) if between is None else _between(text, *between.groups())
    if len({json.dumps(value, default=str) for value in values}) < len(values):
        raise SceneError("--sweep", text, None, "must give every value once")
    return Axis(key, values)


def _listed(spec: str) -> list[Any]:
    """Return values as TOML, or what is none as text."""
    try:
        return parse_toml(f"values = [{spec}]")["values"]
    except (ValueError, RecursionError):
        return [_value(part.strip()) for part in spec.split(",")]


def _value(text: str) -> Any:
    try:
        return parse_toml(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return text


def _between(text: str, log: str | None, first: str, last: str, count: str) -> list[Any]:
    try:
        begin, end, n = float(first), float(last), int(count)
    except ValueError:
        raise SceneError("--sweep", text, None, f"{FORMS}, of numbers") from None
    if not (isfinite(begin) and isfinite(end) and begin != end and 2 <= n <= MOST):
        allowed = f"must have two finite ends that differ, and a COUNT of 2 to {MOST:,}"
        raise SceneError("--sweep", text, None, allowed)
    if log and not begin * end > 0:
        raise SceneError("--sweep", text, None, "with log: must have ends of one sign, not zero")
    parts = [i / (n - 1) for i in range(1, n - 1)]
    inner = [begin * (end / begin) ** x if log else begin + x * (end - begin) for x in parts]
    values = [begin, *(float(f"{value:.{DIGITS}g}") for value in inner), end]
    whole = all(re.fullmatch(r"\s*[+-]?\d+\s*", part) for part in (first, last))
    return [int(v) for v in values] if whole and all(v == int(v) for v in values) else values
