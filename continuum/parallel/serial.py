"""The processes that share a run, seen from one of them; here a single process.

`continuum.parallel.communicator` is the version for several. Every call is collective: all
processes make it, in the same order.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.sparse import csr_matrix

T = TypeVar("T")


class Pieces(NamedTuple):
    """Values on some cells of a mesh, and on the nodes of these.

    cell : int array [cells], their numbers in the whole mesh.
    table : int array [cells, nodes per cell], nodes numbered from 0 as in the values.
    of_cells, of_nodes : arrays [cells, ...] and [nodes, ...].
    """

    cell: np.ndarray
    table: np.ndarray
    of_cells: tuple[np.ndarray, ...]
    of_nodes: tuple[np.ndarray, ...]


class Serial:
    """One process with all of the rock.

    rank, size : of this process and the communicator.
    """

    rank = 0
    size = 1

    def total(self, share: np.ndarray) -> np.ndarray:
        """Return values on the freedoms [..., n], summed over the processes that share each."""
        return share

    def sum(self, value: float) -> float:
        """Return the sum of one number of every process."""
        return value

    def largest(self, value: float) -> float:
        """Return the largest of one number of every process."""
        return value

    def of_largest(self, value: float, about: T) -> T:
        """Return the information of the process with the largest number."""
        return about

    def all(self, holds: bool) -> bool:
        """Return whether something holds on every process."""
        return holds

    def any(self, holds: bool) -> bool:
        """Return whether something holds on any process."""
        return not self.all(not holds)

    def count(self, here: int) -> int:
        """Return the total number of degrees of freedom, given the number on this process."""
        return here

    def same(self, value: T) -> T:
        """Return the object of the first process."""
        return value

    def assembled(self, share: csr_matrix) -> csr_matrix | None:
        """Return the sum of matrices on the degrees of freedom, on the first process only."""
        return share

    def beside(self, rows: np.ndarray) -> tuple[np.ndarray, slice]:
        """Return the rows of every process, one after the other, and the slice of those of this
        one."""
        return rows, slice(None)

    def gather(self, waves: np.ndarray) -> None:
        """Replace shares of waveforms by their sums over all processes."""

    def joined(self, pieces: Pieces) -> Pieces | None:
        """Return the pieces of all processes as one, on the first process; None on others."""
        return pieces

    @contextmanager
    def in_turn(self) -> Iterator[None]:
        """Let the first process of every machine compile; the others load from the cache."""
        yield

    def leapfrog(self, model, state, samples, stride, limits) -> Callable[[int, int], object]:
        """Return a function of (first, last) that takes steps, as `explicit.march.march` does."""
        from jointwave.continuum.explicit.march import march

        return march(model, state, samples, stride, limits)


SERIAL = Serial()
