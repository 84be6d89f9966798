"""The factorised matrix of an implicit step of rock that several processes share."""

import numpy as np

from continuum.parallel.communicator import Communicator
from continuum.petsc import PETSc

PACKAGES = ("mumps", "superlu_dist")  # that factorise what several processes hold


class SharedFactors:
    """The LU factors of a sum of matrices, one of each process, that keep their patterns.

    Parameters
    ----------
    start, column : CSR pattern [n + 1], [nnz] of this process's matrix.
    free : int array [n], its rows and columns, as freedoms of this process.
    communicator : the processes. All its methods are called by all of them.
    """

    def __init__(
        self, start: np.ndarray, column: np.ndarray, free: np.ndarray, communicator: Communicator
    ) -> None:
        self._team, self._free = communicator, free
        self._mine = np.intersect1d(free, communicator.mine)
        self._pattern = start.astype(PETSc.IntType), column.astype(PETSc.IntType)
        self._share = PETSc.Mat().createAIJ(
            (free.size, free.size),
            csr=(*self._pattern, np.zeros(column.size)),
            comm=PETSc.COMM_SELF,
        )
        names = PETSc.LGMap().create(self._names().astype(PETSc.IntType), comm=communicator.comm)
        rows = (self._mine.size, PETSc.DETERMINE)
        self._sum = PETSc.Mat().createIS(
            (rows, rows), lgmapr=names, lgmapc=names, comm=communicator.comm
        )
        self._sum.setISLocalMat(self._share)
        self._whole = PETSc.Mat()
        self._solver = PETSc.KSP().create(communicator.comm)
        self._solver.setType("preonly")
        conditioner = self._solver.getPC()
        conditioner.setType("lu")
        conditioner.setFactorSolverType(_package())

    def factorise(self, values: np.ndarray) -> None:
        """Take the sum of all matrices, of which this process's has these values [nnz]."""
        self._share.setValuesCSR(*self._pattern, values)
        self._share.assemble()
        self._sum.assemble()
        first = not self._whole
        self._sum.convert("aij", self._whole)
        if first:
            self._left, self._right = self._whole.createVecs()
        self._solver.setOperators(self._whole)
        self._solver.setUp()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x of A x = right, both [n] the same on all processes that have a freedom."""
        everywhere = np.zeros(self._team.length)
        everywhere[self._free] = right
        self._right.array[:] = everywhere[self._mine]
        self._solver.solve(self._right, self._left)
        everywhere[:] = 0.0
        everywhere[self._mine] = np.real(self._left.array)
        return self._team.total(everywhere)[self._free]

    def _names(self) -> np.ndarray:
        """Return the numbers [n] of the free freedoms among those of all processes."""
        communicator, found = self._team, np.zeros(self._team.length)
        first = communicator.comm.exscan(self._mine.size) or 0
        found[self._mine] = first + np.arange(self._mine.size)
        return np.rint(communicator.total(found)[self._free])


def _package() -> str:
    for package in PACKAGES:
        if PETSc.Sys.hasExternalPackage(package):
            return package
    raise ImportError(f"implicit steps on several processes need PETSc with {PACKAGES[0]}")
