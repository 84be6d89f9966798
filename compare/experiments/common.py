"""Shared by experiments: references of errors, combinations of varied keys, failures."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import xarray as xr


class ErrorReference(NamedTuple):
    """The reference of errors.

    error : relative, of the reference itself: the bound of a computed solution, 0 for a closed
    form; for a run its distance from a coarser one. settings : of a run, "" for an exact solution.
    """

    name: str
    result: xr.Dataset
    error: float
    settings: str = ""

    @property
    def is_exact(self) -> bool:
        """Whether it is an exact solution."""
        return not self.settings


def combinations(values: Mapping[str, Sequence[Any]]) -> Iterator[dict[str, Any]]:
    """Yield every combination of the values of some keys, the last key first to change."""
    for one in product(*values.values()):
        yield dict(zip(values, one, strict=True))
