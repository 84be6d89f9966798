"""Values of swept keys: `--sweep KEY=FROM:TO:COUNT`, `KEY=log:FROM:TO:COUNT` or `KEY=A,B,C`."""

import json
import re
from math import isfinite, prod
from typing import Any

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.read import parse_override

MOST = 10_000  # points
FORMS = "must be KEY=FROM:TO:COUNT, KEY=log:FROM:TO:COUNT or KEY=A,B,C"


def axes(given: list[str], fixed: list[str]) -> dict[str, list[Any]]:
    """Return the values of every key of `--sweep`; raises SceneError, in one line.

    fixed : the keys of `--set`.
    """
    found: dict[str, list[Any]] = {}
    for text in given:
        key, _, spec = (part.strip() for part in text.partition("="))
        if not (key and spec):
            raise SceneError("--sweep", text, None, f"{FORMS}, e.g. joints.damping_ratio=0.01,0.1")
        if key in found or key in fixed:
            raise SceneError("--sweep", text, None, f"{key} is given already")
        between = re.match(r"""[^"'\[{]*:""", spec)
        found[key] = _between(text, spec) if between else _listed(text, spec)
    if (count := prod(map(len, found.values()))) > MOST:
        raise SceneError("--sweep", "", None, f"gives {count:,} points; at most {MOST:,}")
    return found


def _listed(text: str, spec: str) -> list[Any]:
    values = parse_override(f"value=[{spec}]")[1]
    if isinstance(values, str):  # of bare words
        values = [parse_override(f"value={part.strip()}")[1] for part in spec.split(",")]
    if len({json.dumps(value, default=str) for value in values}) < len(values):
        raise SceneError("--sweep", text, None, "must not repeat a value")
    return values


def _between(text: str, spec: str) -> list[Any]:
    """Return values from one end to the other, rounded to 12 digits: 0.3, not 0.30000000000004."""
    try:
        first, last, count = spec.removeprefix("log:").split(":")
        begin, end, n = float(first), float(last), int(count)
    except ValueError:
        raise SceneError("--sweep", text, None, f"{FORMS}, of numbers") from None
    if not (isfinite(begin) and isfinite(end) and begin != end and 2 <= n <= MOST):
        allowed = f"must have two finite ends that differ, and a COUNT of 2 to {MOST:,}"
        raise SceneError("--sweep", text, None, allowed)
    log = spec.startswith("log:")
    if log and not begin * end > 0:
        raise SceneError("--sweep", text, None, "with log: must have ends of one sign, not zero")
    inner = (np.geomspace if log else np.linspace)(begin, end, n)[1:-1]
    values = [begin, *(float(f"{value:.12g}") for value in inner), end]
    whole = all(re.fullmatch(r"\s*[+-]?\d+\s*", part) for part in (first, last))
    return [int(v) for v in values] if whole and all(v == int(v) for v in values) else values
