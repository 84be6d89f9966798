"""Relations between numbered things: int arrays [m, 2] of pairs, sorted by the first number."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree


def ranges(first: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the integers of consecutive ranges [first, after), and the range of each."""
    number = np.maximum(after - first, 0)
    which = np.repeat(np.arange(len(number)), number)
    return np.arange(len(which)) + (first - np.cumsum(number) + number)[which], which


def groups(x: np.ndarray) -> list[np.ndarray]:
    """Return the indices of each distinct value in an array, by ascending value."""
    order = np.argsort(x, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(x[order])) + 1) if len(x) else []


def composed(one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs (x, z) from all (x, y) of one relation and (y, z) of another, once per y;
    and the row of the first relation that each comes from."""
    low, high = (np.searchsorted(other[:, 0], one[:, 1], side=side) for side in ("left", "right"))
    at, which = ranges(low, high)
    return np.stack([one[which, 0], other[at, 1]], axis=1), which


def counted(pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distinct pairs, sorted, and the number of times each occurs."""
    width = pairs[:, 1].max(initial=0) + 1
    keys, times = np.unique(pairs[:, 0] * width + pairs[:, 1], return_counts=True)
    return np.stack(np.divmod(keys, width), axis=1), times


def distinct(pairs: np.ndarray) -> np.ndarray:
    """Return the distinct pairs, sorted."""
    return counted(pairs)[0]


def sums(of: np.ndarray, x: np.ndarray, number: int) -> np.ndarray:
    """Return the sums [number, ...] of the rows x [m, ...] of each owner, `of` (int array [m])."""
    flat = x.reshape(len(x), int(np.prod(x.shape[1:]))).T
    found = [np.bincount(of, weights=one, minlength=number) for one in flat]
    return np.stack(found, axis=1).reshape(number, *x.shape[1:])


def joined(pairs: np.ndarray, number: int) -> np.ndarray:
    """Return the connected component of each of a number of things, given the connected pairs."""
    one, other = np.reshape(pairs, (-1, 2)).T.astype(np.int64)
    return connected_components(coo_array((np.ones(len(one)), (one, other)), (number, number)))[1]


def merged(x: np.ndarray, tolerance: float) -> np.ndarray:
    """Return for each point [n, d] the first point of its cluster, int array [n]; points within the
    tolerance (m) of each other are in one cluster."""
    places, first, which = np.unique(x, axis=0, return_index=True, return_inverse=True)
    group = joined(cKDTree(places).query_pairs(tolerance, output_type="ndarray"), len(places))
    least = np.full(len(places), len(x))
    np.minimum.at(least, group, first)
    return least[group][which.reshape(-1)]


class Lookup:
    """Sorted distinct pairs (x, y): finds a pair, or counts the pairs of x with smaller y."""

    def __init__(self, pairs: np.ndarray, width: int) -> None:
        self.pairs, self.width = pairs, width
        self.keys = pairs[:, 0] * width + pairs[:, 1]

    def index(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the number of pairs before (x, y), which is the pair's index if it exists."""
        return np.searchsorted(self.keys, x * self.width + y)

    def below(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the number of pairs of x whose second number is less than y."""
        return self.index(x, y) - self.index(x, np.zeros_like(y))

    def holds(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return whether pairs exist, bool array."""
        at = self.index(x, y)
        return np.append(self.keys, -1)[at] == x * self.width + y
