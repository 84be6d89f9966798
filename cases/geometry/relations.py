"""Relations between numbered things: int arrays [m, 2] of pairs, sorted by the first of them."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree


def ranges(first: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of ranges from `first` to before `after`, one range after the other, and
    the range that each belongs to."""
    number = np.maximum(after - first, 0)
    which = np.repeat(np.arange(len(number)), number)
    return np.arange(len(which)) + (first - np.cumsum(number) + number)[which], which


def groups(x: np.ndarray) -> list[np.ndarray]:
    """Return the places of each value in an array, of values that ascend."""
    order = np.argsort(x, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(x[order])) + 1) if len(x) else []


def composed(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs (x, z) of all (x, y) of one relation and (y, z) of another, repeated where
    they have several y; and the row of the first relation that each comes from."""
    low, high = (np.searchsorted(other[:, 0], one[:, 1], side=side) for side in ("left", "right"))
    at, which = ranges(low, high)
    return np.stack([one[which, 0], other[at, 1]], axis=1), which


def counted(pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs in order, each once, and how often it is among them."""
    width = pairs[:, 1].max(initial=0) + 1
    keys, times = np.unique(pairs[:, 0] * width + pairs[:, 1], return_counts=True)
    return np.stack(np.divmod(keys, width), axis=1), times


def distinct(pairs: np.ndarray) -> np.ndarray:
    """Return pairs in order, each once."""
    return counted(pairs)[0]


def sums(of: np.ndarray, x: np.ndarray, number: int) -> np.ndarray:
    """Return the sums [number, ...] of rows x [m, ...], by what each is of, int array [m]."""
    flat = x.reshape(len(x), int(np.prod(x.shape[1:]))).T
    found = [np.bincount(of, weights=one, minlength=number) for one in flat]
    return np.stack(found, axis=1).reshape(number, *x.shape[1:])


def joined(pairs: np.ndarray, number: int) -> np.ndarray:
    """Return the group of each of a number of things that pairs connect."""
    one, other = np.reshape(pairs, (-1, 2)).T.astype(np.int64)
    return connected_components(coo_array((np.ones(len(one)), (one, other)), (number, number)))[1]


def merged(x: np.ndarray, tolerance: float) -> np.ndarray:
    """Return for each of some points [n, d] the first of those that are within the tolerance (m) of
    it, or of others that are, int array [n]."""
    places, first, which = np.unique(x, axis=0, return_index=True, return_inverse=True)
    group = joined(cKDTree(places).query_pairs(tolerance, output_type="ndarray"), len(places))
    least = np.full(len(places), len(x))
    np.minimum.at(least, group, first)
    return least[group][which.reshape(-1)]


class Lookup:
    """Sorted distinct pairs, to find one or to count those of x with a y below some number."""

    def __init__(self, pairs: np.ndarray, width: int) -> None:
        self.pairs, self.width = pairs, width
        self.keys = pairs[:, 0] * width + pairs[:, 1]

    def index(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the number of pairs before (x, y), which is the place of that pair."""
        return np.searchsorted(self.keys, x * self.width + y)

    def below(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return how many pairs of x there are with a second number less than y."""
        return self.index(x, y) - self.index(x, np.zeros_like(y))

    def holds(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return whether pairs are among them, bool array."""
        at = self.index(x, y)
        return np.append(self.keys, -1)[at] == x * self.width + y
