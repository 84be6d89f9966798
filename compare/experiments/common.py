"""Shared by experiments: references of errors, combinations of varied keys, failures."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

import xarray as xr

from cases.errors import SceneError, UnstableError


class ErrorReference(NamedTuple):
    """What errors are from.

    error : relative, of the reference itself: the bound that a computed solution gives, 0 of a
    closed form; of a run, how far it is from a coarser one. settings : of a run, "" where the
    solution is exact.
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


FAILURES = (SceneError, UnstableError)  # of a scene that cannot be so, or a run that cannot go on


def reason_of(error: Exception) -> str:
    """Return why something could not be run, without where."""
    return getattr(error, "allowed", str(error))
