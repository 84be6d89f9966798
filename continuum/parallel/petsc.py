"""PETSc, initialised without its handlers of signals and closed pipes."""

from jointwave.continuum.space.basix_versions import load_mpi

load_mpi()
import petsc4py  # noqa: E402

petsc4py.init(["jointwave", "-no_signal_handler"])
from petsc4py import PETSc  # noqa: E402

__all__ = ["PETSc"]
