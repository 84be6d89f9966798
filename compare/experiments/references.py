"""The reference of an experiment's errors: an exact solution, or a run that is fine enough."""

from typing import NamedTuple

import xarray as xr


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
