"""Numbers as they are drawn: in the multiple of a unit that suits their size."""

from typing import NamedTuple

import numpy as np

MULTIPLES = {"G": 1e9, "M": 1e6, "k": 1e3, "": 1.0, "m": 1e-3, "µ": 1e-6, "n": 1e-9}
WHOLE = 300, 32767  # the largest number, where whole ones are fine enough and fit 16 bits


class Unit(NamedTuple):
    """A multiple of an SI unit ("kPa"), its size in SI units, and whether whole numbers do."""

    name: str
    size: float
    whole: bool

    def drawn(self, values: np.ndarray) -> np.ndarray:
        """Return SI values in this unit, as rounded as they are drawn."""
        scaled = np.asarray(values) / self.size
        return np.rint(scaled) + 0.0 if self.whole else scaled.astype(np.float32)


def unit_for(si: str, largest: float, whole: bool = False) -> Unit:
    """Return the multiple of a unit that has numbers up to `largest` between 1 and 1000.

    whole : rather the one, if any, whose whole numbers are fine enough.
    """
    for rounded in (True, False) if whole else (False,):
        low, high = WHOLE if rounded else (1.0, 1000.0)
        for prefix, size in MULTIPLES.items():
            if low <= largest / size < high:
                return Unit(prefix + si, size, rounded)
    return Unit(si, 1.0, False)
