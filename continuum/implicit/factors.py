"""LU factors of the matrices that Newton's method solves, by PETSc."""

import numpy as np

from jointwave.continuum.parallel.petsc import PETSc

#: Unknowns from which MUMPS outweighs what it costs to call; PETSc's own factors are quicker below.
LARGE = 20_000


class Factors:
    """The LU factors of matrices [n, n] that share one pattern.

    start [n + 1], column [nnz] : CSR. comm, package : of those who solve, and what they solve with;
    absent: this process alone.
    """

    def __init__(
        self, start: np.ndarray, column: np.ndarray, comm=None, package: str | None = None
    ) -> None:
        size = len(start) - 1
        self._pattern = start.astype(PETSc.IntType), column.astype(PETSc.IntType)
        self._matrix = PETSc.Mat().createAIJ(
            (size, size), csr=(*self._pattern, np.zeros(len(column))), comm=PETSc.COMM_SELF
        )
        self._solver = PETSc.KSP().create(PETSc.COMM_SELF if comm is None else comm)
        self._solver.setType("preonly")
        conditioner = self._solver.getPC()
        conditioner.setType("lu")
        large = size > LARGE and PETSc.Sys.hasExternalPackage("mumps")
        conditioner.setFactorSolverType(package or ("mumps" if large else "petsc"))
        self._vectors: tuple = ()

    def factorise(self, values: np.ndarray) -> None:
        """Take the matrix of these values [nnz]."""
        self._matrix.setValuesCSR(*self._pattern, values)
        self._matrix.assemble()
        whole = self._summed()
        self._vectors = self._vectors or whole.createVecs()
        self._solver.setOperators(whole)
        self._solver.setUp()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x of A x = right, [n]."""
        x, b = self._vectors
        b.array[:] = right
        self._solver.solve(b, x)
        return np.real(x.array).copy()

    def _summed(self):
        """Return the matrix of all who solve."""
        return self._matrix
