"""Parallel lines that cut the cells of a subdivision: one family for each group of cells."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Lines:
    """Families of parallel lines, the place of a line being its distance s from the origin along
    the normal to the left of the direction.

    A point's code in a family says where it lies: 2 k between lines k - 1 and k, 2 k + 1 on line k.

    Attributes
    ----------
    direction : float array [2], unit vector.
    family : int array [cells], of each cell; the last family has no lines.
    places : float array [n], s of the lines, m, increasing in each family.
    first : int array [families + 1], of each family in `places`.
    base : int array [families], signed number of a family's first line.
    joint_set : index of the set that the lines are joints of, or NO_SET.
    """

    direction: np.ndarray
    family: np.ndarray
    places: np.ndarray
    first: np.ndarray
    base: np.ndarray
    joint_set: int

    @property
    def normal(self) -> np.ndarray:
        """The unit vector to the left of the direction."""
        return np.array([-self.direction[1], self.direction[0]])

    def codes(self, s: np.ndarray, family: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the codes of points at s (m) in families, arrays of one shape."""
        low, high = self.first[family], self.first[family + 1]
        begin, end = low, high
        last = max(len(self.places) - 1, 0)
        while (low < high).any():
            middle = (low + high) // 2
            below = (low < high) & (self._at(middle, last) < s - tolerance)
            low, high = np.where(below, middle + 1, low), np.where(below, high, middle)
        touches = (low < end) & (self._at(low, last) <= s + tolerance)
        return 2 * (low - begin) + touches

    def _at(self, index: np.ndarray, last: int) -> np.ndarray:
        if not len(self.places):
            return np.full(index.shape, np.inf)
        return self.places[np.minimum(index, last)]


def one_line(direction: np.ndarray, through: np.ndarray, cut: np.ndarray) -> Lines:
    """Return a line through a point that cuts some cells (bool array [cells]), of no set."""
    return Lines(
        direction=direction,
        family=np.where(cut, 0, 1),
        places=np.array([through[1] * direction[0] - through[0] * direction[1]]),
        first=np.array([0, 1, 1]),
        base=np.zeros(2, np.int64),
        joint_set=-1,
    )
