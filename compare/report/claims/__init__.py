"""Claims of Guo & Li (2002) by figure of their paper, and their registration and wording."""

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
#: Functions that measure the claims of each figure on its scene's variants, in page order.
CLAIMS: dict[int, list[Measure]] = {}


def claim(text: str, *figures: int) -> Callable[[Callable[..., tuple[str, bool]]], Measure]:
    """Return a decorator that registers a function for a claim of some figures; the function
    returns a sentence and whether the claim holds."""

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
    """Return the number or the numbers of each engine as text, in the given order."""
    rows = pd.DataFrame(numbers).rename(index=label_of).iterrows()
    return "; ".join(f"{name} {', '.join(f'{x:{form}}' for x in row)}{unit}" for name, row in rows)


def falls(values: pd.DataFrame | np.ndarray) -> bool:
    """Return whether values decrease strictly along the last axis; False for fewer than two."""
    steps = np.diff(values)
    return bool(steps.size and (steps < 0).all())
