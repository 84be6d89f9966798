"""Newton's method, and the factorised matrix that its steps solve."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from continuum.parallel.serial import SERIAL, Serial
from continuum.petsc import PETSc

MOST_ITERATIONS = 12
#: Unknowns from which MUMPS outweighs what it costs to call; PETSc's own factors are quicker below.
LARGE = 20_000


class Outcome(NamedTuple):
    """x : the last iterate. converged : whether it is a solution. errors : largest residual of
    every iterate, the start first; tolerance : that of the last one."""

    x: np.ndarray
    converged: bool
    errors: list[float]
    tolerance: float


def newton(
    residual: Callable[[np.ndarray], tuple[np.ndarray, float]],
    correction: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    communicator: Serial = SERIAL,
) -> Outcome:
    """Return what Newton's method makes of a start, after one correction at least.

    Where nothing moves at all there is nothing to correct.

    Parameters
    ----------
    residual : function of x that returns the residual and what of it may be left.
    correction : function of a residual that returns by what to move the last x.
    communicator : the processes that each have a part of x; all come to the same end.
    """
    x, errors, tolerance = start.copy(), [], 0.0
    for _ in range(MOST_ITERATIONS + 1):
        rest, left = residual(x)
        errors.append(communicator.largest(_size(rest)))
        tolerance = communicator.largest(left)
        if not np.isfinite(errors[-1]):
            break
        if errors[-1] == 0 or (len(errors) > 1 and errors[-1] <= tolerance):
            return Outcome(x, True, errors, tolerance)
        if len(errors) > MOST_ITERATIONS:
            break
        x += correction(rest)
    return Outcome(x, False, errors, tolerance)


def _size(values: np.ndarray) -> float:
    """Return the largest magnitude; infinite where one is not a number."""
    found = float(np.abs(values).max(initial=0.0))
    return found if np.isfinite(found) else np.inf


class LinearSolver(Protocol):
    """The LU factors of matrices that share one pattern.

    factorise : takes the matrix of these values on the pattern. solve : returns x of A x = right.
    """

    def factorise(self, values: np.ndarray) -> None: ...

    def solve(self, right: np.ndarray) -> np.ndarray: ...


def factors_of(
    start: np.ndarray, column: np.ndarray, free: np.ndarray, communicator: Serial = SERIAL
) -> LinearSolver:
    """Return what factorises a matrix of this pattern, the sum of those of all processes.

    start [n + 1], column [nnz] : CSR. free : int array [n], the freedoms that its rows are.
    """
    if communicator.size == 1:
        return Factors(start, column)
    from continuum.parallel.communicator import Communicator
    from continuum.parallel.factors import SharedFactors

    assert isinstance(communicator, Communicator)
    return SharedFactors(start, column, free, communicator)


class Factors:
    """The LU factors of matrices [n, n] that share one pattern, by PETSc.

    The pattern is that of a CSR matrix: start [n + 1], column [nnz].
    """

    def __init__(self, start: np.ndarray, column: np.ndarray) -> None:
        size = len(start) - 1
        self._pattern = start.astype(PETSc.IntType), column.astype(PETSc.IntType)
        self._matrix = PETSc.Mat().createAIJ(
            (size, size), csr=(*self._pattern, np.zeros(len(column))), comm=PETSc.COMM_SELF
        )
        self._right, self._left = self._matrix.createVecs()
        self._solver = PETSc.KSP().create(PETSc.COMM_SELF)
        self._solver.setType("preonly")
        conditioner = self._solver.getPC()
        conditioner.setType("lu")
        package = "mumps" if size > LARGE and PETSc.Sys.hasExternalPackage("mumps") else "petsc"
        conditioner.setFactorSolverType(package)

    def factorise(self, values: np.ndarray) -> None:
        """Take the matrix of these values [nnz]."""
        self._matrix.setValuesCSR(*self._pattern, values)
        self._matrix.assemble()
        self._solver.setOperators(self._matrix)
        self._solver.setUp()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x of A x = right, [n]."""
        self._left.array[:] = right
        self._solver.solve(self._left, self._right)
        return np.real(self._right.array).copy()
