"""One finding, and how its numbers are written."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np


class Finding(NamedTuple):
    """A claim of the paper, the sentence with the numbers that decide it, and whether it holds."""

    claim: str
    sentence: str
    holds: bool


def listed(numbers: dict[str, str]) -> str:
    """Return one text an engine, in the order of the legend."""
    return "; ".join(f"{name} {text}" for name, text in numbers.items())


def share(x: float, digits: int = 1) -> str:
    """Return a ratio as a percentage."""
    return f"{100 * x:.{digits}f} %"


def percent(numbers: dict[str, float], digits: int = 1) -> str:
    """Return one percentage an engine."""
    return listed({name: share(x, digits) for name, x in numbers.items()})


def falls(values: Iterable[float]) -> bool:
    """Return whether each value is below the one before."""
    return bool((np.diff(list(values)) < 0).all())
