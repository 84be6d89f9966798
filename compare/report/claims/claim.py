"""A claim, and how its numbers are written."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np


class Claim(NamedTuple):
    """A claim of the paper: the sentence with the numbers that decide it, and whether it holds."""

    sentence: str
    holds: bool
    claim: str = ""


def listed(numbers: Mapping[str, Any], form: str, unit: str = "") -> str:
    """Return the number or numbers of each engine, in the order of the legend."""
    texts = (
        f"{name} {', '.join(format(x, form) for x in np.atleast_1d(values))}{unit}"
        for name, values in numbers.items()
    )
    return "; ".join(texts)


def share(x: float, digits: int = 1) -> str:
    """Return a ratio as a percentage."""
    return f"{100 * x:.{digits}f} %"


def shares(numbers: Mapping[str, float], digits: int = 1) -> str:
    """Return one percentage an engine."""
    return listed({name: 100 * x for name, x in numbers.items()}, f".{digits}f", " %")


def falls(values: Iterable[float]) -> bool:
    """Return whether each value is below the one before, and there are several."""
    steps = np.diff(list(values))
    return bool(len(steps) and (steps < 0).all())
