"""Checks of a study beyond the types of its keys: known methods, the number of points."""

from __future__ import annotations

from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cases.errors import SceneError
from compare.engines import names, solvers
from compare.experiments.study.methods import METHODS

if TYPE_CHECKING:
    from compare.experiments.study.study import Curve, FineRun, Study

MOST_POINTS = 10_000
#: Settings that are not keys of a scene, with their type.
ARGUMENTS: dict[str, type[int] | type[float]] = {"n_terms": int, "rtol": float}
LARGEST_ARGUMENT = 1e9


def plain(value: Any) -> Any:
    """Refuse values not allowed in scenes or in tables of studies: dates, huge numbers."""
    parts = value.values() if isinstance(value, dict) else value
    if isinstance(value, dict | list):
        for part in parts:
            plain(part)
    elif isinstance(value, int) and value.bit_length() > 64:
        raise ValueError("must be a number of at most 64 bits")
    elif not isinstance(value, int | float | str):
        raise ValueError("must be a number, a text, or true or false")
    return value


def refuse_senseless(path: Path, study: Study) -> None:
    """Raise SceneError for invalid points, or too many."""
    count = sum(prod(map(len, curve.vary.values())) for curve in study.curves)
    if count > MOST_POINTS:
        allowed = f"give {count:.6g} points, at most {MOST_POINTS}"
        raise SceneError(str(path), "curves", None, allowed)
    solvers = names()
    _refuse_unknown(path, "finest", study.finest, (*solvers, "none"))
    for i, curve in enumerate(study.curves):
        key = f"curves[{i}]"
        _refuse_unknown(path, f"{key}.method", curve.method, (*solvers, *METHODS))
        _refuse_unknown(path, f"{key}.own", curve.own, (*solvers, "finest", "none"))
        _refuse_arguments(path, key, curve)


def _refuse_unknown(
    path: Path, key: str, named: str | FineRun | None, known: tuple[str, ...]
) -> None:
    """Raise SceneError for an unknown method, also of a fine run."""
    method = named if named is None or isinstance(named, str) else named.method
    if method is not None and method not in known:
        raise SceneError(str(path), key, method, f"must be one of {', '.join(known)}")


def _refuse_arguments(path: Path, key: str, curve: Curve) -> None:
    given = [(name, [value]) for name, value in curve.changes.items()] + [*curve.vary.items()]
    for name, values in given:
        if name not in ARGUMENTS:
            continue
        takers = [one.name for one in solvers() if name in one.arguments]
        takers += [one for one, module in METHODS.items() if name in module.ARGUMENTS]
        if curve.method not in takers:
            allowed = f"is an argument of {', '.join(takers)}"
            raise SceneError(str(path), f"{key}.{name}", None, allowed)
        for value in values:
            kind = ARGUMENTS[name]
            if type(value) is not kind or not 0 < float(value) < LARGEST_ARGUMENT:
                allowed = f"must be {'a whole number' if kind is int else 'a number'} above 0"
                raise SceneError(str(path), f"{key}.{name}", value, allowed)
