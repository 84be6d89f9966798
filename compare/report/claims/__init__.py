"""Claims of Guo & Li (2002), by the figures of their paper: how one is measured and written."""

from collections.abc import Callable
from functools import wraps
from typing import NamedTuple

import numpy as np
import pandas as pd

from jointwave.compare.engines import label_of
from jointwave.compare.misfit.pairs import Comparison


class Claim(NamedTuple):
    """A claim of the paper: the sentence with the numbers that decide it, and whether it holds."""

    sentence: str
    holds: bool
    claim: str = ""


Measure = Callable[[list[Comparison]], Claim]
#: By figure, in the order of the page: what measures its claims on the scene and its variants.
CLAIMS: dict[int, list[Measure]] = {}


def claim(text: str, *figures: int) -> Callable[[Callable[..., tuple[str, bool]]], Measure]:
    """Return a decorator that makes a function, which returns a sentence and whether the claim
    holds, the measure of a claim of some figures."""

    def register(find: Callable[..., tuple[str, bool]]) -> Measure:
        @wraps(find)
        def measure(comparisons: list[Comparison]) -> Claim:
            sentence, holds = find(comparisons)
            return Claim(sentence.replace("%", " %"), bool(holds), text)

        for figure in figures:
            CLAIMS.setdefault(figure, []).append(measure)
        return measure

    return register


def listed(numbers: pd.Series | pd.DataFrame, form: str, unit: str = "") -> str:
    """Return the number or the row of numbers of each engine, in the order of the legend."""
    rows = pd.DataFrame(numbers).rename(index=label_of).iterrows()
    return "; ".join(f"{name} {', '.join(f'{x:{form}}' for x in row)}{unit}" for name, row in rows)


def falls(values: pd.DataFrame | np.ndarray) -> bool:
    """Return whether each value along the last axis is below the one before, and there are some."""
    steps = np.diff(values)
    return bool(steps.size and (steps < 0).all())
