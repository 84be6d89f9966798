"""Values of a swept key: `--sweep KEY=FROM:TO:COUNT`, `KEY=log:FROM:TO:COUNT` or `KEY=A,B,C`."""

import json
import re
from math import isfinite, prod
from typing import Any

from cases.errors import SceneError
from cases.files import parse_toml

MOST = 10_000  # points
MEMBER = "member"  # the key of an ensemble
DIGITS = 12  # of values between two ends: 0.3, not 0.30000000000000004
FORMS = "must be KEY=FROM:TO:COUNT, KEY=log:FROM:TO:COUNT or KEY=A,B,C"
RANGE = re.compile(r"""(log:)?([^:,"'\[{]+):([^:,"'\[{]+):([^:,"'\[{]+)""")


def axes(given: list[str], fixed: list[str], members: int = 0) -> dict[str, list[Any]]:
    """Return the values of every key of `--sweep`, without duplicates; `fixed` are the keys of
    `--set`. members : of an ensemble, numbered from 1, the last key.

    Raises SceneError, in one line.
    """
    found: dict[str, list[Any]] = {}
    pairs = [(text, *_axis(text)) for text in given]
    for text, key, values in pairs:
        if key in found or key in fixed:
            raise SceneError("--sweep", text, None, f"{key} is given already")
        found[key] = values
    if members:
        found[MEMBER] = list(range(1, members + 1))
    count = prod(map(len, found.values()))
    if count > MOST:
        raise SceneError("--sweep", "", None, f"gives {count:,} points; at most {MOST:,}")
    return found


def _axis(text: str) -> tuple[str, list[Any]]:
    key, equals, spec = (part.strip() for part in text.partition("="))
    if not equals or not key or not spec:
        raise SceneError("--sweep", text, None, f"{FORMS}, e.g. joints.damping_ratio=0.01:0.5:8")
    between = RANGE.fullmatch(spec)
    if between is None and re.search(r"""^[^"'\[{]*:""", spec):
        raise SceneError("--sweep", text, None, FORMS)
    if between is None:  # values as TOML, else as text
        parts = [part.strip() for part in spec.split(",")]
        values = _toml(f"[{spec}]", None) or [_toml(part, part) for part in parts]
    else:
        values = _between(text, *between.groups())
    if len({json.dumps(value, default=str) for value in values}) < len(values):
        raise SceneError("--sweep", text, None, "must not repeat a value")
    return key, values


def _toml(text: str, otherwise: Any) -> Any:
    try:
        return parse_toml(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return otherwise


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
