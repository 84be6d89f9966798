"""Drawn numbers, in a multiple of the unit suited to their size."""

from math import ceil, log10
from typing import NamedTuple

import numpy as np

MULTIPLES = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9}
FINE = 300  # least ratio of the largest number to the last drawn decimal


class Unit(NamedTuple):
    """A multiple of an SI unit ("kPa"), its size in SI units, and the decimals of an image."""

    name: str
    size: float
    decimals: int

    def drawn(self, values: np.ndarray) -> np.ndarray:
        """Return SI values in this unit, rounded to the resolution of an image."""
        return np.round(np.asarray(values) / self.size, self.decimals) + 0.0


def unit_for(si: str, largest: float) -> Unit:
    """Return the multiple of a unit that brings `largest` between 1 and 1000, or the unit itself
    if there is none."""
    sizes = {prefix + si: size for prefix, size in MULTIPLES.items()}
    suits = [name for name, size in sizes.items() if 1 <= largest / size < 1000]
    name = suits[0] if suits else si
    number = largest / sizes[name]
    return Unit(name, sizes[name], ceil(log10(FINE / number)) if number > 0 else 0)
