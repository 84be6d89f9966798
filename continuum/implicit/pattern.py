"""The equations of implicit steps: matrices on one common pattern, so that their sums are sums of
arrays, and the factors of such a sum."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.implicit.balance import Matrices
from jointwave.continuum.model import Interfaces, Model
from jointwave.continuum.space.tractions import NN, NX, NZ, XN, XX, XZ, ZN, ZZ


class Entries(NamedTuple):
    """Entries of a matrix by row, column and value; what falls on one place is added up."""

    row: np.ndarray
    column: np.ndarray
    value: np.ndarray


class Pattern(NamedTuple):
    """The places that any of the matrices fills, CSR: start [n + 1], column [nnz].

    fixed : float array [matrices, nnz], each of the matrices on it.
    joints : [nnz, k q], times the joints' stiffness of `System.tangents` [k q] gives B^T D B on
        it, k of `kinds`.
    diagonal : int array [n], which of the places are on the diagonal.
    """

    start: np.ndarray
    column: np.ndarray
    fixed: np.ndarray
    joints: csr_matrix
    diagonal: np.ndarray


def pattern(matrices: list[csr_matrix], interfaces: Interfaces | None, free: np.ndarray) -> Pattern:
    """Return the pattern of matrices [freedoms, freedoms] and joints among the freedoms `free`.

    The diagonal is part of it. free : int array [n], ascending.
    """
    number = np.full(matrices[0].shape[0], -1)
    number[free] = np.arange(free.size)
    parts = [_among(Entries(m.row, m.col, m.data), number) for m in (m.tocoo() for m in matrices)]
    joints, source = _of_joints(interfaces)
    joints, source = _among(joints, number), source[_both(joints, number)]
    keys = [p.row * free.size + p.column for p in (*parts, joints)]
    own = np.arange(free.size) * (free.size + 1)
    places = np.unique(np.concatenate([*keys, own]))
    at = [np.searchsorted(places, key) for key in keys]
    fixed = [
        np.bincount(k, p.value, minlength=places.size) for k, p in zip(at, parts, strict=False)
    ]
    start = np.searchsorted(places, np.arange(free.size + 1) * free.size)
    size = 0 if interfaces is None else kinds(interfaces) * interfaces.area.size
    return Pattern(
        start=start,
        column=places % free.size,
        fixed=np.array(fixed),
        joints=csr_matrix((joints.value, (at[-1], source)), (places.size, size)),
        diagonal=np.searchsorted(places, own),
    )


class System:
    """The equations of the freedoms that move.

    Attributes
    ----------
    free : int array [n], these freedoms. pattern : of the matrices and of the joints among them.
    tangents : how the joints resist displacement, [k, q], N/m, of the last trial.
    """

    def __init__(
        self, model: Model, rock: Matrices, fixed: np.ndarray, matrices: list[csr_matrix]
    ) -> None:
        moves = rock.moves.copy()
        moves[fixed] = False
        self.free = np.flatnonzero(moves)
        self.pattern = pattern(matrices, model.interfaces, self.free)
        self.tangents = empty_tangents(model)
        self._factors = self._factors_of(rock)

    def with_joints(self, values: np.ndarray, share: float = 1.0) -> np.ndarray:
        """Return values on the pattern [nnz] with a share of the joints' tangents."""
        return values + share * (self.pattern.joints @ self.tangents.ravel())

    def factorise(self, values: np.ndarray) -> None:
        """Take the matrix of these values on the pattern [nnz], summed up over all processes."""
        self._factors.factorise(values)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x of A x = right, [n]."""
        return self._factors.solve(right)

    def _factors_of(self, rock: Matrices):
        start, column, communicator = self.pattern.start, self.pattern.column, rock.communicator
        if communicator.size == 1:
            from jointwave.continuum.implicit.factors import Factors  # with PETSc

            return Factors(start, column)
        from jointwave.continuum.parallel.communicator import Communicator
        from jointwave.continuum.parallel.factors import SharedFactors

        assert isinstance(communicator, Communicator)
        return SharedFactors(start, column, self.free, communicator)


def empty_tangents(model: Model) -> np.ndarray:
    """Return an array for the tangents of the joints, [k, q], N/m."""
    joints = model.interfaces
    return np.zeros((6, 0) if joints is None else (kinds(joints), joints.area.size))


def kinds(interfaces: Interfaces) -> int:
    """Return the number of tangents of a point."""
    return 8 if interfaces.parts.dilation else 6


def _both(entries: Entries, number: np.ndarray) -> np.ndarray:
    return (number[entries.row] >= 0) & (number[entries.column] >= 0)


def _among(entries: Entries, number: np.ndarray) -> Entries:
    """Return the entries whose row and column have a number, by these numbers."""
    there = _both(entries, number)
    row, column = number[entries.row[there]], number[entries.column[there]]
    return Entries(row.astype(np.int64), column.astype(np.int64), entries.value[there])


def _of_joints(interfaces: Interfaces | None) -> tuple[Entries, np.ndarray]:
    """Return the entries of B^T D B for D of ones, and which entry of D [k, q] each belongs to."""
    none = np.zeros(0, dtype=np.int64)
    found, sources = [Entries(none, none, np.zeros(0))], [none]
    if interfaces is not None:
        q = interfaces.area.size
        of_direction = [interfaces.jump[d * q : (d + 1) * q] for d in range(interfaces.directions)]
        y, x, z = (*of_direction, None, None)[:3]
        for kind, left, right in (
            (NN, y, y), (XN, x, y), (ZN, z, y), (XX, x, x), (XZ, x, z), (XZ, z, x), (ZZ, z, z),
            (NX, y, x), (NZ, y, z),
        ):  # fmt: skip
            if left is not None and right is not None and kind < kinds(interfaces):
                entries, point = _products(left, right)
                found.append(entries)
                sources.append(kind * interfaces.area.size + point)
    joined = Entries(*(np.concatenate(part) for part in zip(*found, strict=True)))
    return joined, np.concatenate(sources)


def _products(left: csr_matrix, right: csr_matrix) -> tuple[Entries, np.ndarray]:
    """Return the entries of the outer products of every row with the same row of another matrix,
    and the row that each comes from."""
    counts, others = np.diff(left.indptr), np.diff(right.indptr)
    row = np.repeat(np.arange(counts.size), counts)
    times = others[row]
    i = np.repeat(np.arange(row.size), times)
    j = right.indptr[row[i]] + np.arange(i.size) - np.repeat(np.cumsum(times) - times, times)
    return Entries(left.indices[i], right.indices[j], left.data[i] * right.data[j]), row[i]
