"""Newton's method, and LU factors by PETSc."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space.fenicsx import PETSc, shared_by

MOST_ITERATIONS = 20  # enough for a joint closed beyond d_m, which returns by half the excess each
#: Unknowns from which MUMPS is faster than PETSc's own factors in spite of its overhead.
LARGE = 20_000
SHARED = ("mumps", "superlu_dist")  # packages that factorise a matrix of several processes


class Factors:
    """The LU factors of a matrix [n, n], by PETSc; comm : mpi4py communicator of processes that
    share them. Each process passes the whole matrix and gets the whole solution."""

    def __init__(self, matrix: csr_matrix, comm: Any = None) -> None:
        if comm is not None and hasattr(PETSc, "garbage_cleanup"):
            PETSc.garbage_cleanup(comm)  # earlier factors: shared objects need a collective call
        n, self._comm = matrix.shape[0], comm
        rank, size = (0, 1) if comm is None else (comm.rank, comm.size)
        self._rows = slice(n * rank // size, n * (rank + 1) // size)
        own, on = matrix[self._rows], PETSc.COMM_SELF if comm is None else shared_by(comm)
        pattern = own.indptr.astype(PETSc.IntType), own.indices.astype(PETSc.IntType)
        sizes = own.shape[0], n
        given = PETSc.Mat().createAIJ((sizes, sizes), csr=(*pattern, own.data), comm=on)
        self._solver = PETSc.KSP().create(on)
        self._solver.setType("preonly")
        conditioner = self._solver.getPC()
        conditioner.setType("lu")
        conditioner.setFactorSolverType(_package(n, size))
        self._solver.setOperators(given)
        self._x, self._b = given.createVecs()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x of A x = right, [n]."""
        self._b.array[:] = right[self._rows]
        self._solver.solve(self._b, self._x)
        found = np.real(self._x.array).copy()
        return found if self._comm is None else np.concatenate(self._comm.allgather(found))


def _package(unknowns: int, processes: int) -> str:
    """Return the package that factorises; raises ImportError if several processes lack one."""
    there = [one for one in SHARED if PETSc.Sys.hasExternalPackage(one)]
    if processes > 1:
        if not there:
            raise ImportError(f"implicit steps on several processes need PETSc with {SHARED[0]}")
        return there[0]
    return "mumps" if unknowns > LARGE and "mumps" in there else "petsc"


class Outcome(NamedTuple):
    """Whether Newton's method converged, the largest residual of every iterate, from the start on,
    and the tolerance of the last."""

    converged: bool
    errors: list[float]
    tolerance: float


def newton(
    residual: Callable[[np.ndarray], tuple[np.ndarray, float]],
    correction: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
) -> Outcome:
    """Solve by Newton's method from a start, with at least one correction unless the residual is 0.

    residual : function of x that returns the residual and its tolerance. correction : function of
    the residual that returns the correction of the last x.
    """
    x, errors, tolerance = start.copy(), [], 0.0
    for _ in range(MOST_ITERATIONS + 1):
        rest, tolerance = residual(x)
        errors.append(float(np.abs(rest).max(initial=0.0)))
        if errors[-1] == 0 or (len(errors) > 1 and errors[-1] <= tolerance):
            return Outcome(True, errors, tolerance)
        if not np.isfinite(errors[-1]) or len(errors) > MOST_ITERATIONS:
            break
        x += correction(rest)
    return Outcome(False, errors, tolerance)
