"""The factorised matrix of an implicit step of rock shared by several processes."""

import numpy as np

from jointwave.continuum.implicit.factors import Factors
from jointwave.continuum.parallel.communicator import Communicator
from jointwave.continuum.parallel.petsc import PETSc

PACKAGES = ("mumps", "superlu_dist")  # that factorise distributed matrices


class SharedFactors(Factors):
    """The LU factors of a sum of matrices, one per process, with constant patterns.

    start, column : of this process's matrix. free : int array [n], its rows and columns, as degrees
    of freedom of this process. All methods are called by all processes of the communicator;
    solutions are equal on all processes that share a degree of freedom.
    """

    def __init__(
        self, start: np.ndarray, column: np.ndarray, free: np.ndarray, communicator: Communicator
    ) -> None:
        super().__init__(start, column, communicator.comm, _package())
        self._team, self._free = communicator, free
        self._mine = np.intersect1d(free, communicator.mine)
        names = communicator.numbered(self._mine)[free].astype(PETSc.IntType)
        names = PETSc.LGMap().create(names, comm=communicator.comm)
        rows = (self._mine.size, PETSc.DETERMINE)
        self._sum = PETSc.Mat().createIS(
            (rows, rows), lgmapr=names, lgmapc=names, comm=communicator.comm
        )
        self._sum.setISLocalMat(self._matrix)
        self._whole = PETSc.Mat()

    def _summed(self):
        self._sum.assemble()
        return self._sum.convert("aij", self._whole)

    def solve(self, right: np.ndarray) -> np.ndarray:
        everywhere = np.zeros(self._team.length)
        everywhere[self._free] = right
        found = super().solve(everywhere[self._mine])
        everywhere[:] = 0.0
        everywhere[self._mine] = found
        return self._team.total(everywhere)[self._free]


def _package() -> str:
    for package in PACKAGES:
        if PETSc.Sys.hasExternalPackage(package):
            return package
    raise ImportError(f"implicit steps on several processes need PETSc with {PACKAGES[0]}")
